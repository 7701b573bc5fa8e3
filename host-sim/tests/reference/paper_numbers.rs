//! Numbers of docs/errata.md, computed independently.

use fmc_camera_file::CameraFile;
use fmc_reference::exposure::{ExposureRequest, FocusFormula};
use fmc_reference::fitted::FittedModel;
use fmc_reference::lens::Lens;
use fmc_reference::strict::{Reading, StrictSolver, Weight};
use fmc_reference::verification::grid;

use crate::reference::support::{published, square};

/// Returns a K1 lens with the given distortion, relative, at the corner of 80.64 mm square.
fn lens(relative: f64) -> CameraFile {
    let k1 = relative / (2.0 * 40.32 * 40.32);
    let mut camera = square(&format!("[distortion]\nk1 = {k1:e}\n"));
    camera.principal_point_mm = [0.0, 0.0];
    camera
}

/// Returns an exposure with δ = 170 µm, opened at the calibrated principal point.
fn request() -> ExposureRequest {
    ExposureRequest {
        opening_offset_mm: Some(0.0),
        ..ExposureRequest::planned(0.17, 0.01)
    }
}

/// Returns the largest length of `error` over the sensor, µm.
fn most_um(camera: &CameraFile, error: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
    grid::points(camera.half_format_mm())
        .points()
        .map(|point| {
            let [x, y] = error([point.x_mm, point.y_mm].map(f64::from));
            1e3 * x.hypot(y)
        })
        .fold(0.0, f64::max)
}

fn minus([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax - bx, ay - by]
}

#[test]
fn printed_terms_triple_the_error_of_the_static_correction() {
    for (relative, static_um, printed_um, literal_um) in [
        (0.0003, 0.0571, 0.1712, 17.1),
        (0.012, 2.2853, 6.8469, 684.3),
    ] {
        let camera = lens(relative);
        let solver = StrictSolver::new(&camera, &request(), Weight::Exposure);
        let printed = FittedModel::printed(&camera, solver.path().travel_mm);
        let strict = |point| solver.mean(point).distortion_mm;
        let without = most_um(&camera, |p| {
            minus(Lens::of(&camera).displacement(p), strict(p))
        });
        let with_printed = most_um(&camera, |p| minus(printed.distortion(p), strict(p)));
        let literal = most_um(&camera, |p| {
            minus(solver.total(p, Reading::Literal).distortion_mm, strict(p))
        });
        assert!((without / static_um - 1.0).abs() < 0.002, "{without}");
        assert!(
            (with_printed / printed_um - 1.0).abs() < 0.002,
            "{with_printed}"
        );
        // The literal reading counts the distortion twice, so its error is the whole distortion at
        // the corner (docs/errata.md, Y4).
        assert!((literal / literal_um - 1.0).abs() < 0.002, "{literal}");
    }
}

#[test]
fn two_weights_differ_by_less_than_a_nanometre_on_the_real_lenses() {
    let mut most_um_of_all = 0.0_f64;
    for camera in published() {
        for exposure in grid::exposures(&camera) {
            if exposure.exposure_s < 0.009 {
                continue;
            }
            let mut camera = camera.clone();
            camera.fmc.strategy = exposure.strategy;
            let request = ExposureRequest::planned(exposure.vh_per_s, exposure.exposure_s);
            let light = StrictSolver::new(&camera, &request, Weight::Exposure);
            let arc = StrictSolver::new(&camera, &request, Weight::ArcLength);
            let difference = most_um(&camera, |p| {
                let arc = arc.mean(p);
                assert!(
                    arc.error_mm <= 1e-8,
                    "{}: {:e} mm",
                    camera.name,
                    arc.error_mm
                );
                minus(arc.distortion_mm, light.mean(p).distortion_mm)
            });
            most_um_of_all = most_um_of_all.max(difference);
        }
    }
    assert!(
        (5e-4..=7.4e-4).contains(&most_um_of_all),
        "{most_um_of_all} µm"
    );
}

