//! The exposure mean expanded in central moments, against quadrature, and the terms that the
//! camera's fold leaves out of it.

use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera_file::{Axis, CameraFile};
use fmc_reference::exposure::{ExposureRequest, FocusFormula};
use fmc_reference::lens::Lens;
use fmc_reference::strict::{StrictSolver, Weight};

use crate::reference::support::{STRONG_LENS, camera_distortion, largest, points, square};

/// Returns the central moments μ₂..μ₇ of the offset over the exposure, mm², ..., by a fine sum.
fn moments(solver: &StrictSolver) -> [f64; 8] {
    let path = solver.path();
    let steps = 200_000_u32;
    let places = || (0..steps).map(|i| (f64::from(i) + 0.5) / f64::from(steps));
    let light: f64 = places().map(|u| path.transmission(u)).sum();
    let mut moments = [0.0; 8];
    for (power, moment) in (0_i32..).zip(&mut moments) {
        *moment = places()
            .map(|u| {
                let deviation = path.offset_mm(u) - path.centroid_mm();
                path.transmission(u) * deviation.powi(power)
            })
            .sum::<f64>()
            / light;
    }
    moments
}

/// Returns the static distortion with every moment term for e = +y
/// (`docs/derivations/exposure_mean.py`), and the part of the moment terms that the evaluation form
/// does not hold.
fn expanded(lens: &Lens, [x, y]: [f64; 2], mu: [f64; 8]) -> ([f64; 2], [f64; 2]) {
    let [_, k1, k2, k3] = lens.k;
    let [p1, p2] = lens.p;
    let [_, _, m2, m3, m4, m5, m6, m7] = mu;
    let [dx, dy] = lens.displacement([x, y]);
    let (x2, y2) = (x * x, y * y);
    let second_x = m2
        * (k1 * x
            + k2 * (2.0 * x * x2 + 6.0 * x * y2)
            + k3 * x * (3.0 * x2 * x2 + 18.0 * x2 * y2 + 15.0 * y2 * y2)
            + p1);
    let second_y = m2
        * (3.0 * k1 * y
            + k2 * (6.0 * x2 * y + 10.0 * y * y2)
            + k3 * y * (9.0 * x2 * x2 + 30.0 * x2 * y2 + 21.0 * y2 * y2)
            + 3.0 * p2);
    let higher_x = k2 * (-4.0 * m3 * x * y + m4 * x)
        + k3 * (-m3 * (12.0 * x * x2 * y + 20.0 * x * y * y2)
            + m4 * (3.0 * x * x2 + 15.0 * x * y2)
            - 6.0 * m5 * x * y
            + m6 * x);
    let higher_y = -k1 * m3
        + k2 * (-m3 * (2.0 * x2 + 10.0 * y2) + 5.0 * m4 * y - m5)
        + k3 * (-m3 * (3.0 * x2 * x2 + 30.0 * x2 * y2 + 35.0 * y2 * y2)
            + m4 * (15.0 * x2 * y + 35.0 * y * y2)
            - m5 * (3.0 * x2 + 21.0 * y2)
            + 7.0 * m6 * y
            - m7);
    // The coefficients k0 += 3μ₂K1, b1 -= 2μ₂K1, k1 += 6μ₂K2, k2 += 12μ₂K3, tx, ty hold this part
    // of the μ₂ terms.
    let r2 = x2 + y2;
    let radial = m2 * (3.0 * k1 + 6.0 * k2 * r2 + 12.0 * k3 * r2 * r2);
    let held_x = x * (radial - 2.0 * m2 * k1) + m2 * p1;
    let held_y = y * radial + 3.0 * m2 * p2;
    (
        [dx + second_x + higher_x, dy + second_y + higher_y],
        [second_x - held_x + higher_x, second_y - held_y + higher_y],
    )
}

