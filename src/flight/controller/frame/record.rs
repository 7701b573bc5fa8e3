//! The record of an exposure.

use super::motion::sigma_of_unknown_place;
use super::{FrameMachine, InFlight, Light, Phase};
use crate::flight::camera;
use crate::flight::controller::aircraft::Aircraft;
use crate::flight::controller::setup::Setup;
use crate::flight::controller::stage::{ExposureMotion, StageMachine};
use crate::flight::controller::timing::STAMP_SIGMA_S;
use crate::flight::exposure::{CorrectionModel, Exposure};
use crate::flight::frame_record::{ExposedFrame, Flag, Flags, Outcome, Reason};
use crate::flight::play_watch::is_play_in_error;
use crate::flight::record_log::Entry;
use crate::flight::time::Time;

/// A frame that has been recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) struct Recorded {
    pub(in super::super) sequence: u32,
    /// Its motion is that of the encoder.
    pub(in super::super) is_measured: bool,
}

impl FrameMachine {
    /// Records the exposure in flight, and ends it. A shutter whose last light was not seen may
    /// have been open until `until`. Returns `None` before last light.
    pub(in super::super) fn record(
        &mut self,
        setup: &Setup,
        stage: &StageMachine,
        aircraft: &mut Aircraft,
        until: Time,
    ) -> Option<Recorded> {
        let frame = self.in_flight.as_mut()?;
        frame.measure(setup, stage);
        let Phase::Measured(light, measured) = frame.phase else {
            return None;
        };
        let sequence = frame.asked.sequence;
        let mut flags = frame.flags;
        let mut sigma = measured.sigma;
        if setup.camera.has_stage() {
            let drive = &setup.settings.drive;
            let is_counted = !drive.is_absolute();
            if drive.is_stepped() && !flags.contains(Flag::PlannedMotion) {
                flags.insert(Flag::NotMeasured);
            }
            if is_counted && (!stage.index.is_referenced(drive) || stage.play_watch.disagrees()) {
                flags.insert(Flag::Unreferenced);
            }
            if is_counted && !flags.contains(Flag::PlannedMotion) {
                // The mark may have been crossed since the readings.
                let passed_mm = setup.stage_tolerance().unseen_mm();
                sigma.common_mm = stage.index.sigma_mm(sigma.common_mm, drive, passed_mm);
                let sign = setup.settings.direction.sign();
                let grown_mm = stage.play_watch.off_mm();
                if grown_mm > 0.0 && is_play_in_error(drive, stage.is_pushed_along(setup), sign) {
                    sigma.common_mm = libm::hypotf(sigma.common_mm, grown_mm);
                }
                sigma.frame_mm = libm::hypotf(sigma.frame_mm, stage.off_mm());
            }
        }
        let mut off_s = 0.0;
        if light.is_end_assumed {
            flags.insert(Flag::LastLightAssumed);
            // The centroid may lie half as far on as the shutter was open for longer.
            let tolerance_s = setup.settings.shutter_tolerance_s;
            off_s = 0.5 * until.seconds_since(light.closed).max(tolerance_s);
            let later_mm = if setup.camera.has_stage() {
                let closing_mm = measured.motion.opening_offset_mm + measured.motion.travel_mm;
                let last = stage.track().last();
                last.map_or(0.0, |last| 0.5 * (last.offset_mm - closing_mm))
            } else {
                off_s * frame.planned_travel(light).speed_mm_s
            };
            sigma.frame_mm = sigma.frame_mm.max(libm::fabsf(later_mm));
        }
        let unseen_s = frame.unseen_s(light);
        if unseen_s > 0.0 {
            // The centroid may lie half of it earlier.
            let exposure_s = light.closed.seconds_since(light.opened);
            let speed_mm_s = measured.motion.travel_mm / exposure_s;
            off_s = 0.5 * unseen_s;
            sigma.frame_mm = libm::hypotf(sigma.frame_mm, speed_mm_s * off_s);
        }
        let exposure = Exposure {
            exposure_s: light.closed.seconds_since(light.opened),
            model: if flags.contains(Flag::StaticCorrection) {
                CorrectionModel::Static
            } else {
                frame.asked.exposure.model
            },
            ..frame.asked.exposure
        };
        let predicted = setup.camera.frame_of(&exposure, &measured.motion).ok();
        let predicted = predicted.or_else(|| {
            sigma = sigma_of_unknown_place(setup, stage);
            flags.insert(Flag::PlannedMotion);
            flags.insert(Flag::StaticCorrection);
            setup.standing_frame(&exposure)
        });
        let outcome = if let Some(predicted) = predicted {
            self.kept.set_latest(sequence, predicted);
            let measured = ExposureMotion { sigma, ..measured };
            let mut exposed =
                frame.exposed(light, &predicted, &measured, setup, aircraft, &mut flags);
            if let Some(utc) = &mut exposed.centroid_utc {
                // Half of the variances of first and last light.
                let stamps_s2 = 0.5 * STAMP_SIGMA_S * STAMP_SIGMA_S;
                let variance_s2 = utc.sigma_s * utc.sigma_s + off_s * off_s;
                utc.sigma_s = fmc_camera_kernel::sqrt(variance_s2 + stamps_s2);
            }
            Outcome::Exposed(exposed)
        } else {
            Outcome::Refused(Reason::Unusable)
        };
        self.kept.finish(Entry {
            sequence,
            trigger: frame.asked.trigger,
            outcome,
            faults: frame.faults,
            flags,
        });
        self.in_flight = None;
        Some(Recorded {
            sequence,
            is_measured: !flags.contains(Flag::PlannedMotion),
        })
    }
}

impl InFlight {
    fn exposed(
        &self,
        light: Light,
        predicted: &camera::Frame,
        measured: &ExposureMotion,
        setup: &Setup,
        aircraft: &mut Aircraft,
        flags: &mut Flags,
    ) -> ExposedFrame {
        let interior = predicted.interior;
        let centroid = light.opened.plus_s(interior.motion.centroid_time_s);
        let motion = aircraft.motion_at(centroid, setup.settings);
        let wander_mm = measured.wander_mm;
        let (vh, direction) = (self.asked.vh, self.asked.exposure.direction);
        let smear = setup.predict_smear(vh, direction, &interior, wander_mm, &motion);
        if smear.is_with_attitude {
            flags.insert(Flag::WithAttitude);
        }
        let smear_um = smear.largest_um;
        let smear_px = setup.smear.pixels(smear_um);
        if smear_px > setup.settings.smear_budget_px {
            flags.insert(Flag::SmearOverBudget);
        }
        flags.insert_all(aircraft.tell());
        ExposedFrame {
            opened: light.opened,
            closed: light.closed,
            centroid,
            centroid_utc: aircraft.utc.utc(centroid),
            vh: self.asked.vh,
            planned_opening_mm: self.planned_opening_mm,
            planned_travel_mm: self.planned_travel_mm,
            interior,
            principal_point_sigma: measured.sigma,
            smear_um,
            smear_px,
        }
    }
}