#[test]
fn arc_length_of_a_constant_distortion_has_the_plain_mean_as_its_limit() {
    let still = square("");
    let slight = square("[distortion]\nk1 = 1e-14\n");
    for camera in [still, slight] {
        let arc = StrictSolver::new(&camera, &request(), Weight::ArcLength);
        let light = StrictSolver::new(&camera, &request(), Weight::Exposure);
        for point in [[0.0, 0.0], [10.0, -20.0], [0.03, 0.035]] {
            let (arc, light) = (arc.mean(point), light.mean(point));
            assert!(arc.distortion_mm.iter().all(|d| d.is_finite()));
            let [dx, dy] = minus(arc.distortion_mm, light.distortion_mm);
            assert!(dx.abs() < 1e-8 && dy.abs() < 1e-8 && arc.error_mm < 1e-8);
        }
    }
}

#[test]
fn five_micrometres_of_focus_outweigh_the_motion_on_metric_lenses() {
    let mut range_um = [f64::INFINITY, 0.0_f64];
    for camera in published()
        .into_iter()
        .filter(|camera| camera.name.starts_with("RC30"))
    {
        let request = ExposureRequest {
            focus_shift_mm: 0.005,
            ..ExposureRequest::planned(0.1, 0.003)
        };
        let solver = StrictSolver::new(&camera, &request, Weight::Exposure);
        let lens = Lens::of(&camera);
        let [x0, y0] = camera.principal_point_mm;
        let [x, y] = camera.half_format_mm();
        let [dx, dy] = minus(
            solver.mean([x, y]).distortion_mm,
            lens.displacement([x - x0, y - y0]),
        );
        let change_um = 1e3 * dx.hypot(dy);
        range_um = [range_um[0].min(change_um), range_um[1].max(change_um)];
    }
    // Δz/L·r with L = f = 153 mm and r = 161.6 mm is 5.27 µm.
    assert!(range_um[0] > 5.0 && range_um[1] < 5.5, "{range_um:?}");
}

#[test]
fn physical_and_printed_focus_have_opposite_signs() {
    let camera = square("");
    let corner = camera.half_format_mm();
    let at = |formula| {
        let request = ExposureRequest {
            focus_shift_mm: 0.010,
            focus_formula: formula,
            ..request()
        };
        let solver = StrictSolver::new(&camera, &request, Weight::Exposure);
        let [dx, _] = solver.mean(corner).distortion_mm;
        dx / (corner[0] - camera.principal_point_mm[0])
    };
    // f = 100 mm: +1.000e-4 of the radius, printed -1.000e-4.
    assert!((at(FocusFormula::Physical) - 1.0e-4).abs() < 1e-7);
    assert!((at(FocusFormula::Printed) + 1.0e-4).abs() < 1e-7);
}

#[test]
fn arc_length_counts_the_run_out_of_the_stage() {
    let camera = square("[distortion]\nk1 = -1e-6\n[fmc]\nflatness_um = [0.0, 20.0, 5.0]\n");
    for focus_formula in [FocusFormula::Physical, FocusFormula::Printed] {
        let request = ExposureRequest {
            focus_formula,
            ..request()
        };
        let solver = StrictSolver::new(&camera, &request, Weight::ArcLength);
        for point in [[40.0, 40.0], [-30.0, 10.0], [5.0, -35.0]] {
            // The hodograph as a polygon, each side weighted by its length.
            let steps = 4000;
            let place = |i: i32| f64::from(i) / f64::from(steps);
            let (mut arc, mut sum) = (0.0, [0.0, 0.0]);
            for i in 0..steps {
                let (a, b) = (
                    solver.distortion(point, place(i)),
                    solver.distortion(point, place(i + 1)),
                );
                let [dx, dy] = minus(b, a);
                let length = dx.hypot(dy);
                arc += length;
                sum = [
                    sum[0] + length * f64::midpoint(a[0], b[0]),
                    sum[1] + length * f64::midpoint(a[1], b[1]),
                ];
            }
            let [dx, dy] = minus(solver.mean(point).distortion_mm, sum.map(|s| s / arc));
            assert!(
                dx.abs() < 1e-9 && dy.abs() < 1e-9,
                "{focus_formula:?} {point:?}: {dx:e} {dy:e}"
            );
        }
    }
}
