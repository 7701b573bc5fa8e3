//! Motion of the principal point in an exposure, measured or planned.

use core::f32::consts::SQRT_2;

use super::{InFlight, Light, Phase};
use crate::flight::controller::setup::Setup;
use crate::flight::controller::stage::{ExposureMotion, StageMachine};
use crate::flight::controller::timing::STAMP_SIGMA_S;
use crate::flight::frame_record::Flag;
use crate::flight::principal_point_sigma::PrincipalPointSigma;
use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};

impl InFlight {
    /// Determines the motion of the stage after last light.
    pub(super) fn measure(&mut self, setup: &Setup, stage: &StageMachine) {
        let Phase::Closed(light) = self.phase else {
            return;
        };
        let motion = if !setup.camera.has_stage() {
            self.motion_of_rows(light, setup)
        } else if let Some((motion, is_whole)) = (!self.flags.contains(Flag::PlannedMotion))
            .then(|| stage.motion_between([light.opened, light.closed], setup))
            .flatten()
        {
            if !is_whole {
                self.flags.insert(Flag::ExtrapolatedMotion);
            }
            motion
        } else {
            self.planned_motion(light, setup, stage)
        };
        self.phase = Phase::Measured(light, motion);
    }

    /// Returns the motion of a TDI sensor's rows, which move as the clock drives them from first
    /// light on. Of a clock that had not been told to by then, nobody knows if it ran: σ and wander
    /// hold the difference to rows that stand.
    fn motion_of_rows(&self, light: Light, setup: &Setup) -> ExposureMotion {
        let planned = self.planned_travel(light);
        let motion = setup.camera.rows(planned);
        let [stood_mm, wander_mm] = if self.flags.contains(Flag::StaticCorrection) {
            [
                libm::fabsf(motion.centroid_mm - motion.opening_offset_mm),
                libm::fabsf(motion.travel_mm),
            ]
        } else {
            [0.0; 2]
        };
        // First light starts the rows: its stamp and that of the last one change the time between
        // alone, in which the charge lies where the last transfer has put it. The share of the
        // light before a transfer at u of the exposure changes by u times the transmission there:
        // by twice the share while the shutter opens, by half of the opening more than it from then
        // on.
        let shutter = setup.camera.shutter();
        let closing_mm = setup.camera.closing_mm(planned);
        let off_mm = libm::fabsf(closing_mm - motion.centroid_mm);
        let rows_mm = libm::fabsf(closing_mm - motion.opening_offset_mm);
        let opening = 0.5 * shutter.opening_fraction() / shutter.effective_fraction();
        let changes_mm = off_mm + off_mm.min(opening * rows_mm);
        let stamped_mm = changes_mm * SQRT_2 * STAMP_SIGMA_S / planned.exposure_s;
        ExposureMotion {
            motion,
            sigma: PrincipalPointSigma {
                frame_mm: libm::hypotf(stamped_mm, stood_mm),
                common_mm: 0.0,
            },
            wander_mm: wander_mm.max(setup.camera.steps_mm(planned)),
        }
    }

    /// Returns the planned motion, for an exposure without usable readings. Its σ is half the
    /// stroke; so is its wander if the stage was to move, since it may have gone anywhere.
    fn planned_motion(
        &mut self,
        light: Light,
        setup: &Setup,
        stage: &StageMachine,
    ) -> ExposureMotion {
        self.flags.insert(Flag::PlannedMotion);
        self.flags.insert(Flag::StaticCorrection);
        let (planned, shutter) = (self.planned_travel(light), setup.camera.shutter());
        ExposureMotion {
            motion: PrincipalPointMotion::from_plan(planned, shutter),
            sigma: sigma_of_unknown_place(setup, stage),
            wander_mm: if self.flags.contains(Flag::NoCompensation) {
                0.0
            } else {
                setup.half_stroke_mm()
            },
        }
    }

    pub(super) fn planned_travel(&self, light: Light) -> UniformTravel {
        UniformTravel {
            opening_offset_mm: self.planned_opening_mm,
            speed_mm_s: self.planned_travel_mm / self.asked.exposure.exposure_s,
            exposure_s: light.closed.seconds_since(light.opened),
        }
    }
}

/// Returns σ of a principal point whose place is not known: half the stroke. A place that is lost
/// is wrong by the same in all frames until it is found again; readings that are missing concern
/// their own frame.
pub(super) fn sigma_of_unknown_place(setup: &Setup, stage: &StageMachine) -> PrincipalPointSigma {
    let half_stroke_mm = setup.half_stroke_mm();
    if setup.camera.has_stage() && stage.is_place_lost() {
        PrincipalPointSigma {
            frame_mm: 0.0,
            common_mm: half_stroke_mm,
        }
    } else {
        PrincipalPointSigma {
            frame_mm: half_stroke_mm,
            common_mm: 0.0,
        }
    }
}
