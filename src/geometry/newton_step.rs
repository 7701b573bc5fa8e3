//! One step of Newton's method towards the measured point, and the bound up to which it may be the
//! last.

use super::calibration::Calibration;
use super::evaluation_form::{Displacement, EvaluationForm, Jacobian};
use super::interval::lesser;
use super::sensor::SensorPoint;
use fmc_camera_kernel::Terms;

/// Largest error, nm, that the last Newton step of `distort` leaves in the displacement: a tenth of
/// the rounding of the distortion.
pub const LEFT_BY_ONE_STEP_NM: f32 = 0.01;

/// Longest last step, as a fraction of half the shorter side of the sensor. It keeps the start of
/// the step near the sensor, where the calibration has been shown to be one-to-one.
pub const MAX_LAST_STEP_FRACTION: f32 = 1e-3;

/// Returns the square of the longest step that may be the last towards a point of the sensor, mm².
///
/// # Model
/// Newton and Kantorovich: after a step of length η from where (I - J)⁻¹ is no larger than 1/m and,
/// around, J changes by no more than C per mm, the solution is no farther than hη with
/// `h = Cη/m ≤ 1/2`. Hence `η² ≤ m·e/C` for an error e of [`LEFT_BY_ONE_STEP_NM`]. m is the least
/// scale of the calibration, C the form's largest curvature.
pub(super) fn longest_last_step2(
    calibration: &Calibration,
    form: &EvaluationForm,
    centre: SensorPoint,
) -> f32 {
    let sensor = calibration.sensor();
    let (half_width, half_height) = (sensor.half_width_mm(), sensor.half_height_mm());
    let radius = longer_than_diagonal(
        half_width + centre.x_mm.abs(),
        half_height + centre.y_mm.abs(),
    );
    let curvature = form.largest_curvature(radius);
    let longest = MAX_LAST_STEP_FRACTION * lesser(half_width, half_height);
    let scale = lesser(calibration.least_scale(), 1.0);
    lesser(
        1e-6 * LEFT_BY_ONE_STEP_NM * scale / curvature,
        longest * longest,
    )
}

/// Returns at least the diagonal of a rectangle, and at most a twelfth more, without a root.
pub(super) fn longer_than_diagonal(width: f32, height: f32) -> f32 {
    let (longer, shorter) = if width >= height {
        (width, height)
    } else {
        (height, width)
    };
    longer + (core::f32::consts::SQRT_2 - 1.0) * shorter
}

/// Returns Newton's step for any derivatives: `(I - J)⁻¹` times the residual; not finite where I -
/// J is singular.
///
/// It divides by the determinant. [`Coefficients::stepped`] multiplies by its inverse, which
/// saves a division and rounds differently.
///
/// [`Coefficients::stepped`]: fmc_camera_kernel::Coefficients::stepped
pub(super) fn newton_step(j: Jacobian, residual: Displacement) -> Displacement {
    let scale_x = 1.0 - j.dx_by_x;
    let scale_y = 1.0 - j.dy_by_y;
    let determinant = scale_x * scale_y - j.dx_by_y * j.dy_by_x;
    Displacement {
        dx_mm: (scale_y * residual.dx_mm + j.dx_by_y * residual.dy_mm) / determinant,
        dy_mm: (j.dy_by_x * residual.dx_mm + scale_x * residual.dy_mm) / determinant,
    }
}

impl EvaluationForm {
    /// Takes Newton's step from `start` to the displacement of the ideal point (`x`, `y`), and
    /// returns it with the square of the step's length, mm².
    #[inline]
    pub(super) fn stepped(
        &self,
        terms: Terms,
        x: f32,
        y: f32,
        start: Displacement,
    ) -> (Displacement, f32) {
        let start = [start.dx_mm, start.dy_mm];
        let (next, step2_mm2) = self
            .coefficients(SensorPoint::default())
            .stepped_with(terms, x, y, start);
        (displacement(next), step2_mm2)
    }

    /// Returns the start from the radial terms for the ideal point (`x`, `y`).
    #[inline]
    pub(super) fn start(&self, terms: Terms, x: f32, y: f32) -> Displacement {
        let form = self.coefficients(SensorPoint::default());
        displacement(form.start_with(terms, x, y))
    }
}

