//! Travel of a real exposure: from the stage's present position, with time for a late shutter.

use super::{Camera, FrameError, Mechanism};
use crate::flight::exposure::{Exposure, Limits};
use crate::flight::stage::{Tracking, Travel};
use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use crate::geometry::range::{OutOfRange, Quantity};
use crate::geometry::tdi::{largest_lag, transfers};

impl Camera {
    /// Returns `true` if a stage moves the detector.
    #[must_use]
    pub(crate) const fn has_stage(&self) -> bool {
        self.run_up().is_some()
    }

    /// The exposures that the camera accepts.
    #[must_use]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Returns the travel of an exposure from the stage's present position, mm along the FMC axis;
    /// the stage stays at speed for `margin_s` longer than the exposure.
    ///
    /// # Errors
    /// [`FrameError`] for an exposure outside the limits, a speed beyond the stage's or a travel
    /// outside the stroke.
    pub fn travel(
        &self,
        from_mm: f32,
        exposure: &Exposure,
        margin_s: f32,
    ) -> Result<Travel, FrameError> {
        self.limits.check(exposure)?;
        let run_up = self.run_up().unwrap_or_default();
        let tracking = self.tracking_for(exposure, margin_s);
        Ok(self.stage.travel(from_mm, run_up, tracking)?)
    }

    /// Returns the position at which the stage waits for the trigger of an exposure, mm along the
    /// FMC axis.
    ///
    /// # Errors
    /// As [`Self::travel`].
    pub fn waiting_place_mm(&self, exposure: &Exposure, margin_s: f32) -> Result<f32, FrameError> {
        self.limits.check(exposure)?;
        let run_up = self.run_up().unwrap_or_default();
        let tracking = self.tracking_for(exposure, margin_s);
        Ok(self.stage.waiting_place_mm(run_up, tracking)?)
    }

    fn tracking_for(&self, exposure: &Exposure, margin_s: f32) -> Tracking {
        Tracking {
            margin_s,
            ..self.tracking(exposure)
        }
    }

    /// Returns the motion of rows that are clocked at the speed of a travel, for any number of
    /// rows: beyond [`MAX_ROWS`](crate::geometry::range::MAX_ROWS) it is the smooth motion, which
    /// then differs by less than a row in ten thousand.
    #[must_use]
    pub fn rows(&self, travel: UniformTravel) -> PrincipalPointMotion {
        let smooth = PrincipalPointMotion::from_plan(travel, &self.shutter);
        match self.mechanism {
            Mechanism::Stage { .. } => smooth,
            Mechanism::Tdi { first_transfer } => {
                let pixel_mm = self.calibration.sensor().pixel_mm();
                let in_rows = smooth.in_rows(pixel_mm, first_transfer, &self.shutter);
                in_rows.unwrap_or(smooth)
            }
        }
    }

    /// Returns the offset at last light, mm along the FMC axis: of the charge, if rows are clocked
    /// with the speed of a travel, or of a stage.
    pub(crate) fn closing_mm(&self, travel: UniformTravel) -> f32 {
        let travel_mm = travel.speed_mm_s * travel.exposure_s;
        let moved_mm = match self.mechanism {
            Mechanism::Stage { .. } => travel_mm,
            Mechanism::Tdi { first_transfer } => {
                let pixel_mm = self.calibration.sensor().pixel_mm();
                let rows = transfers(libm::fabsf(travel_mm) / pixel_mm, first_transfer);
                libm::copysignf(rows * pixel_mm, travel_mm)
            }
        };
        travel.opening_offset_mm + moved_mm
    }

    /// Returns the way of an image point to and fro on the charge that rows carry which are clocked
    /// at the speed of a travel, mm; 0 for a stage, which moves evenly.
    pub(crate) fn steps_mm(&self, travel: UniformTravel) -> f32 {
        match self.mechanism {
            Mechanism::Stage { .. } => 0.0,
            Mechanism::Tdi { first_transfer } => {
                let pixel_mm = self.calibration.sensor().pixel_mm();
                let travel_mm = libm::fabsf(travel.speed_mm_s * travel.exposure_s);
                pixel_mm * largest_lag(travel_mm / pixel_mm, first_transfer)
            }
        }
    }

    /// Checks an exposure time, s, against the camera's limits, whatever V/H is.
    ///
    /// # Errors
    /// [`OutOfRange`] with the camera's own limits.
    pub(crate) fn check_exposure_time(&self, exposure_s: f32) -> Result<(), OutOfRange> {
        let [least, most] = self.limits.exposure_s;
        Quantity::ExposureS.check_within(exposure_s, least, most)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::flight::camera::{Camera, CameraParameters};
    use crate::geometry::calibration::CalibrationParameters;
    use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};

    #[test]
    fn stage_moves_evenly_and_not_in_rows() {
        let calibration = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
        let camera = Camera::new(CameraParameters::new(calibration)).unwrap();
        let travel = UniformTravel {
            opening_offset_mm: 0.5,
            speed_mm_s: -10.0,
            exposure_s: 0.01,
        };
        let smooth = PrincipalPointMotion::from_plan(travel, camera.shutter());
        assert_eq!(camera.rows(travel), smooth);
        assert!((camera.closing_mm(travel) - 0.4).abs() < 1e-7);
        assert!(camera.steps_mm(travel).abs() <= 0.0);
    }
}
