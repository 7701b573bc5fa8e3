//! Terms of the exposure mean that the point kernel leaves out of a coordinate.

use super::evaluation_form::Displacement;
use super::frame_correction::{FrameCorrection, Terms};
use super::sensor::{FmcAxis, SensorPoint};

/// The second-moment terms of the exposure mean that the evaluation form cannot hold, and those
/// that the short kernel drops.
///
/// The default leaves nothing out. A coordinate in single precision has no digits for them: less
/// than a nanometre in an exposure of 1/50 s with a 50 mm lens. One in double precision has, and
/// they are added to its distortion.
///
/// # Model
/// The rest of the mean of `docs/derivations/exposure_mean.txt` beyond
/// [`FrameCorrection::exact`](FrameCorrection::exact), for e = ±y
///
/// `dx = -4μ₂K2·X³ + 3μ₂K3·X·R(Y² - 3X²)`, `dy = 4μ₂K2·Y³ + 3μ₂K3·Y·R(3Y² - X²)`,
///
/// and its negative for e = ±x, counted from the centroid principal point; of the short kernel
/// `b1·X + b2·Y + tx` and `ty`.
///
/// # Examples
/// ```
/// use fmc_camera::geometry::brown::Brown;
/// use fmc_camera::geometry::frame_correction::FrameCorrection;
/// use fmc_camera::geometry::left_out_terms::LeftOut;
/// use fmc_camera::geometry::sensor::FmcAxis;
/// use fmc_camera::{Calibration, CalibrationParameters, SensorPoint};
///
/// let mut parameters = CalibrationParameters::new(50.0, [4000, 4000], 10.0);
/// parameters.distortion = Brown { k2: 1e-8, ..Brown::NONE };
/// let still = FrameCorrection::without_motion(&Calibration::new(parameters)?);
/// let terms = LeftOut::new(&still, 0.0025, FmcAxis::PlusY);
/// let left_out = terms.displacement(SensorPoint::new(10.0, 20.0));
/// // -4·0.0025·1e-8·10³ mm and 4·0.0025·1e-8·20³ mm.
/// assert!((left_out.dx_mm + 1e-7).abs() < 1e-13 && (left_out.dy_mm - 8e-7).abs() < 1e-12);
/// # Ok::<(), fmc_camera::geometry::calibration::CalibrationError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeftOut {
    centre: SensorPoint,
    /// 4μ₂K2, mm⁻², with the sign of the axis.
    cubic: f32,
    /// 3μ₂K3, mm⁻⁴, with the sign of the axis.
    quintic: f32,
    b1: f32,
    b2: f32,
    tx: f32,
    ty: f32,
}

impl LeftOut {
    /// Returns the terms that the correction of a frame leaves out.
    ///
    /// # Units and frames
    /// `second_moment_mm2` is μ₂ of the principal point's motion along `axis`, mm²; 0 for a
    /// correction other than [`FrameCorrection::exact`], which does not hold the motion.
    #[must_use]
    pub fn new(correction: &FrameCorrection, second_moment_mm2: f32, axis: FmcAxis) -> Self {
        let form = correction.form();
        let mu2 = if axis.is_x() {
            -second_moment_mm2
        } else {
            second_moment_mm2
        };
        // The form's k₂ is K2 + 12μ₂K3.
        let k2 = form.k2 - 12.0 * second_moment_mm2 * form.k3;
        let [b1, b2, tx, ty] = match correction.terms() {
            Terms::Short => [form.b1, form.b2, form.tx, form.ty],
            Terms::Full => [0.0; 4],
        };
        Self {
            centre: correction.centre(),
            cubic: 4.0 * mu2 * k2,
            quintic: 3.0 * mu2 * form.k3,
            b1,
            b2,
            tx,
            ty,
        }
    }

