//! σ of a calibration in pixels.

use fmc_camera::geometry::evaluation_form::Jacobian;
use fmc_camera_file::CameraFile;
use fmc_frames::CalibrationCovariance;

use crate::support::IXM;

/// Returns the place of a ray by Metashape's formula, px from the middle of the array, rows
/// downwards; the camera is f, cx, cy, b1, b2, k1 to k4, p1, p2.
fn projected(camera: &[f64; 11], [x, y]: [f64; 2]) -> [f64; 2] {
    let [distance, cx, cy, b1, b2, k1, k2, k3, k4, p1, p2] = *camera;
    let r2 = x * x + y * y;
    let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * (k3 + r2 * k4)));
    let across = x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y;
    let down = y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y;
    [
        cx + (distance + b1) * across + b2 * down,
        cy + distance * down,
    ]
}

#[test]
fn sigma_in_pixels_is_that_of_metashapes_formula() {
    let (file, _) = CameraFile::parse("ixm.toml", IXM).unwrap();
    // The fit of this camera in Metashape, as the exchange has it.
    let camera = [
        13_662.553_191,
        15.531_915,
        6.356_383,
        0.0,
        0.0,
        -0.042_343_457,
        0.047_905_614,
        -0.035_308_090,
        0.009_414_089_9,
        0.000_101_139_27,
        -0.000_224_303_91,
    ];
    let names = [
        "f", "cx", "cy", "b1", "b2", "k1", "k2", "k3", "k4", "p1", "p2",
    ];
    let sigma = [0.5, 0.3, 0.2, 0.1, 0.1, 1e-5, 1e-4, 1e-4, 1e-4, 1e-6, 2e-6];
    let pitch_mm = file.sensor.pixel_um * 1e-3;
    for (index, name) in names.iter().enumerate() {
        // f and the principal point move image points as a whole: cx and cy act on the
        // distortion by its slope alone, which is left out here.
        if ["f", "cx", "cy"].contains(name) {
            continue;
        }
        for ray in [[0.4, 0.3], [-0.3, 0.2], [0.1, -0.35]] {
            let mut moved = camera;
            moved[index] += sigma[index];
            let [before, after] = [camera, moved].map(|camera| projected(&camera, ray));
            let expected = [after[0] - before[0], after[1] - before[1]].map(|px| px * pitch_mm);
            // Of the measured point, as the camera file has it; y upwards.
            let [x, y] = [before[0] - camera[1], camera[2] - before[1]].map(|px| px * pitch_mm);
            let text = format!(
                "{{\"parameters\": [\"cx\", \"{name}\"], \"sigma\": [0, {}]}}",
                sigma[index]
            );
            let covariance =
                CalibrationCovariance::read_for("m.json", text.as_bytes(), &file).unwrap();
            let none = Jacobian {
                dx_by_x: 0.0,
                dx_by_y: 0.0,
                dy_by_x: 0.0,
                dy_by_y: 0.0,
            };
            let found = covariance
                .variance_mm2([x, y], none, |one| one)
                .map(f64::sqrt);
            let size = expected[0].hypot(expected[1]);
            for (found, expected) in found.into_iter().zip(expected) {
                let off = (found - expected.abs()).abs();
                assert!(off < 0.09 * size, "{name} {ray:?}: {found} {expected}");
            }
        }
    }
}
