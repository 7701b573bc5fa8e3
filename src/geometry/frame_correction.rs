//! The correction of one frame: every model folded into the one evaluation form.

use super::brown::Brown;
use super::calibration::Calibration;
use super::evaluation_form::{Displacement, EvaluationForm, Jacobian};
use super::moments::CentralMoments;
use super::newton_step::longest_last_step2;
use super::principal_distance::FocusShift;
use super::principal_point::PrincipalPointMotion;
use super::sensor::{FmcAxis, Sensor, SensorPoint};

/// Terms that together are smaller than this over the whole sensor are not evaluated, nm.
pub const SHORT_KERNEL_NM: f32 = 0.5;

pub use fmc_camera_kernel::Terms;

/// A point with its correction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Corrected {
    /// The new coordinate.
    pub point: SensorPoint,
    /// The distortion, measured - ideal, as evaluated before it was subtracted or added.
    pub distortion: Displacement,
}

/// The correction of one frame, folded once, evaluated per point.
///
/// Made by [`Self::without_motion`], [`Self::exact`] or [`Self::five_coefficient`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameCorrection {
    centre: SensorPoint,
    form: EvaluationForm,
    terms: Terms,
    left_out_nm: f32,
    sensor: Sensor,
    /// Of Newton's steps to a measured point, mm².
    longest_last_step2: f32,
}

impl FrameCorrection {
    /// The static calibration about the calibrated principal point: what software does that knows
    /// nothing of the motion.
    #[must_use]
    pub fn without_motion(calibration: &Calibration) -> Self {
        let parameters = calibration.parameters();
        Self::folded(
            calibration,
            parameters.principal_point,
            parameters.distortion.evaluation_form(),
            0.0,
        )
    }

    /// The exposure mean of the distortion: the calibration evaluated about the centroid principal
    /// point, with the focus shift and the μ₂ terms.
    ///
    /// # Model
    /// `D̄(x, y) = E[D(x-x0, y-y0-c)]`, expanded exactly about c̄; of the terms of order μ₂ those
    /// of the evaluation form are kept: for e = ±y `k0 += 3μ₂K1`, `b1 -= 2μ₂K1`, `tx += μ₂P1`,
    /// `ty += 3μ₂P2`, `k1 += 6μ₂K2`, `k2 += 12μ₂K3`; for ±x the roles of the axes change.
    ///
    /// # Accuracy
    /// [`Self::left_out_nm`] bounds what is left out: `μ₂(-4K2X³, +4K2Y³)` and its K3 relatives,
    /// moments from μ₃ on, and the covariance of run-out and travel. Against the strict solver
    /// ≤ 1.5 nm on the published calibrations (`host-sim verify`).
    #[must_use]
    pub fn exact(
        calibration: &Calibration,
        motion: &PrincipalPointMotion,
        focus: &FocusShift,
    ) -> Self {
        let parameters = calibration.parameters();
        let lens = focus.distortion_at_fixed_distance(&parameters.distortion);
        let centre = parameters
            .axis
            .sensor_from_offset(parameters.principal_point, motion.centroid_mm);
        let form = with_second_moment(&lens, motion.moments.second, parameters.axis);
        let run_out = run_out_bound(calibration, motion, focus);
        let left_out_mm = higher_order_bound(&lens, motion, calibration.radius_mm());
        Self::folded(calibration, centre, form, (left_out_mm + run_out) * 1e6)
    }

    /// The fitted five-coefficient model about the calibrated principal point; `None` while the
    /// calibration has none.
    ///
    /// # Model
    /// As [`FiveCoefficients::folded`](super::five_coefficient::FiveCoefficients::folded). The
    /// fitted `K_m0` contains the focus shift of the calibration exposures.
    #[must_use]
    pub fn five_coefficient(
        calibration: &Calibration,
        motion: &PrincipalPointMotion,
    ) -> Option<Self> {
        let parameters = calibration.parameters();
        let still = parameters.distortion.evaluation_form();
        let fitted = parameters.fitted?;
        let form = fitted.folded(still, fitted.regressor_mm(motion), parameters.axis);
        Some(Self::folded(
            calibration,
            parameters.principal_point,
            form,
            0.0,
        ))
    }