    /// Returns what is left out of the distortion at a measured point, measured - ideal.
    ///
    /// # Units and frames
    /// Sensor frame, mm; the domain is that of [`FrameCorrection::distortion`].
    ///
    /// # Accuracy
    /// With it the exposure mean of the published 50 mm lenses is within 0.2 nm of the strict
    /// solver in exposures of up to 1/50 s at 0.17 s⁻¹, most of it the rounding of the distortion
    /// (`bindings/python/tests/test_accuracy.py`).
    #[inline]
    #[must_use]
    pub fn displacement(&self, measured: SensorPoint) -> Displacement {
        let x = measured.x_mm - self.centre.x_mm;
        let y = measured.y_mm - self.centre.y_mm;
        let (x2, y2) = (x * x, y * y);
        let quintic = self.quintic * (x2 + y2);
        Displacement {
            dx_mm: x * (quintic * (y2 - 3.0 * x2) - self.cubic * x2 + self.b1)
                + self.b2 * y
                + self.tx,
            dy_mm: y * (quintic * (3.0 * y2 - x2) + self.cubic * y2) + self.ty,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::brown::Brown;
    use crate::geometry::calibration::{Calibration, CalibrationParameters};
    use crate::geometry::principal_distance::{FocusShift, FocusSign};
    use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
    use crate::geometry::shutter::{Shutter, ShutterProfile};

    const LENS: Brown = Brown {
        k0: 0.0,
        k1: -1.46e-5,
        k2: 4.06e-9,
        k3: -4.1e-13,
        p1: 3.4e-6,
        p2: 4.4e-6,
        b1: 0.0,
        b2: 0.0,
    };

    /// Brown's distortion in double precision at a point counted from the principal point.
    fn brown([x, y]: [f64; 2]) -> [f64; 2] {
        let [k1, k2, k3, p1, p2] = [LENS.k1, LENS.k2, LENS.k3, LENS.p1, LENS.p2].map(f64::from);
        let r2 = x * x + y * y;
        let radial = r2 * (k1 + r2 * (k2 + r2 * k3));
        [
            x * radial + p1 * (r2 + 2.0 * x * x) + 2.0 * p2 * x * y,
            y * radial + p2 * (r2 + 2.0 * y * y) + 2.0 * p1 * x * y,
        ]
    }

    fn exact(
        lens: Brown,
        travel_mm: f32,
        axis: FmcAxis,
    ) -> (FrameCorrection, PrincipalPointMotion) {
        let mut parameters = CalibrationParameters::new(50.0, [14_204, 10_652], 3.76);
        parameters.distortion = lens;
        parameters.axis = axis;
        let calibration = Calibration::new(parameters).unwrap();
        let travel = UniformTravel {
            opening_offset_mm: -0.5 * travel_mm,
            speed_mm_s: 50.0 * travel_mm,
            exposure_s: 0.02,
        };
        let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
        let motion = PrincipalPointMotion::from_plan(travel, &shutter);
        let focus = FocusShift {
            shift_mm: 0.0,
            principal_distance_mm: 50.0,
            exit_pupil_mm: parameters.exit_pupil_mm,
            sign: FocusSign::Physical,
        };
        (
            FrameCorrection::exact(&calibration, &motion, &focus),
            motion,
        )
    }

    /// A uniform exposure has the central moments δ²/12 and δ⁴/80 alone; at δ = 0.4 mm the fourth
    /// is 0.01 nm, and single precision rounds 0.3 mm of distortion to 0.03 nm in several
    /// operations.
    #[test]
    fn exposure_mean_with_what_is_left_out_is_the_mean_along_either_axis() {
        const TRAVEL_MM: f32 = 0.4;
        const STEPS: u32 = 4000;
        for axis in [
            FmcAxis::PlusY,
            FmcAxis::MinusY,
            FmcAxis::PlusX,
            FmcAxis::MinusX,
        ] {
            let (correction, motion) = exact(LENS, TRAVEL_MM, axis);
            let terms = LeftOut::new(&correction, motion.moments.second, axis);
            let (mut without, mut with) = (0.0_f64, 0.0_f64);
            for place in 0..49_u8 {
                let (x, y) = (f32::from(place % 7) - 3.0, f32::from(place / 7) - 3.0);
                let point = SensorPoint::new(8.5 * x, 6.5 * y);
                let mut mean = [0.0; 2];
                for step in 0..STEPS {
                    let part = (f64::from(step) + 0.5) / f64::from(STEPS) - 0.5;
                    let offset = f64::from(TRAVEL_MM) * part;
                    let [mut x, mut y] = [point.x_mm, point.y_mm].map(f64::from);
                    if axis.is_x() {
                        x -= offset;
                    } else {
                        y -= offset;
                    }
                    let [dx, dy] = brown([x, y]);
                    mean[0] += dx / f64::from(STEPS);
                    mean[1] += dy / f64::from(STEPS);
                }
                let found = correction.distortion(point);
                let rest = terms.displacement(point);
                for (mean, found, rest) in [
                    (mean[0], found.dx_mm, rest.dx_mm),
                    (mean[1], found.dy_mm, rest.dy_mm),
                ] {
                    let error = f64::from(found) - mean;
                    without = without.max(1e6 * error.abs());
                    with = with.max(1e6 * (error + f64::from(rest)).abs());
                }
            }
            assert!(without > 3.0, "{axis:?}: {without} nm");
            assert!(with < 0.2, "{axis:?}: {with} nm");
        }
    }

    #[test]
    fn terms_of_the_short_kernel_are_those_that_it_drops() {
        let sheared = Brown { b2: 1e-10, ..LENS };
        let (correction, _) = exact(sheared, 0.02, FmcAxis::PlusY);
        assert_eq!(correction.terms(), Terms::Short);
        let form = correction.form();
        let dropped = [form.b1, form.b2, form.tx, form.ty];
        assert!(dropped.iter().all(|term| *term != 0.0), "{dropped:?}");
        let terms = LeftOut::new(&correction, 0.0, FmcAxis::PlusY);
        let centre = correction.centre();
        let rest = terms.displacement(SensorPoint::new(centre.x_mm + 20.0, centre.y_mm - 10.0));
        let dx_mm = 20.0 * form.b1 - 10.0 * form.b2 + form.tx;
        assert!((rest.dx_mm - dx_mm).abs() < 1e-5 * dx_mm.abs(), "{rest:?}");
        assert!(
            (rest.dy_mm - form.ty).abs() < 1e-5 * form.ty.abs(),
            "{rest:?}"
        );
    }
}
