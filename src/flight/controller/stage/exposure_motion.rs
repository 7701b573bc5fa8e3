//! Motion of the stage in an exposure, from its readings.

use super::StageMachine;
use crate::flight::controller::setup::Setup;
use crate::flight::controller::timing::{
    LONGEST_GAP, READING_GAP_PART, READING_GAP_S, STAMP_SIGMA_S, TICK_S,
};
use crate::flight::drive::settings::DriveSettings;
use crate::flight::principal_point_sigma::PrincipalPointSigma;
use crate::flight::time::Time;
use crate::geometry::principal_point::PrincipalPointMotion;

/// Part of a bend of the path by which the stage may leave the straight line between two readings,
/// as σ. A push at a time that nobody knows leaves the line by 0 to 1 of the bend that is seen.
const BEND_PART: f32 = 0.33;

/// Steps of the encoder that look like a bend: half a step each in two of its three readings, and
/// one in the middle.
const BEND_STEPS: f32 = 2.0;

/// Motion of the stage in an exposure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct ExposureMotion {
    pub(in super::super) motion: PrincipalPointMotion,
    /// σ of the motion's centroid.
    pub(in super::super) sigma: PrincipalPointSigma,
    /// Departure of the stage from a straight line in time, to both sides together, or of the rows
    /// of a TDI sensor, mm.
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
        let drive = &setup.settings.drive;
        let shutter = setup.camera.shutter();
        let motion = PrincipalPointMotion::from_samples(&path.samples, exposure_s, shutter).ok()?;
        let step_mm = 1e-3 * drive.coarseness_um();
        // The encoder's own steps do not count as wander.
        let wander_mm = (path.wander_mm - step_mm).max(0.0);
        let share = (longest_gap_s / exposure_s).min(1.0);
        let [first, .., last] = path.samples[..] else {
            return None;
        };
        #[expect(clippy::cast_precision_loss, reason = "at most 66")]
        let intervals = path.samples.len().saturating_sub(1) as f32;
        // Of a long exposure not all readings are kept.
        let read = intervals * exposure_s / (last.time_s - first.time_s);
        let mut sigma = sigma_of_readings(drive, &motion, exposure_s, read, path.play_sigma_mm);
        let bend_mm = (path.bend_mm - BEND_STEPS * step_mm).max(0.0);
        // The bend is that of moves a tick long: less of it fits between places that are nearer.
        let part = BEND_PART * (longest_gap_s / TICK_S).min(1.0);
        sigma.frame_mm = libm::hypotf(sigma.frame_mm, part * bend_mm * share);
        let is_whole = !path.is_continued && longest_gap_s <= gap_s;
        if !is_whole {
            // A stage that follows may be off by this much between readings.
            let following_mm = setup.stage_tolerance().following_mm;
            sigma.frame_mm = sigma.frame_mm.max(following_mm);
        }
        let motion = ExposureMotion {
            motion,
            sigma,
            wander_mm,
        };
        Some((motion, is_whole))
    }
}

/// Returns σ of a motion's centroid from the encoder's readings.
///
/// # Model
/// With q the encoder's step, v the speed, n - 1 the number of intervals between readings in the
/// exposure (`read`) and c̄ the centroid's offset: of the frame `q²/(12·n) + σ_n²/N + (v·σ_t)²`,
/// common to the flight `q²/12 + σ_0² + (s·c̄)² + (v·σ_a)² + σ_p²`. A
/// reading is wrong by up to half a step; n readings of a stage that moves on by a step or more
/// from one to the next are wrong independently. The phase of the steps to the calibrated position
/// is the same for all frames, as are σ of the zero `σ_0`, of the scale s, of the readings' age
/// `σ_a` and of the play `σ_p`. `σ_t` is [`STAMP_SIGMA_S`]. Counts that may be lost unseen are
/// added by [`IndexWatch`](crate::flight::index_watch::IndexWatch), with the record, and readings
/// that have moved at rest by [`StageRest`](crate::flight::stage_rest::StageRest). An absolute
/// sensor loses none; it has the noise `σ_n` in each reading, moved or not, of which the mean by
/// the trapezoidal rule over N = n - 1 intervals keeps `σ_n²/N`. A stage that nothing measures is
/// off its steps by `following_sigma_um`, common to the flight.
fn sigma_of_readings(
    drive: &DriveSettings,
    motion: &PrincipalPointMotion,
    exposure_s: f32,
    read: f32,
    play_sigma_mm: f32,
) -> PrincipalPointSigma {
    let square = |value: f32| value * value;
    let step_mm = 1e-3 * drive.encoder_step_um;
    let speed_mm_s = motion.travel_mm / exposure_s;
    let moved_steps = libm::fabsf(motion.travel_mm) / step_mm;
    let readings = 1.0 + read.min(moved_steps);
    let step_variance = square(step_mm) / 12.0;
    let mut frame_variance = step_variance / readings + square(speed_mm_s * STAMP_SIGMA_S);
    if drive.is_absolute() {
        frame_variance += square(1e-3 * drive.position_command.sensor_noise_um) / read.max(1.0);
    }
    let mut common_variance = step_variance
        + square(1e-3 * drive.zero_sigma_um)
        + square(1e-6 * drive.encoder_scale_ppm * motion.centroid_mm)
        + square(speed_mm_s * drive.reading_age_sigma_s)
        + square(play_sigma_mm);
    if drive.is_stepped() {
        common_variance += square(1e-3 * drive.stepper.following_sigma_um);
    }
    PrincipalPointSigma {
        frame_mm: fmc_camera_kernel::sqrt(frame_variance),
        common_mm: fmc_camera_kernel::sqrt(common_variance),
    }
}