/// Returns a displacement as the kernel has it with names.
#[inline]
pub(super) const fn displacement([dx_mm, dy_mm]: [f32; 2]) -> Displacement {
    Displacement { dx_mm, dy_mm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::brown::Brown;
    use crate::geometry::calibration::CalibrationParameters;
    use proptest::prelude::*;

    /// Returns the distortion and its derivatives by x and by y, in double precision.
    fn evaluated(form: &EvaluationForm, [x, y]: [f64; 2]) -> [[f64; 2]; 3] {
        let [k0, k1, k2, k3] = [form.k0, form.k1, form.k2, form.k3].map(f64::from);
        let [hx, hy, gx, gy] = [form.hx, form.hy, form.gx, form.gy].map(f64::from);
        let r2 = x * x + y * y;
        let gain = k0 + r2 * (k1 + r2 * (k2 + r2 * k3)) + hx * x + hy * y;
        let slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));
        let [by_x, by_y] = [slope * x + hx, slope * y + hy];
        [
            [x * gain + gx * r2, y * gain + gy * r2],
            [gain + x * by_x + 2.0 * gx * x, y * by_x + 2.0 * gy * x],
            [x * by_y + 2.0 * gx * y, gain + y * by_y + 2.0 * gy * y],
        ]
    }

    /// Returns the point to which one step from `measured` leads.
    fn stepped(form: &EvaluationForm, ideal: [f64; 2], measured: [f64; 2]) -> [f64; 2] {
        let [d, by_x, by_y] = evaluated(form, measured);
        let residual = [0, 1].map(|axis| measured[axis] - d[axis] - ideal[axis]);
        let (scale_x, scale_y) = (1.0 - by_x[0], 1.0 - by_y[1]);
        let determinant = scale_x * scale_y - by_x[1] * by_y[0];
        [
            measured[0] - (scale_y * residual[0] + by_y[0] * residual[1]) / determinant,
            measured[1] - (by_x[1] * residual[0] + scale_x * residual[1]) / determinant,
        ]
    }

    prop_compose! {
        /// Lenses, of which some three in four have a distortion that can be inverted.
        fn lens()(
            k1 in -9e-5_f32..9e-5,
            k2 in -3e-8_f32..3e-8,
            k3 in -1e-11_f32..1e-11,
            p in [-2e-5_f32..2e-5, -2e-5_f32..2e-5],
        ) -> CalibrationParameters {
            let mut parameters = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
            parameters.distortion = Brown { k1, k2, k3, p1: p[0], p2: p[1], ..Brown::NONE };
            parameters
        }
    }

    proptest! {
        #[test]
        fn longest_last_step_leaves_what_it_may(
            (parameters, calibration) in lens().prop_filter_map("not one-to-one", |parameters| {
                Some((parameters, Calibration::new(parameters).ok()?))
            }),
            at in [-1.0_f64..1.0, -1.0_f64..1.0],
            direction in 0.0_f64..core::f64::consts::TAU,
        ) {
            let form = parameters.distortion.evaluation_form();
            let step2 = longest_last_step2(&calibration, &form, SensorPoint::default());
            let measured = [40.0 * at[0], 30.0 * at[1]];
            let [d, ..] = evaluated(&form, measured);
            let ideal = [measured[0] - d[0], measured[1] - d[1]];
            let away = libm::sqrt(f64::from(step2));
            let [x, y] = [libm::cos(direction), libm::sin(direction)];
            let found = stepped(&form, ideal, [measured[0] + away * x, measured[1] + away * y]);
            let left_nm = 1e6 * libm::hypot(found[0] - measured[0], found[1] - measured[1]);
            prop_assert!(left_nm <= f64::from(LEFT_BY_ONE_STEP_NM), "{left_nm} nm");
        }
    }

    #[test]
    fn lens_of_the_field_may_end_with_a_step_of_a_micrometre() {
        let mut parameters = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
        parameters.distortion = Brown {
            k1: -1.6056e-5,
            k2: 6.18966e-9,
            k3: -1.31329e-12,
            ..Brown::NONE
        };
        let calibration = Calibration::new(parameters).unwrap();
        let form = parameters.distortion.evaluation_form();
        let step2 = longest_last_step2(&calibration, &form, SensorPoint::default());
        let step_um = 1e3 * libm::sqrtf(step2);
        assert!((0.8..1.2).contains(&step_um), "{step_um} µm");
        // Without distortion the sensor limits the step: half the shorter side is 20.03 mm.
        parameters.distortion = Brown::NONE;
        let calibration = Calibration::new(parameters).unwrap();
        let still = EvaluationForm::default();
        let step2 = longest_last_step2(&calibration, &still, SensorPoint::default());
        assert!((step2 - 0.02003 * 0.02003).abs() < 1e-6, "{step2} mm²");
    }

    #[test]
    fn value_of_the_common_scheme_has_the_bits_of_the_displacement() {
        let form = EvaluationForm {
            k0: 1e-3,
            k1: -1.6056e-5,
            k2: 6.18966e-9,
            k3: -1.31329e-12,
            hx: 1e-6,
            hy: -3e-6,
            gx: 2e-6,
            gy: -4e-6,
            b1: 1e-4,
            b2: -2e-4,
            tx: 1e-3,
            ty: -2e-3,
        };
        for (x, y) in [(0.0, 0.0), (20.0, -15.0), (-26.0, 19.3), (1e-3, -30.0)] {
            let kernel = form.coefficients(SensorPoint::default());
            let full = displacement(kernel.displacement::<true>(x, y));
            let short = displacement(kernel.displacement::<false>(x, y));
            assert_eq!(full, form.displacement(x, y));
            assert_eq!(short, form.short_displacement(x, y));
        }
    }
}
