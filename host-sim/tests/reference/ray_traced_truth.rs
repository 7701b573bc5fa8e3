//! The camera against ray-traced exposures of a lens whose distortion is not a polynomial.
//!
//! A static K0..K3 calibration is fitted to the motionless columns, as a calibration laboratory
//! would do; the camera gets only that fit, δ, Δδ and the shutter.

use fmc_camera::Camera;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_reference::lens::Lens;
use nalgebra::{DMatrix, DVector};

/// Largest excess of the camera's error over that of the same fit evaluated about the centroid in
/// double precision, mm.
const MARGIN_MM: f64 = 1e-6;

/// A row of `data/exposure_truth_dblgauss.csv`.
struct Truth {
    delta_mm: f64,
    offset_mm: f64,
    ramps: bool,
    centroid_mm: f64,
    moving: [f64; 2],
    still: [f64; 2],
    ideal: [f64; 2],
}

fn truth() -> Vec<Truth> {
    let text = include_str!("../../data/exposure_truth_dblgauss.csv");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    table
        .records()
        .map(|row| {
            let row = row.unwrap();
            let number = |index: usize| row[index].parse::<f64>().unwrap();
            Truth {
                delta_mm: number(2),
                offset_mm: number(3),
                ramps: &row[4] == "trap30_10",
                centroid_mm: number(6),
                ideal: [number(7), number(8)],
                moving: [number(9) / 1e3, number(10) / 1e3],
                still: [number(11) / 1e3, number(12) / 1e3],
            }
        })
        .collect()
}

fn sum([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax + bx, ay + by]
}

/// Fits K0..K3 as a function of the measured point, by least squares over the motionless columns.
fn static_fit(rows: &[Truth]) -> Lens {
    const RADIUS_MM: f64 = 36.0;
    let mut design = Vec::new();
    let mut observed = Vec::new();
    for row in rows {
        let measured = sum(row.ideal, row.still);
        let r2 = (measured[0].powi(2) + measured[1].powi(2)) / RADIUS_MM.powi(2);
        for (coordinate, displacement) in measured.into_iter().zip(row.still) {
            design.extend([1.0, r2, r2.powi(2), r2.powi(3)].map(|term| coordinate * term));
            observed.push(displacement);
        }
    }
    let design = DMatrix::from_row_slice(observed.len(), 4, &design);
    let observed = DVector::from_vec(observed);
    let solution = design.svd(true, true).solve(&observed, 1e-12).unwrap();
    let scale = |k: i32| RADIUS_MM.powi(-2 * k);
    Lens {
        k: [
            solution[0],
            solution[1] * scale(1),
            solution[2] * scale(2),
            solution[3] * scale(3),
        ],
        p: [0.0, 0.0],
        b: [0.0, 0.0],
    }
}

fn camera(lens: &Lens, ramps: bool) -> Camera {
    let [k0, k1, k2, k3] = lens.k;
    let shutter = if ramps {
        "[shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.3\nclosing_fraction = 0.1\n"
    } else {
        ""
    };
    let text = format!(
        "name = \"double Gauss\"\nprincipal_distance_mm = 149.999958957\n\
         [sensor]\nwidth_px = 5200\nheight_px = 5200\npixel_um = 10.0\n\
         [distortion]\nk0 = {k0:e}\nk1 = {k1:e}\nk2 = {k2:e}\nk3 = {k3:e}\n\
         [limits]\nvh_per_s = [0.001, 0.17]\n{shutter}"
    );
    CameraFile::parse("double-gauss.toml", &text).unwrap().1
}

#[test]
fn camera_is_as_good_as_the_recentred_static_fit_in_double_precision() {
    let rows = truth();
    assert_eq!(rows.len(), 7 * 441);
    let lens = static_fit(&rows);
    let cameras = [false, true].map(|ramps| camera(&lens, ramps));
    for exposure_rows in rows.chunks(441) {
        let (mut of_fit, mut of_camera, mut of_calibration) = (0.0_f64, 0.0_f64, 0.0_f64);
        for row in exposure_rows {
            let measured = sum(row.ideal, row.moving);
            let still = sum(row.ideal, row.still);
            let point = measured.map(single);
            let exposure = Exposure {
                opening_offset_mm: Some(single(row.offset_mm)),
                ..Exposure::new(single(row.delta_mm / 149.999_958_957 / 0.02), 0.02)
            };
            let frame = cameras[usize::from(row.ramps)].frame(&exposure).unwrap();
            let centroid_mm = f64::from(frame.interior.motion.centroid_mm);
            assert!((centroid_mm - row.centroid_mm).abs() < 1e-7);
            let d = frame
                .correction
                .distortion(SensorPoint::new(point[0], point[1]));
            let found = [d.dx_mm, d.dy_mm].map(f64::from);
            let recentred = lens.displacement([measured[0], measured[1] - row.centroid_mm]);
            let calibrated = lens.displacement(still);
            for axis in 0..2 {
                of_fit = of_fit.max((recentred[axis] - row.moving[axis]).abs());
                of_camera = of_camera.max((found[axis] - row.moving[axis]).abs());
                of_calibration = of_calibration.max((calibrated[axis] - row.still[axis]).abs());
            }
        }
        assert!(
            of_camera <= of_fit + MARGIN_MM,
            "{of_camera} against {of_fit}"
        );
        // The calibration itself is good to 5 nm; 0.67 mm off the centre the field leaves the
        // calibrated range, and the fit is extrapolated.
        assert!(of_calibration < 5e-6, "{of_calibration}");
        assert!(of_fit < 15e-6, "{of_fit}");
    }
}

#[test]
fn static_correction_alone_is_micrometres_off_the_ray_traced_truth() {
    let rows = truth();
    let lens = static_fit(&rows);
    let most_mm = rows
        .iter()
        .map(|row| {
            let [dx, dy] = lens.displacement(sum(row.ideal, row.moving));
            (dx - row.moving[0]).abs().max((dy - row.moving[1]).abs())
        })
        .fold(0.0, f64::max);
    assert!(most_mm > 10e-3, "{most_mm}");
}
