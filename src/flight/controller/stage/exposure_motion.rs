//! Motion of the stage in an exposure, from its readings.

use super::StageMachine;
use crate::flight::controller::setup::Setup;
use crate::flight::controller::timing::{
    LONGEST_GAP, READING_GAP_PART, READING_GAP_S, STAMP_SIGMA_S,
};
use crate::flight::time::Time;
use crate::geometry::principal_point::PrincipalPointMotion;

/// Motion of the stage in an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct ExposureMotion {
    pub(in super::super) motion: PrincipalPointMotion,
    /// σ of the motion's centroid, mm.
    pub(in super::super) sigma_mm: f32,
    /// Departure of the stage from a straight line in time, mm.
    pub(in super::super) wander_mm: f32,
}

impl StageMachine {
    /// Returns the motion from first to last light, and `true` if readings cover all of it; `None`
    /// if there are too few, or if their zero is not known.
    pub(in super::super) fn motion_between(
        &self,
        [opened, closed]: [Time; 2],
        setup: &Setup,
    ) -> Option<(ExposureMotion, bool)> {
        if self.is_place_lost {
            return None;
        }
        let exposure_s = closed.seconds_since(opened);
        let gap_s = READING_GAP_S.max(READING_GAP_PART * exposure_s);
        let path = self.track.path(opened, closed);
        let longest_gap_s = path.longest_gap_s;
        if !(path.is_covered && longest_gap_s <= LONGEST_GAP * gap_s) {
            return None;
        }
        let shutter = setup.camera.shutter();
        let motion = PrincipalPointMotion::from_samples(&path.samples, exposure_s, shutter).ok()?;
        let step_mm = 1e-3 * setup.settings.drive.encoder_step_um;
        let stamp_mm = motion.travel_mm / exposure_s * STAMP_SIGMA_S;
        // The encoder's own steps do not count as wander.
        let wander_mm = (path.wander_mm - step_mm).max(0.0);
        // A parabola leaves its chord between two readings by the square of their share of the
        // exposure, relative to its departure over the whole exposure.
        let share = (longest_gap_s / exposure_s).min(1.0);
        let bend_mm = wander_mm * share * share;
        let mut sigma_mm =
            libm::sqrtf(step_mm * step_mm / 12.0 + stamp_mm * stamp_mm + bend_mm * bend_mm);
        let is_whole = !path.is_continued && longest_gap_s <= gap_s;
        if !is_whole {
            // A stage that follows may be off by this much between readings.
            sigma_mm = sigma_mm.max(1e-3 * setup.settings.following_tolerance_um);
        }
        let motion = ExposureMotion {
            motion,
            sigma_mm,
            wander_mm,
        };
        Some((motion, is_whole))
    }
}