    fn folded(
        calibration: &Calibration,
        centre: SensorPoint,
        form: EvaluationForm,
        model_left_out_nm: f32,
    ) -> Self {
        let half_width_mm = calibration.sensor().half_width_mm();
        let half_height_mm = calibration.sensor().half_height_mm();
        let dropped_nm = 1e6
            * form.dropped_by_short(
                half_width_mm + centre.x_mm.abs(),
                half_height_mm + centre.y_mm.abs(),
            );
        let (terms, dropped_nm) = if dropped_nm < SHORT_KERNEL_NM {
            (Terms::Short, dropped_nm)
        } else {
            (Terms::Full, 0.0)
        };
        Self {
            centre,
            form,
            terms,
            left_out_nm: model_left_out_nm + dropped_nm,
            sensor: *calibration.sensor(),
            longest_last_step2: longest_last_step2(calibration, &form, centre),
        }
    }

    /// Whether a measured point is on the sensor.
    #[must_use]
    pub fn contains(&self, point: SensorPoint) -> bool {
        self.sensor.contains(point)
    }

    /// The square of the longest step that may be the last towards a measured point, mm².
    pub(super) const fn longest_last_step2(&self) -> f32 {
        self.longest_last_step2
    }

    /// The pixel array.
    #[must_use]
    pub const fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// The point of the sensor nearest to `point`.
    pub(super) fn clamped(&self, point: SensorPoint) -> SensorPoint {
        let (half_width, half_height) = (self.sensor.half_width_mm(), self.sensor.half_height_mm());
        SensorPoint::new(
            point.x_mm.max(-half_width).min(half_width),
            point.y_mm.max(-half_height).min(half_height),
        )
    }

    /// The centre (cx, cy) about which the form is evaluated.
    #[must_use]
    pub const fn centre(&self) -> SensorPoint {
        self.centre
    }

    /// The folded numbers.
    #[must_use]
    pub const fn form(&self) -> &EvaluationForm {
        &self.form
    }

    /// The terms that are evaluated.
    #[must_use]
    pub const fn terms(&self) -> Terms {
        self.terms
    }

    /// Upper bound of what the fold and the kernel leave out of the model, per axis, nm.
    #[must_use]
    pub const fn left_out_nm(&self) -> f32 {
        self.left_out_nm
    }

    /// The distortion at a measured point, measured - ideal.
    ///
    /// # Units and frames
    /// A point of the sensor frame in, mm out. Valid on the sensor; beyond it the polynomial goes
    /// on without meaning, and a NaN stays a NaN: the caller asks
    /// [`Sensor::contains`](super::sensor::Sensor::contains).
    #[inline]
    #[must_use]
    pub fn distortion(&self, measured: SensorPoint) -> Displacement {
        match self.terms {
            Terms::Short => self.evaluate::<false>(measured),
            Terms::Full => self.evaluate::<true>(measured),
        }
    }

    /// The ideal point of a measured one.
    ///
    /// # Model
    /// `x' = x - Dx`, `y' = y - Dy`: the distortion first, then one subtraction, so that the
    /// coordinate is rounded once. Plain multiply and add: the same bits on every machine.
    ///
    /// # Units and frames
    /// Sensor frame, mm; domain as [`Self::distortion`].
    ///
    /// # Accuracy
    /// Half a unit in the last place of the coordinate (3.8 nm at 114 mm) on top of
    /// [`Self::left_out_nm`] and 1 ppm of rounding in the distortion (0.11 nm on the published
    /// cameras, `tests/geometry/accuracy.rs`).
    #[inline]
    #[must_use]
    pub fn correct(&self, measured: SensorPoint) -> Corrected {
        subtracted(measured, self.distortion(measured))
    }

    #[inline]
    fn evaluate<const FULL: bool>(&self, point: SensorPoint) -> Displacement {
        let x = point.x_mm - self.centre.x_mm;
        let y = point.y_mm - self.centre.y_mm;
        if FULL {
            self.form.displacement(x, y)
        } else {
            self.form.short_displacement(x, y)
        }
    }

    /// The derivatives of [`Self::distortion`] at a point of the sensor frame.
    #[must_use]
    pub fn jacobian(&self, point: SensorPoint) -> Jacobian {
        self.form
            .jacobian(point.x_mm - self.centre.x_mm, point.y_mm - self.centre.y_mm)
    }
}

