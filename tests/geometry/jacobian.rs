//! Jacobians against differences of the functions whose derivatives they are.

use crate::geometry::cameras;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::Calibration;
use fmc_camera::geometry::evaluation_form::Jacobian;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::sensor::SensorPoint;
use proptest::prelude::*;

/// Four units in the last place of a slope of 0.5; the smallest term of any lens contributes 2e-5.
const SLOPE_ROUNDING: f64 = 2.4e-7;
/// Four units in the last place of 6 mm of distortion; the smallest term contributes 1e-3 mm.
const VALUE_ROUNDING_MM: f64 = 1.9e-6;

/// Returns eq. 1 of Yuan et al. 2012 with decentring and affinity, in double precision, as printed.
pub(crate) fn brown(lens: &Brown, x: f64, y: f64) -> [f64; 2] {
    let Brown {
        k0,
        k1,
        k2,
        k3,
        p1,
        p2,
        b1,
        b2,
    } = *lens;
    let [k0, k1, k2, k3, p1, p2, b1, b2] = [k0, k1, k2, k3, p1, p2, b1, b2].map(f64::from);
    let r2 = x * x + y * y;
    let radial = k0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
    [
        x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y + b1 * x + b2 * y,
        y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y,
    ]
}

/// Returns the central differences of `f` with a step of 1 µm.
fn differences(f: impl Fn(f64, f64) -> [f64; 2], x: f64, y: f64) -> [f64; 4] {
    let step = 1e-3;
    let [right, left] = [f(x + step, y), f(x - step, y)];
    let [up, down] = [f(x, y + step), f(x, y - step)];
    [
        right[0] - left[0],
        up[0] - down[0],
        right[1] - left[1],
        up[1] - down[1],
    ]
    .map(|difference| difference / (2.0 * step))
}

fn largest_difference(jacobian: Jacobian, expected: [f64; 4]) -> f64 {
    [
        jacobian.dx_by_x,
        jacobian.dx_by_y,
        jacobian.dy_by_x,
        jacobian.dy_by_y,
    ]
    .into_iter()
    .zip(expected)
    .map(|(found, expected)| (f64::from(found) - expected).abs())
    .fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn brown_jacobian_is_the_limit_of_differences(
        lens in cameras::lenses(),
        x in -40.0_f32..40.0,
        y in -40.0_f32..40.0,
    ) {
        let expected = differences(|x, y| brown(&lens, x, y), x.into(), y.into());
        let off = largest_difference(lens.jacobian(x, y), expected);
        prop_assert!(off < SLOPE_ROUNDING, "{off}");
    }

    #[test]
    fn value_of_brown_is_that_of_the_printed_formula(
        lens in cameras::lenses(),
        x in -40.0_f32..40.0,
        y in -40.0_f32..40.0,
    ) {
        let [dx, dy] = brown(&lens, x.into(), y.into());
        let found = lens.displacement(x, y);
        prop_assert!((f64::from(found.dx_mm) - dx).abs() < VALUE_ROUNDING_MM);
        prop_assert!((f64::from(found.dy_mm) - dy).abs() < VALUE_ROUNDING_MM);
    }

    #[test]
    fn jacobian_of_a_frame_is_the_limit_of_its_own_differences(
        lens in cameras::lenses(),
        axis in cameras::axes(),
        motion in cameras::motions(),
        x in -40.0_f32..40.0,
        y in -40.0_f32..40.0,
    ) {
        let calibration = Calibration::new(cameras::square(lens, axis)).unwrap();
        let focus = cameras::focus(&calibration, 0.02);
        let correction = FrameCorrection::exact(&calibration, &motion, &focus);
        let form = *correction.form();
        let centre = correction.centre();
        let in_double = |x: f64, y: f64| {
            let (x, y) = (x - f64::from(centre.x_mm), y - f64::from(centre.y_mm));
            let r2 = x * x + y * y;
            let [k0, k1, k2, k3, hx, hy] =
                [form.k0, form.k1, form.k2, form.k3, form.hx, form.hy].map(f64::from);
            let [gx, gy, b1, b2, tx, ty] =
                [form.gx, form.gy, form.b1, form.b2, form.tx, form.ty].map(f64::from);
            let gain = k0 + r2 * (k1 + r2 * (k2 + r2 * k3)) + hx * x + hy * y;
            [x * gain + gx * r2 + b1 * x + b2 * y + tx, y * gain + gy * r2 + ty]
        };
        let expected = differences(in_double, x.into(), y.into());
        let off = largest_difference(correction.jacobian(SensorPoint::new(x, y)), expected);
        prop_assert!(off < SLOPE_ROUNDING, "{off}");
    }
}
