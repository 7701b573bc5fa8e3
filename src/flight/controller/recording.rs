//! The end of a frame: its record.

use super::frame::{FrameInFlight, MeasuredMotion};
use super::state::State;
use super::timing::{
    ATTITUDE_WITHIN_S, LONGEST_GAP, READING_GAP_PART, READING_GAP_S, STAMP_SIGMA_S,
};
use super::{Actions, Controller, act};
use crate::flight::camera;
use crate::flight::event::Action;
use crate::flight::exposure::{CorrectionModel, Exposure};
use crate::flight::fault::Faults;
use crate::flight::frame_record::{ExposedFrame, Flag, Flags, FrameRecord, Outcome, Reason};
use crate::flight::smear_prediction::Compensation;
use crate::flight::time::Time;
use crate::flight::vh::{VhEstimate, VhSource};
use crate::geometry::principal_point::{PrincipalPointMotion, UniformTravel};

impl Controller {
    /// The record of a trigger without an exposure.
    pub(super) fn refuse(
        &mut self,
        sequence: u32,
        trigger: Time,
        reason: Reason,
        faults: Faults,
        actions: &mut Actions,
    ) {
        self.records.finish(FrameRecord {
            sequence,
            trigger,
            outcome: Outcome::Refused(reason),
            faults,
            flags: Flags::NONE,
            calibration_crc: self.calibration_crc,
        });
        self.announce_refused(sequence, actions);
    }

    pub(super) fn announce_refused(&mut self, sequence: u32, actions: &mut Actions) {
        self.counts.refused = self.counts.refused.saturating_add(1);
        act(actions, Action::FrameReady(sequence));
    }

    /// Changes the frame in flight, if there is one.
    pub(super) fn change_frame(&mut self, change: impl FnOnce(&mut FrameInFlight)) {
        if let Some(frame) = &mut self.frame {
            change(frame);
        }
    }

    /// Works out how the stage moved in the exposure in flight. What follows from it takes as long again, and is left
    /// to the next round.
    pub(super) fn measure_exposure(&mut self) {
        let Some(mut frame) = self.frame else {
            return;
        };
        let (Some(opened), Some(closed)) = (frame.opened, frame.closed) else {
            return;
        };
        let mut flags = frame.flags;
        frame.measured = Some(self.motion_of(&frame, opened, closed, &mut flags));
        frame.flags = flags;
        self.frame = Some(frame);
    }

    /// Records the exposure in flight, and ends it.
    pub(super) fn record_exposure(&mut self, now: Time, actions: &mut Actions) {
        if self.frame.is_some_and(|frame| frame.measured.is_none()) {
            self.measure_exposure();
        }
        let Some(frame) = self.frame.take() else {
            return;
        };
        let (Some(opened), Some(closed), Some(measured)) =
            (frame.opened, frame.closed, frame.measured)
        else {
            return;
        };
        let mut flags = frame.flags;
        if frame.is_end_assumed {
            flags.insert(Flag::LastLightAssumed);
        }
        let MeasuredMotion {
            motion,
            mut sigma_mm,
            ..
        } = measured;
        if frame.is_end_assumed
            && let Some(last) = self.track.last()
        {
            // It may have been open until now: the centroid may lie half as far on.
            let closing_mm = motion.opening_offset_mm + motion.travel_mm;
            sigma_mm = sigma_mm.max(0.5 * libm::fabsf(last.offset_mm - closing_mm));
        }
        let exposure = Exposure {
            exposure_s: closed.seconds_since(opened),
            model: if flags.contains(Flag::StaticCorrection) {
                CorrectionModel::Static
            } else {
                frame.exposure.model
            },
            ..frame.exposure
        };
        let (predicted, sigma_mm) = match self.camera.frame_of(&exposure, &motion) {
            Ok(predicted) => (Some(predicted), sigma_mm),
            Err(_) => (self.standing(&exposure, &mut flags), self.half_stroke_mm()),
        };
        let outcome = if let Some(predicted) = predicted {
            self.latest = Some((frame.sequence, predicted));
            self.counts.exposed = self.counts.exposed.saturating_add(1);
            let measured = MeasuredMotion {
                sigma_mm,
                ..measured
            };
            let times = [opened, closed];
            Outcome::Exposed(self.exposed(&frame, times, &predicted, measured, &mut flags))
        } else {
            self.counts.refused = self.counts.refused.saturating_add(1);
            Outcome::Refused(Reason::Unusable)
        };
        self.records.finish(FrameRecord {
            sequence: frame.sequence,
            trigger: frame.trigger,
            outcome,
            faults: frame.faults,
            flags,
            calibration_crc: self.calibration_crc,
        });
        act(actions, Action::FrameReady(frame.sequence));
        self.track.keep_latest();
        if self.state == State::Exposing {
            self.go_back(now, actions);
        }
    }