#[inline]
fn subtracted(measured: SensorPoint, distortion: Displacement) -> Corrected {
    Corrected {
        point: SensorPoint::new(
            measured.x_mm - distortion.dx_mm,
            measured.y_mm - distortion.dy_mm,
        ),
        distortion,
    }
}

/// The lens about the centroid principal point with those μ₂ terms that fit the evaluation form.
///
/// K1 and K2 terms partly cancel on real lenses: all of them or none.
fn with_second_moment(lens: &Brown, mu2: f32, axis: FmcAxis) -> EvaluationForm {
    let mut form = lens.evaluation_form();
    form.k1 += 6.0 * mu2 * lens.k2;
    form.k2 += 12.0 * mu2 * lens.k3;
    if axis.is_x() {
        form.k0 += mu2 * lens.k1;
        form.b1 += 2.0 * mu2 * lens.k1;
        form.tx += 3.0 * mu2 * lens.p1;
        form.ty += mu2 * lens.p2;
    } else {
        form.k0 += 3.0 * mu2 * lens.k1;
        form.b1 -= 2.0 * mu2 * lens.k1;
        form.tx += mu2 * lens.p1;
        form.ty += 3.0 * mu2 * lens.p2;
    }
    form
}

/// A bound, mm per axis, on what the exposure mean of Δz leaves out: Δz varies with c.
///
/// With dκ/dc = z'/L: the covariance `μ₂z'/L` with X itself and, up to seven times its slope, with
/// the lens polynomial; and the variance `μ₂(z'/L)²` of κ times X.
fn run_out_bound(
    calibration: &Calibration,
    motion: &PrincipalPointMotion,
    focus: &FocusShift,
) -> f32 {
    let parameters = calibration.parameters();
    let slope = parameters.flatness.steepest(0.5 * parameters.stroke_mm) / focus.lever_mm();
    let lens = 1.0 + 7.0 * (1.0 - calibration.least_scale());
    slope * motion.moments.second * (lens + slope * calibration.radius_mm())
}

/// A bound, mm per axis, on the terms of the exact mean that the evaluation form has no place for.
///
/// From MODEL section 3, every power of X and Y bounded by r: `μ₂(4|K2|r³ + 9|K3|r⁵)`, then μ₃ and
/// μ₄ with the sums of their coefficients, and the moments above with |μₖ| ≤ μ₄·δᵏ⁻⁴.
fn higher_order_bound(lens: &Brown, motion: &PrincipalPointMotion, radius: f32) -> f32 {
    let CentralMoments {
        second,
        third,
        fourth,
    } = motion.moments;
    let third = third.abs();
    let delta = motion.travel_mm.abs();
    let r = radius;
    let r2 = r * r;
    let k1 = lens.k1.abs() * third;
    let k2 =
        lens.k2.abs() * (4.0 * second * r * r2 + 10.0 * third * r2 + fourth * (5.0 * r + delta));
    let k3 = lens.k3.abs()
        * (9.0 * second * r * r2 * r2
            + 35.0 * third * r2 * r2
            + fourth
                * (35.0 * r * r2
                    + 21.0 * delta * r2
                    + 7.0 * delta * delta * r
                    + delta * delta * delta));
    k1 + k2 + k3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::evaluation_form::EvaluationForm;

    #[test]
    fn second_moment_terms_of_x_are_those_of_y_with_the_axes_exchanged() {
        let lens = Brown {
            k0: 1e-4,
            k1: -2e-5,
            k2: 5e-9,
            k3: -1e-12,
            p1: 3e-6,
            p2: -4e-6,
            ..Brown::default()
        };
        let turned = Brown {
            p1: lens.p2,
            p2: lens.p1,
            ..lens
        };
        let along_x = with_second_moment(&lens, 0.01, FmcAxis::PlusX);
        let along_y = with_second_moment(&turned, 0.01, FmcAxis::MinusY);
        for (x, y) in [(20.0, -15.0), (3.0, 24.0)] {
            let a = along_x.displacement(x, y);
            let b = along_y.displacement(y, x);
            // The μ₂ terms are worth 12 nm here, rounding 0.05 nm.
            assert!((a.dx_mm - b.dy_mm).abs() < 1e-7);
            assert!((a.dy_mm - b.dx_mm).abs() < 1e-7);
        }
        let still: EvaluationForm = with_second_moment(&lens, 0.0, FmcAxis::PlusX);
        assert_eq!(still, lens.evaluation_form());
    }
}
