//! Calibration of polynomial and grid: accuracy between the rows of the table, σ, run-out.

use fmc_adjustment::grid::calibration::GridCalibration;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_reference::lens::Lens;

use crate::simulated::{
    BOTH, LENS, RUN_OUT_UM, calibrated, camera, camera_with, enlargement, seen, table, table_with,
};

/// Returns the errors of a calibrated camera between the rows of the table, nm.
fn errors_nm(found: &GridCalibration, offset_mm: f64) -> Vec<f64> {
    errors_with(found, offset_mm, &RUN_OUT_UM)
}

/// Returns the errors with another run-out of the stage, nm.
fn errors_with(found: &GridCalibration, offset_mm: f64, run_out_um: &[f64]) -> Vec<f64> {
    let calibrated = &found.result.calibrated;
    let lens = Lens::of(&fmc_camera_file::CameraFile {
        distortion: calibrated.distortion.clone(),
        ..found.result.camera.clone()
    });
    let enlargement = enlargement(run_out_um, offset_mm);
    let side = || (0..52_u8).map(|index| 0.73 * (f64::from(index) - 25.5));
    let mut errors = Vec::new();
    for point in side().flat_map(|y| side().map(move |x| [x, y])) {
        let [measured, truth] = seen(point, offset_mm, run_out_um);
        let [x, y] = [measured[0], measured[1] + offset_mm];
        let mut sum = lens.displacement(point);
        for grid in &found.grids {
            let at = match grid.carrier {
                GridCarrier::Lens => [x, y].map(|value| value / (1.0 + enlargement)),
                GridCarrier::Sensor => measured,
            };
            let found = grid.spline.displacement(at);
            sum = [0, 1].map(|axis| sum[axis] + found[axis]);
        }
        errors
            .extend([0, 1].map(|axis| 1e6 * (sum[axis] + enlargement * point[axis] - truth[axis])));
    }
    errors
}

fn largest(errors: &[f64]) -> f64 {
    errors
        .iter()
        .fold(0.0, |largest, error| error.abs().max(largest))
}

#[expect(clippy::cast_precision_loss, reason = "some thousand numbers")]
fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// The number of the documents: 3 µm in waves of 20 mm, pitch 2 mm.
#[test]
fn waves_are_left_to_thirteen_nanometres() {
    let camera = camera();
    let found = calibrated(&table(&[0.0]), &camera, &LENS).unwrap();
    let errors = errors_nm(&found, 0.0);
    assert!(largest(&errors) <= 13.0, "{} nm", largest(&errors));
    assert!(rms(&errors) <= 0.6, "{} nm rms", rms(&errors));
    // The polynomial alone leaves micrometres.
    assert!(
        found.of_polynomial.largest_mm > 1.5e-3,
        "{:?}",
        found.of_polynomial
    );
    assert!(found.of_camera.largest_mm < 2e-6, "{:?}", found.of_camera);
    assert!(
        found.result.warnings.is_empty(),
        "{:?}",
        found.result.warnings
    );
}

/// A run-out of 2 µm per mm enlarges the image by 20 ppm: 0.5 µm in the corner.
#[test]
fn table_at_several_offsets_has_the_run_out_of_the_camera_file_taken_off() {
    let camera = camera();
    let rows = table(&[-0.8, 0.0, 0.9]);
    for carriers in [&LENS[..], &BOTH[..]] {
        let found = calibrated(&rows, &camera, carriers).unwrap();
        for offset_mm in [-0.8, 0.0, 0.4] {
            let errors = errors_nm(&found, offset_mm);
            assert!(
                largest(&errors) <= 13.0,
                "{offset_mm} mm: {} nm",
                largest(&errors)
            );
        }
    }
    let mut flat = camera;
    flat.fmc.flatness_um.clear();
    let found = calibrated(&rows, &flat, &LENS).unwrap();
    assert!(found.of_camera.largest_mm > 1e-4, "{:?}", found.of_camera);
}

/// A negative slope, a square alone, a constant with three powers: up to 0.1 ‰ of the image.
#[test]
fn run_outs_of_other_signs_and_powers_are_taken_off_as_well() {
    for run_out_um in [
        &[0.0, -3.0][..],
        &[0.0, 0.0, 6.0],
        &[-2.5, 1.2, -0.8, 2.4],
        &[4.0, -1.5, 0.0, 0.0, 3.0],
    ] {
        let camera = camera_with(run_out_um);
        let rows = table_with(&[-0.9, -0.2, 0.8], run_out_um);
        for carriers in [&LENS[..], &BOTH[..]] {
            let found = calibrated(&rows, &camera, carriers).unwrap();
            for offset_mm in [-0.9, 0.0, 0.5] {
                let errors = errors_with(&found, offset_mm, run_out_um);
                assert!(
                    largest(&errors) <= 13.0,
                    "{run_out_um:?} at {offset_mm} mm: {} nm",
                    largest(&errors)
                );
            }
        }
        // With the signs reversed the offsets disagree by tenths of a micrometre and more.
        let reversed: Vec<f64> = run_out_um.iter().map(|um| -um).collect();
        let found = calibrated(&rows, &camera_with(&reversed), &LENS).unwrap();
        assert!(
            found.of_camera.largest_mm > 2e-4,
            "{run_out_um:?}: {:?}",
            found.of_camera
        );
    }
}