    /// The motion as it was measured, or, where it was not, as it was planned.
    fn motion_of(
        &self,
        frame: &FrameInFlight,
        opened: Time,
        closed: Time,
        flags: &mut Flags,
    ) -> MeasuredMotion {
        let exposure_s = closed.seconds_since(opened);
        let shutter = self.camera.shutter();
        let planned = UniformTravel {
            opening_offset_mm: frame.planned_opening_mm,
            speed_mm_s: frame.planned_travel_mm / frame.exposure.exposure_s,
            exposure_s,
        };
        if !self.camera.has_stage() {
            // Rows move as the clock drives them.
            let motion = self.camera.rows(planned);
            return MeasuredMotion {
                motion,
                sigma_mm: libm::fabsf(planned.speed_mm_s) * STAMP_SIGMA_S,
                wander_mm: 0.0,
            };
        }
        let gap_s = READING_GAP_S.max(READING_GAP_PART * exposure_s);
        let measured = (!self.is_place_lost && !flags.contains(Flag::PlannedMotion))
            .then(|| self.track.path(opened, closed))
            .filter(|path| path.is_covered && path.longest_gap_s <= LONGEST_GAP * gap_s)
            .and_then(|path| {
                let motion =
                    PrincipalPointMotion::from_samples(&path.samples, exposure_s, shutter).ok()?;
                let is_whole = !path.is_continued && path.longest_gap_s <= gap_s;
                Some((motion, is_whole, path.longest_gap_s, path.wander_mm))
            });
        let Some((motion, is_whole, longest_gap_s, wander_mm)) = measured else {
            flags.insert(Flag::PlannedMotion);
            flags.insert(Flag::StaticCorrection);
            let motion = PrincipalPointMotion::from_plan(planned, shutter);
            let half_stroke_mm = self.half_stroke_mm();
            return MeasuredMotion {
                motion,
                sigma_mm: half_stroke_mm,
                // What had force on it may have gone anywhere.
                wander_mm: if flags.contains(Flag::NoCompensation) {
                    0.0
                } else {
                    half_stroke_mm
                },
            };
        };
        let step_mm = 1e-3 * self.settings.drive.encoder_step_um;
        let stamp_mm = motion.travel_mm / exposure_s * STAMP_SIGMA_S;
        // The encoder's own steps are no wander.
        let wander_mm = (wander_mm - step_mm).max(0.0);
        // A parabola that leaves its chord by so much over the exposure leaves it between two readings by the square of
        // their share of it.
        let share = (longest_gap_s / exposure_s).min(1.0);
        let bend_mm = wander_mm * share * share;
        let mut sigma_mm =
            libm::sqrtf(step_mm * step_mm / 12.0 + stamp_mm * stamp_mm + bend_mm * bend_mm);
        if !is_whole {
            flags.insert(Flag::ExtrapolatedMotion);
            // What a stage that follows may do unseen.
            sigma_mm = sigma_mm.max(1e-3 * self.settings.following_tolerance_um);
        }
        MeasuredMotion {
            motion,
            sigma_mm,
            wander_mm,
        }
    }

    /// The frame of a stage about which nothing is known.
    fn standing(&self, exposure: &Exposure, flags: &mut Flags) -> Option<camera::Frame> {
        flags.insert(Flag::PlannedMotion);
        flags.insert(Flag::StaticCorrection);
        let still = UniformTravel {
            opening_offset_mm: 0.0,
            speed_mm_s: 0.0,
            exposure_s: exposure.exposure_s,
        };
        let motion = PrincipalPointMotion::from_plan(still, self.camera.shutter());
        let exposure = Exposure {
            model: CorrectionModel::Static,
            ..*exposure
        };
        self.camera.frame_of(&exposure, &motion).ok()
    }

    fn half_stroke_mm(&self) -> f32 {
        0.5 * self.camera.calibration().record().stroke_mm
    }

    fn exposed(
        &self,
        frame: &FrameInFlight,
        [opened, closed]: [Time; 2],
        predicted: &camera::Frame,
        MeasuredMotion {
            sigma_mm,
            wander_mm,
            ..
        }: MeasuredMotion,
        flags: &mut Flags,
    ) -> ExposedFrame {
        let interior = predicted.record;
        let centroid = opened.plus_s(interior.motion.centroid_time_s);
        let attitude = self.attitude.as_ref().and_then(|(time, sample)| {
            let apart_s = libm::fabsf(centroid.seconds_since(*time));
            (apart_s <= ATTITUDE_WITHIN_S).then_some(sample)
        });
        // Without any V/H the largest that the camera may fly at bounds the smear.
        let vh = frame.vh.unwrap_or_else(|| VhEstimate {
            vh_per_s: self.camera.limits().vh_per_s[1],
            sigma_per_s: 0.0,
            age_s: 0.0,
            source: VhSource::Direct,
            extrapolated: true,
        });
        let smear = self.smear.of(
            &vh,
            attitude,
            &Compensation {
                exposure_s: interior.exposure_s,
                travel_mm: frame.exposure.direction.sign() * interior.motion.travel_mm,
                wander_mm,
                principal_point: interior.principal_point,
            },
        );
        if smear.is_with_attitude {
            flags.insert(Flag::WithAttitude);
        }
        let smear_um = smear.largest_um;
        let smear_px = self.smear.pixels(smear_um);
        if smear_px > self.settings.smear_budget_px {
            flags.insert(Flag::SmearOverBudget);
        }
        ExposedFrame {
            opened,
            closed,
            centroid,
            centroid_utc: self.utc.utc(centroid),
            vh: frame.vh,
            planned_opening_mm: frame.planned_opening_mm,
            planned_travel_mm: frame.planned_travel_mm,
            interior,
            principal_point_sigma_mm: sigma_mm,
            smear_um,
            smear_px,
        }
    }
}
