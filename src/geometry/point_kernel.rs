//! Hot path: the correction of all points of a frame at once.

use fmc_camera_kernel::Coefficients;
#[cfg(host_kernel)]
use fmc_camera_kernel::host::Batch;
use fmc_camera_kernel::inverse::LastStep;

use super::evaluation_form::EvaluationForm;
use super::frame_correction::{FrameCorrection, Terms};
use super::sensor::SensorPoint;

/// Smallest number of points for which the kernel of a PC is called: below, finding its vectors
/// costs more than they gain.
#[cfg(host_kernel)]
const LEAST_BATCH: usize = 16;

/// The slices of x and y differ in length.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LengthsDiffer {
    /// Number of x.
    pub x: usize,
    /// Number of y.
    pub y: usize,
}

impl core::fmt::Display for LengthsDiffer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} x and {} y do not make points", self.x, self.y)
    }
}

impl core::error::Error for LengthsDiffer {}

impl FrameCorrection {
    /// Replaces every measured point of a slice by its ideal point.
    ///
    /// # Model
    /// [`Self::correct`], bit for bit, on every machine: the same operations in the same order,
    /// several points side by side. Points beyond the sensor and NaN give the same results as
    /// there; no point depends on another.
    ///
    /// The vectors of a Cortex-M55 take numbers below 2⁻¹²⁶ for zero. In a camera they occur only
    /// for a coordinate within 1e-21 mm of zero, which then differs by less than 1e-28 mm.
    ///
    /// # Units and frames
    /// Sensor frame, mm.
    ///
    /// # Accuracy
    /// That of [`Self::correct`]. It takes 24.1 instructions per point with the short kernel and
    /// 28.4 with the full one on Cortex-M4F and M7, and 7.1 and 9.9 on a Cortex-M55 compiled for
    /// its vectors, in slices of 1024 points; a call takes about 100 (`docs/instructions.csv`). On
    /// a PC the feature `host` takes its vectors, AVX-512, AVX2 or NEON.
    ///
    /// # Examples
    /// ```
    /// # use fmc_camera::{Brown, Calibration, CalibrationParameters, FrameCorrection, SensorPoint};
    /// let mut parameters = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    /// parameters.distortion = Brown { k1: 1e-6, ..Brown::NONE };
    /// let correction = FrameCorrection::without_motion(&Calibration::new(parameters)?);
    /// // K1·r² = 1e-6 * 500 of each coordinate.
    /// let mut points = [SensorPoint::new(10.0, 20.0), SensorPoint::new(-20.0, 10.0)];
    /// correction.correct_slice(&mut points);
    /// assert_eq!(points, [SensorPoint::new(9.995, 19.99), SensorPoint::new(-19.99, 9.995)]);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    #[inline]
    pub fn correct_slice(&self, points: &mut [SensorPoint]) {
        let pairs = bytemuck::must_cast_slice_mut(points);
        #[cfg(host_kernel)]
        if pairs.len() >= LEAST_BATCH {
            return self.batch().pairs(pairs);
        }
        match self.terms() {
            Terms::Short => fmc_camera_kernel::short_pairs(&self.coefficients(), pairs),
            Terms::Full => fmc_camera_kernel::full_pairs(&self.coefficients(), pairs),
        }
    }

    /// Does the same as [`Self::correct_slice`] for separate coordinates: `x_mm` and `y_mm` of the
    /// same points.
    ///
    /// # Errors
    /// [`LengthsDiffer`] unless there are as many x as y; then nothing is replaced.
    #[inline]
    pub fn correct_slice_xy(
        &self,
        x_mm: &mut [f32],
        y_mm: &mut [f32],
    ) -> Result<(), LengthsDiffer> {
        let (x, y) = (x_mm.len(), y_mm.len());
        if x != y {
            return Err(LengthsDiffer { x, y });
        }
        #[cfg(host_kernel)]
        if x >= LEAST_BATCH {
            self.batch().xy(x_mm, y_mm);
            return Ok(());
        }
        match self.terms() {
            Terms::Short => fmc_camera_kernel::short_xy(&self.coefficients(), x_mm, y_mm),
            Terms::Full => fmc_camera_kernel::full_xy(&self.coefficients(), x_mm, y_mm),
        }
        Ok(())
    }

    /// Returns the kernel of this PC for the frame.
    #[cfg(host_kernel)]
    fn batch(&self) -> Batch {
        Batch::new(self.coefficients(), self.terms()).in_one_thread()
    }

    /// Returns the numbers of the frame as the point kernel takes them: the centre and the folded
    /// form, in its order.
    ///
    /// # Examples
    /// ```
    /// # use fmc_camera::{Brown, Calibration, CalibrationParameters, FrameCorrection, SensorPoint};
    /// # let mut parameters = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    /// parameters.principal_point = SensorPoint::new(0.5, -0.25);
    /// parameters.distortion = Brown { k1: 1e-6, ..Brown::NONE };
    /// let frame = FrameCorrection::without_motion(&Calibration::new(parameters)?).coefficients();
    /// assert_eq!([frame.cx, frame.cy, frame.k1], [0.5, -0.25, 1e-6]);
    /// # Ok::<(), Box<dyn core::error::Error>>(())
    /// ```
    #[inline]
    #[must_use]
    pub fn coefficients(&self) -> Coefficients {
        self.form().coefficients(self.centre())
    }

    /// Returns the conditions under which the first Newton step of [`Self::distort`] is its last,
    /// as the point kernel takes them.
    #[inline]
    #[must_use]
    pub fn last_step(&self) -> LastStep {
        let farthest = self.sensor().farthest();
        LastStep {
            longest2_mm2: self.longest_last_step2(),
            farthest_mm: [farthest.x_mm, farthest.y_mm],
        }
    }
}

impl EvaluationForm {
    /// Returns the form about a centre as the point kernel takes it.
    #[inline]
    pub(super) const fn coefficients(&self, centre: SensorPoint) -> Coefficients {
        Coefficients {
            cx: centre.x_mm,
            cy: centre.y_mm,
            k0: self.k0,
            k1: self.k1,
            k2: self.k2,
            k3: self.k3,
            hx: self.hx,
            hy: self.hy,
            gx: self.gx,
            gy: self.gy,
            b1: self.b1,
            b2: self.b2,
            tx: self.tx,
            ty: self.ty,
        }
    }
}