#[test]
fn sigma_is_the_spread_of_the_errors() {
    const NOISE_MM: f64 = 1e-4;
    let camera = camera();
    let exact = table(&[0.0]);
    let mut random = fastrand::Rng::with_seed(7);
    let mut gaussian = || {
        let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
        radius * (std::f64::consts::TAU * random.f64()).cos()
    };
    let mut in_sigma = Vec::new();
    let mut sigma0 = Vec::new();
    for _ in 0..8 {
        let mut rows = exact.clone();
        for value in rows.iter_mut().flat_map(|row| &mut row.distortion_mm) {
            *value += NOISE_MM * gaussian();
        }
        let found = calibrated(&rows, &camera, &LENS).unwrap();
        sigma0.push(found.result.sigma0);
        for ((row, truth), noisy) in found.result.image_residuals.iter().zip(&exact).zip(&rows) {
            for axis in 0..2 {
                let tested = row.components[axis];
                let computed = noisy.distortion_mm[axis] - tested.residual;
                let sigma_mm = 1e-3 * found.result.sigma0 * (1.0 - tested.redundancy).sqrt();
                assert!(sigma_mm <= found.largest_sigma_mm * (1.0 + 1e-12));
                in_sigma.push((computed - truth.distortion_mm[axis]) / sigma_mm);
            }
        }
    }
    // σ0 in µm; 8 x 2700 errors of about 600 unknowns each.
    let sigma0 = rms(&sigma0);
    assert!((sigma0 / 0.1 - 1.0).abs() < 0.03, "{sigma0} µm");
    let spread = rms(&in_sigma);
    // σ counts on structure with second differences as large as all that the polynomial leaves;
    // that of this lens is smoother, so that σ is 5 % too large.
    assert!((0.92..1.0).contains(&spread), "{spread} σ");
}

#[test]
fn wrong_row_and_empty_cells_are_warned_of() {
    let camera = camera();
    let mut rows = table(&[0.0]);
    rows[700].distortion_mm[1] += 2e-3;
    let found = calibrated(&rows, &camera, &LENS).unwrap();
    let [warning] = &found.result.warnings[..] else {
        panic!("{:?}", found.result.warnings);
    };
    assert!(warning.contains("the worst line 702 ("), "{warning}");
    assert!(
        found
            .result
            .image_residuals
            .iter()
            .all(|row| !row.is_rejected)
    );

    let mut rows = table(&[0.0]);
    rows.retain(|row| row.measured_mm[0].hypot(row.measured_mm[1]) > 8.0);
    let found = calibrated(&rows, &camera, &LENS).unwrap();
    let warnings = found.result.warnings.join("\n");
    assert!(warnings.contains("hold no row of the table"), "{warnings}");

    let mut rows = table(&[0.0]);
    rows.retain(|row| row.line % 7 == 0);
    let found = calibrated(&rows, &camera, &LENS).unwrap();
    let warnings = found.result.warnings.join("\n");
    assert!(warnings.contains("the grid follows"), "{warnings}");
}

/// With the least weight of second differences they reach 95 µm, a slope of 0.024 and errors of 41
/// nm rms: nodes beyond the border, and what differs along the stage's axis alone.
#[test]
fn both_grids_of_a_table_with_noise_do_not_carry_it_from_one_to_the_other() {
    let camera = camera();
    let mut random = fastrand::Rng::with_seed(11);
    let mut rows = table(&[-0.9, 0.0, 0.9]);
    for value in rows.iter_mut().flat_map(|row| &mut row.distortion_mm) {
        // Evenly between ±0.17 µm: σ = 0.1 µm.
        *value += 3.4641e-4 * (random.f64() - 0.5);
    }
    let found = calibrated(&rows, &camera, &BOTH).unwrap();
    for grid in &found.grids {
        assert!(
            grid.largest_mm < 25e-3,
            "{:?}: {} mm",
            grid.carrier,
            grid.largest_mm
        );
        assert!(grid.slope < 3e-3, "{:?}: {}", grid.carrier, grid.slope);
    }
    let errors = errors_nm(&found, 0.4);
    assert!(rms(&errors) < 35.0, "{} nm rms", rms(&errors));
}
