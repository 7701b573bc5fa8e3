//! Sizes of output images.

use fastrand::Rng;
use fmc_rectification::{Centre, Rectification, Request, Resampling, Window};

use crate::cameras::{Case, published_at_rest, random};
use crate::places::exact_place;

/// Displacement at its largest in the window of the sensor's size, pixels, and sides of the windows
/// inside and full, as computed independently.
const EXPECTED: [(&str, f64, [u32; 2], [u32; 2]); 2] = [
    (
        "phase-one-ixm-rs150f-50.toml",
        119.0,
        [14294, 10700],
        [14412, 10790],
    ),
    (
        "phase-one-ixu-rs1000-50.toml",
        83.0,
        [11701, 8750],
        [11745, 8812],
    ),
];

fn request(window: Window) -> Request {
    Request {
        window,
        centre: Centre::PrincipalPoint,
        resampling: Resampling::Nearest,
    }
}

#[test]
fn windows_of_the_wide_lenses_have_their_published_sizes() {
    let cameras = published_at_rest();
    for (name, displacement_px, inside, full) in EXPECTED {
        let (_, correction, point) = cameras.iter().find(|camera| camera.0 == name).unwrap();
        let size = |window| {
            let rectification = Rectification::new(correction, *point, &request(window));
            rectification.unwrap().output_size_px()
        };
        assert_eq!(size(Window::Inside), inside, "{name}");
        assert_eq!(size(Window::Full), full, "{name}");
        let same = Rectification::new(correction, *point, &request(Window::Same)).unwrap();
        let [width, height] = same.output_size_px();
        let mut largest = 0.0_f64;
        for row in [0, height - 1] {
            for col in [0, width - 1] {
                if let Some([x, y]) = same.mesh().place_px([col, row]) {
                    let way = (x - f64::from(col)).hypot(y - f64::from(row));
                    largest = largest.max(way);
                }
            }
        }
        println!(
            "{name}: {largest}, {} {}",
            same.mesh_spacing_px(),
            same.mesh_bound_px()
        );
        assert!((largest - displacement_px).abs() < 1.0, "{name}: {largest}");
        assert_eq!(same.mesh_spacing_px(), 16, "{name}");
    }
}

#[test]
fn the_inner_window_has_no_border_and_one_pixel_more_has() {
    for (name, correction, point) in published_at_rest() {
        let count = |size_px| {
            let request = request(Window::Size(size_px));
            let made = Rectification::new(&correction, point, &request).unwrap();
            let [width, height] = size_px;
            let sides = correction.sensor();
            let mut off = 0;
            let mut check = |col, row| {
                let on = made.mesh().place_px([col, row]).is_some_and(|[x, y]| {
                    let within = |place: f64, side| (-0.5..=f64::from(side) - 0.5).contains(&place);
                    within(x, sides.width_px()) && within(y, sides.height_px())
                });
                off += u32::from(!on);
            };
            for col in (0..width).step_by(61).chain([width - 1]) {
                check(col, 0);
                check(col, height - 1);
            }
            for row in (0..height).step_by(61).chain([height - 1]) {
                check(0, row);
                check(width - 1, row);
            }
            off
        };
        let inside = Rectification::new(&correction, point, &request(Window::Inside)).unwrap();
        let [width, height] = inside.output_size_px();
        assert_eq!(count([width, height]), 0, "{name}");
        assert!(count([width + 3, height]) > 0, "{name}");
        assert!(count([width, height + 3]) > 0, "{name}");
    }
}

/// Returns how far the edge of an output image lies off the sensor where it is farthest, pixels;
/// negative if it is on it everywhere. The corners of all pixels along the edge are tried.
fn farthest_off_px(case: &Case, size_px: [u32; 2]) -> f64 {
    let sensor = case.correction.sensor();
    let sensor_px = [sensor.width_px(), sensor.height_px()].map(f64::from);
    let mut farthest = f64::NEG_INFINITY;
    let mut try_at = |corner: [u32; 2]| {
        let place = corner.map(|side| f64::from(side) - 0.5);
        let source = exact_place(&case.correction, case.principal_point, size_px, place);
        for (source, side) in source.into_iter().zip(sensor_px) {
            farthest = farthest.max(-0.5 - source).max(source - (side - 0.5));
        }
    };
    let [width, height] = size_px;
    for col in 0..=width {
        try_at([col, 0]);
        try_at([col, height]);
    }
    for row in 0..=height {
        try_at([0, row]);
        try_at([width, row]);
    }
    farthest
}

#[test]
fn the_inner_window_of_any_camera_lies_on_the_sensor_and_a_larger_one_does_not() {
    let mut rng = Rng::with_seed(19);
    for number in 0..60 {
        let case = random(&mut rng, [300, 700, 1500][number % 3]);
        let request = request(Window::Inside);
        let size = Rectification::size_px(&case.correction, case.principal_point, &request);
        let [width, height] = size.unwrap();
        let off = |size_px| farthest_off_px(&case, size_px);
        // A window may miss a whole number by a millionth of a pixel.
        let inside = off([width, height]);
        assert!(inside <= 1e-6, "{}: {inside} px", case.name);
        // The bound of an edge's bend may cost a pixel, and a side is whole.
        for larger in [[width + 2, height], [width, height + 2]] {
            let outside = off(larger);
            assert!(outside > 0.0, "{}: {outside} px", case.name);
        }
    }
}
