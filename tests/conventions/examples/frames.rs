//! Section 1: sensor frame, pixel frame and principal point.

use super::{Example, Given, Results, point_results};
use fmc_camera::geometry::sensor::FmcAxis;

pub(super) const EXAMPLES: &[Example] = &[
    ("centre of the first pixel", sensor_from_pixel),
    ("outer corner of the first pixel", sensor_from_pixel),
    ("outer corner of the last pixel", sensor_from_pixel),
    ("pixel coordinate of the array's centre", pixel_from_sensor),
    ("pixel coordinate to the right and above", pixel_from_sensor),
    ("principal point for e = +y", |given| {
        moved(given, FmcAxis::PlusY)
    }),
    ("principal point for e = -x", |given| {
        moved(given, FmcAxis::MinusX)
    }),
];

fn sensor_from_pixel(given: &Given) -> Results {
    let sensor = given.sensor();
    let point = sensor.sensor_from_pixel(given.pixel("col", "row"));
    assert!(sensor.contains(point));
    point_results("x", "y", point)
}

fn pixel_from_sensor(given: &Given) -> Results {
    let pixel = given.sensor().pixel_from_sensor(given.point("x", "y"));
    vec![
        ("col", "px", pixel.col_px.into()),
        ("row", "px", pixel.row_px.into()),
    ]
}

fn moved(given: &Given, axis: FmcAxis) -> Results {
    let moved = axis.sensor_from_offset(given.point("x0", "y0"), given.number("c", "mm"));
    point_results("x", "y", moved)
}
