//! Section 12: interior orientations of other software.

use super::{Example, Given, Results, point_results};
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::sensor::PixelPoint;

pub(super) const EXAMPLES: &[Example] = &[
    ("OpenCV principal point", |given| {
        let point = given.sensor().sensor_from_pixel(given.pixel("cx", "cy"));
        point_results("x0", "y0", point)
    }),
    ("Metashape principal point", metashape_principal_point),
    ("OpenCV radial coefficients", opencv_radial),
    ("OpenCV decentring", opencv_decentring),
];

fn metashape_principal_point(given: &Given) -> Results {
    let sensor = given.sensor();
    let from_centre = given.pixel("cx", "cy");
    let half_px = |half_side_mm: f32| half_side_mm / sensor.pixel_mm();
    let pixel = PixelPoint {
        col_px: half_px(sensor.half_width_mm()) + from_centre.col_px - 0.5,
        row_px: half_px(sensor.half_height_mm()) + from_centre.row_px - 0.5,
    };
    point_results("x0", "y0", sensor.sensor_from_pixel(pixel))
}

fn opencv_radial(given: &Given) -> Results {
    let [k1, k2]: [f32; 2] = ["k1", "k2"].map(|symbol| given.number(symbol, ""));
    let f: f32 = given.number("f", "mm");
    let ideal: f64 = given.number("ideal", "mm");
    let r2 = (ideal / f64::from(f)).powi(2);
    let measured = ideal * (1.0 + r2 * (f64::from(k1) + r2 * f64::from(k2)));
    let measured_single: f32 = measured.to_string().parse().unwrap();
    let f2 = f * f;
    let distortion_um = |k1: f32, k2: f32, k3: f32| {
        let lens = Brown {
            k1: k1 / f2,
            k2: k2 / (f2 * f2),
            k3: k3 / (f2 * f2 * f2),
            ..Brown::default()
        };
        f64::from(lens.displacement(measured_single, 0.0).dx_mm) * 1000.0
    };
    let leading = distortion_um(k1, k2 - 3.0 * k1 * k1, -8.0 * k1 * k2 + 12.0 * k1 * k1 * k1);
    vec![
        ("measured", "mm", measured),
        ("distortion", "µm", (measured - ideal) * 1000.0),
        ("copied", "µm", distortion_um(k1, k2, 0.0)),
        ("leading order", "µm", leading),
    ]
}

fn opencv_decentring(given: &Given) -> Results {
    let f: f32 = given.number("f", "mm");
    let [cv1, cv2]: [f32; 2] = ["p1", "p2"].map(|symbol| given.number(symbol, ""));
    let lens = Brown {
        p1: cv2 / f,
        p2: -cv1 / f,
        ..Brown::default()
    };
    for (x, y) in [(20.0, 10.0), (-15.0, 25.0), (5.0, -30.0_f32)] {
        let (u, v) = (x / f, -y / f);
        let r2 = u * u + v * v;
        let du = 2.0 * cv1 * u * v + cv2 * (r2 + 2.0 * u * u);
        let dv = cv1 * (r2 + 2.0 * v * v) + 2.0 * cv2 * u * v;
        let Displacement { dx_mm, dy_mm } = lens.displacement(x, y);
        assert!((dx_mm - du * f).abs() < 1e-7 && (dy_mm + dv * f).abs() < 1e-7);
    }
    vec![
        ("P1", "mm⁻¹", lens.p1.into()),
        ("P2", "mm⁻¹", lens.p2.into()),
    ]
}