/// Transforms a point of the sensor frame to the frame in which the FMC axis is +y.
fn turned(axis: Axis, [x, y]: [f64; 2]) -> [f64; 2] {
    match axis {
        Axis::PlusY => [x, y],
        Axis::MinusY => [x, -y],
        Axis::PlusX => [y, x],
        Axis::MinusX => [y, -x],
    }
}

/// Returns the lens in that frame, without affinity, whose mirror image is not an affinity of this
/// form.
fn turned_lens(axis: Axis, lens: &Lens) -> Lens {
    let [p1, p2] = lens.p;
    Lens {
        p: match axis {
            Axis::PlusY => [p1, p2],
            Axis::MinusY => [p1, -p2],
            Axis::PlusX => [p2, p1],
            Axis::MinusX => [p2, -p1],
        },
        b: [0.0, 0.0],
        ..*lens
    }
}

fn turned_back(axis: Axis, [x, y]: [f64; 2]) -> [f64; 2] {
    match axis {
        Axis::PlusY => [x, y],
        Axis::MinusY => [x, -y],
        Axis::PlusX => [y, x],
        Axis::MinusX => [-y, x],
    }
}

fn leaf_camera(axis: Axis) -> CameraFile {
    let lens = STRONG_LENS.replace("b1 = 4e-4\nb2 = -3e-4\n", "");
    let mut camera = square(&format!(
        "{lens}[shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.3\nclosing_fraction = 0.1\n"
    ));
    camera.fmc.axis = axis;
    camera
}

const AXES: [Axis; 4] = [Axis::PlusX, Axis::MinusX, Axis::PlusY, Axis::MinusY];

/// Returns an exposure with δ = 0.34 mm at f = 100 mm, the largest travel of
/// `docs/derivations/exposure_mean.py`.
fn request() -> ExposureRequest {
    ExposureRequest {
        opening_offset_mm: Some(0.145),
        ..ExposureRequest::planned(0.17, 0.02)
    }
}

#[test]
fn moment_terms_are_the_exposure_mean_exactly() {
    for axis in AXES {
        let camera = leaf_camera(axis);
        let solver = StrictSolver::new(&camera, &request(), Weight::Exposure);
        let mu = moments(&solver);
        let lens = turned_lens(axis, &Lens::of(&camera));
        for point in points(&camera) {
            let [x, y] = point.map(f64::from);
            let strict = solver.mean([x, y]).distortion_mm;
            let [x0, y0] = camera.principal_point_mm;
            let [along_x, along_y] = turned(axis, [x - x0, y - y0]);
            let centred = [along_x, along_y - solver.path().centroid_mm()];
            let (mean, _) = expanded(&lens, centred, mu);
            // The moments come from a sum of finite steps, accurate to 0.001 nm.
            assert!(
                largest(strict, turned_back(axis, mean)) < 1e-9,
                "{axis:?} {point:?}"
            );
        }
    }
}

#[test]
fn fold_leaves_out_what_theory_says_and_states_a_bound_for_it() {
    let mut most_left_out_mm = 0.0_f64;
    for axis in AXES {
        let camera = leaf_camera(axis);
        let solver = StrictSolver::new(&camera, &request(), Weight::Exposure);
        let mu = moments(&solver);
        let lens = turned_lens(axis, &Lens::of(&camera));
        let exposure = Exposure {
            opening_offset_mm: Some(0.145),
            ..Exposure::new(0.17, 0.02)
        };
        for point in points(&camera) {
            let [x, y] = point.map(f64::from);
            let strict = solver.mean([x, y]).distortion_mm;
            let (found, bound_mm) = camera_distortion(&camera, &exposure, point);
            let [x0, y0] = camera.principal_point_mm;
            let [along_x, along_y] = turned(axis, [x - x0, y - y0]);
            let centred = [along_x, along_y - solver.path().centroid_mm()];
            let (_, left_out) = expanded(&lens, centred, mu);
            let [left_x, left_y] = turned_back(axis, left_out);
            let [strict_x, strict_y] = strict;
            // Single precision rounds up to 4 mm of distortion by 0.7 nm.
            let expected = [strict_x - left_x, strict_y - left_y];
            assert!(largest(found, expected) < 7e-7, "{axis:?} {point:?}");
            let left_out_mm = left_x.abs().max(left_y.abs());
            assert!(left_out_mm <= bound_mm, "{left_out_mm} > {bound_mm}");
            most_left_out_mm = most_left_out_mm.max(left_out_mm);
        }
    }
    // The check sees the terms in question: 2.7 nm, four times the rounding.
    assert!(most_left_out_mm > 2.5e-6, "{most_left_out_mm}");
}

