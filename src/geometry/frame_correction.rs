//! Correction of one frame: every model folded into the evaluation form.

use super::brown::Brown;
use super::calibration::Calibration;
use super::evaluation_form::{Displacement, EvaluationForm, Jacobian};
use super::moments::CentralMoments;
use super::newton_step::longest_last_step2;
use super::principal_distance::FocusShift;
use super::principal_point::PrincipalPointMotion;
use super::sensor::{FmcAxis, Sensor, SensorPoint};

/// Largest sum of terms over the whole sensor that is left out of the evaluation, nm.
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
    /// Square of the longest Newton step that may be the last towards a measured point, mm².
    longest_last_step2: f32,
}

/// A model folded into the evaluation form.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fold {
    centre: SensorPoint,
    form: EvaluationForm,
    left_out_nm: f32,
}

impl Fold {
    /// Returns the fold of [`FrameCorrection::without_motion`].
    pub(crate) fn without_motion(calibration: &Calibration) -> Self {
        let parameters = calibration.parameters();
        Self {
            centre: parameters.principal_point,
            form: parameters.distortion.evaluation_form(),
            left_out_nm: 0.0,
        }
    }

    /// Returns the fold of [`FrameCorrection::exact`].
    pub(crate) fn exact(
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
        Self {
            centre,
            form,
            left_out_nm: (left_out_mm + run_out) * 1e6,
        }
    }

    /// Returns the fold of [`FrameCorrection::five_coefficient`].
    pub(crate) fn five_coefficient(
        calibration: &Calibration,
        motion: &PrincipalPointMotion,
    ) -> Option<Self> {
        let parameters = calibration.parameters();
        let still = parameters.distortion.evaluation_form();
        let fitted = parameters.fitted?;
        Some(Self {
            centre: parameters.principal_point,
            form: fitted.folded(still, fitted.regressor_mm(motion), parameters.axis),
            left_out_nm: 0.0,
        })
    }
}

impl FrameCorrection {
    /// Returns the static calibration about the calibrated principal point: the correction of
    /// software that does not know the motion.
    #[must_use]
    pub fn without_motion(calibration: &Calibration) -> Self {
        Self::folded(calibration, &Fold::without_motion(calibration))
    }

    /// Returns the exposure mean of the distortion: the calibration evaluated about the centroid
    /// principal point, with the focus shift and the μ₂ terms.
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
        Self::folded(calibration, &Fold::exact(calibration, motion, focus))
    }

    /// Returns the fitted five-coefficient model about the calibrated principal point, or `None` if
    /// the calibration has none.
    ///
    /// # Model
    /// As [`FiveCoefficients::folded`](super::five_coefficient::FiveCoefficients::folded). The
    /// fitted `K_m0` contains the focus shift of the calibration exposures.
    #[must_use]
    pub fn five_coefficient(
        calibration: &Calibration,
        motion: &PrincipalPointMotion,
    ) -> Option<Self> {
        let fold = Fold::five_coefficient(calibration, motion)?;
        Some(Self::folded(calibration, &fold))
    }

    /// Returns the correction of a fold.
    pub(crate) fn folded(calibration: &Calibration, fold: &Fold) -> Self {
        let Fold { centre, form, .. } = *fold;
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
            left_out_nm: fold.left_out_nm + dropped_nm,
            sensor: *calibration.sensor(),
            longest_last_step2: longest_last_step2(calibration, &form, centre),
        }
    }

    /// Returns true if a measured point is on the sensor.
    #[must_use]
    pub fn contains(&self, point: SensorPoint) -> bool {
        self.sensor.contains(point)
    }

    /// Returns the square of the longest step that may be the last towards a measured point, mm².
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
            within(point.x_mm, half_width),
            within(point.y_mm, half_height),
        )
    }

    /// The centre (cx, cy) about which the form is evaluated.
    #[must_use]
    pub const fn centre(&self) -> SensorPoint {
        self.centre
    }

    /// The coefficients of the fold.
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

    /// Returns the distortion at a measured point, measured - ideal.
    ///
    /// # Units and frames
    /// Takes a point of the sensor frame and returns mm. The result is valid on the sensor. Beyond
    /// it the polynomial continues without meaning, and a NaN stays a NaN: the caller checks with
    /// [`Sensor::contains`](super::sensor::Sensor::contains).
    #[inline]
    #[must_use]
    pub fn distortion(&self, measured: SensorPoint) -> Displacement {
        match self.terms {
            Terms::Short => self.evaluate::<false>(measured),
            Terms::Full => self.evaluate::<true>(measured),
        }
    }

    /// Returns the ideal point of a measured one.
    ///
    /// # Model
    /// `x' = x - Dx`, `y' = y - Dy`: the distortion is computed first, then subtracted once, so
    /// that the coordinate is rounded once. Plain multiplications and additions give the same bits
    /// on every machine.
    ///
    /// # Units and frames
    /// Sensor frame, mm; the domain is that of [`Self::distortion`].
    ///
    /// # Accuracy
    /// [`Self::left_out_nm`] and rounding. Proved for the published cameras without motion, the
    /// centre up to 0.25 mm beside the principal point (`docs/rounding.md`): x is off by at most
    /// 1.40 nm on the iXM-RS150F and 3.83 nm on the RC30, with half a unit in its last place
    /// (3.8 nm at 114 mm), and the distortion by at most 0.37 nm at a point from the centre, of
    /// which 0.11 nm were found (`tests/geometry/accuracy.rs`).
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

    /// Returns the derivatives of [`Self::distortion`] at a point of the sensor frame.
    #[must_use]
    pub fn jacobian(&self, point: SensorPoint) -> Jacobian {
        self.form
            .jacobian(point.x_mm - self.centre.x_mm, point.y_mm - self.centre.y_mm)
    }
}

/// Returns the number nearest to `value` that is at most `most` from zero; a NaN stays one.
fn within(value: f32, most: f32) -> f32 {
    if value.abs() > most {
        most.copysign(value)
    } else {
        value
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

/// Returns the lens about the centroid principal point with those μ₂ terms that fit the evaluation
/// form.
///
/// The terms of K1 and K2 partly cancel on real lenses, so that either all of them are taken or
/// none.
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

/// Returns a bound, mm per axis, on the error of the exposure mean of Δz, which leaves out that Δz
/// varies with c.
///
/// With dκ/dc = z'/L it consists of the covariance `μ₂z'/L` with X itself and, up to seven times
/// its slope, with the lens polynomial, and of the variance `μ₂(z'/L)²` of κ times X.
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

/// Returns a bound, mm per axis, on the terms of the exact mean that the evaluation form cannot
/// hold.
///
/// The terms are those of `docs/derivations/exposure_mean.txt`, each at its largest within r:
/// `μ₂(4|K2|r³ + 9|K3|r⁵)`, then μ₃ and μ₄ with their largest coefficients, and the higher moments
/// with |μₖ| ≤ μ₄·δᵏ⁻⁴.
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
            // The μ₂ terms amount to 12 nm here, rounding to 0.05 nm.
            assert!((a.dx_mm - b.dy_mm).abs() < 1e-7);
            assert!((a.dy_mm - b.dx_mm).abs() < 1e-7);
        }
        let still: EvaluationForm = with_second_moment(&lens, 0.0, FmcAxis::PlusX);
        assert_eq!(still, lens.evaluation_form());
    }
}