/// Compares the camera with the strict solver for one lens; returns the largest difference and the
/// bound of what the fold leaves out, mm.
fn differences(more: &str, request: &ExposureRequest, exposure: &Exposure) -> [f64; 2] {
    let camera = square(more);
    let solver = StrictSolver::new(&camera, request, Weight::Exposure);
    let (mut most_mm, mut bound_mm) = (0.0_f64, 0.0);
    for point in points(&camera) {
        let strict = solver.mean(point.map(f64::from)).distortion_mm;
        let (found, bound) = camera_distortion(&camera, exposure, point);
        most_mm = most_mm.max(largest(found, strict));
        bound_mm = bound;
    }
    [most_mm, bound_mm]
}

#[test]
fn every_kind_of_term_left_out_is_in_the_stated_bound() {
    let leaf = "[shutter]\nprofile = \"trapezoid\"\nopening_fraction = 0.9\n";
    let exposure = Exposure {
        opening_offset_mm: Some(0.145),
        ..Exposure::new(0.17, 0.02)
    };
    for (kind, more) in [
        (
            "K1 with a skew shutter",
            format!("[distortion]\nk1 = 2e-5\n{leaf}"),
        ),
        ("K2", "[distortion]\nk2 = 8e-9\n".to_owned()),
        ("K3", "[distortion]\nk3 = 2e-12\n".to_owned()),
        ("run-out", "[fmc]\nflatness_um = [0.0, 200.0]\n".to_owned()),
    ] {
        let [most_mm, bound_mm] = differences(&more, &request(), &exposure);
        // Single precision rounds up to 5 mm of distortion by 0.5 nm.
        assert!(most_mm <= bound_mm + 5e-7, "{kind}: {most_mm} > {bound_mm}");
        assert!(
            most_mm > 1e-6 || kind.starts_with("K1"),
            "{kind}: {most_mm} shows nothing"
        );
    }
    let printed = ExposureRequest {
        focus_formula: FocusFormula::Printed,
        ..request()
    };
    let exposure = Exposure {
        focus_sign: FocusSign::Printed,
        ..exposure
    };
    let more = "[fmc]\nflatness_um = [0.0, 200.0]\n";
    let [most_mm, bound_mm] = differences(more, &printed, &exposure);
    assert!(
        most_mm > 1e-6 && most_mm <= bound_mm + 5e-7,
        "{most_mm} {bound_mm}"
    );
}

#[test]
fn decentring_keeps_its_second_moment_along_each_axis() {
    let exposure = Exposure {
        opening_offset_mm: Some(0.145),
        ..Exposure::new(0.17, 0.02)
    };
    for axis in ["+x", "-x", "+y", "-y"] {
        // μ₂P is 1 nm and 3 nm; single precision rounds 1 mm of distortion by less than 0.25 nm.
        let more = format!("[distortion]\np1 = 1e-4\np2 = -1e-4\n[fmc]\naxis = \"{axis}\"\n");
        let [most_mm, bound_mm] = differences(&more, &request(), &exposure);
        assert!(
            most_mm <= bound_mm + 2.5e-7,
            "{axis}: {most_mm} > {bound_mm}"
        );
    }
}
