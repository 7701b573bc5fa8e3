//! Shutter of a frame: its command, its edges, and their time limits.

use super::{FrameMachine, InFlight, Light, Phase};
use crate::flight::controller::setup::Setup;
use crate::flight::controller::stage::StageMachine;
use crate::flight::controller::timing::{
    LEAD_S, READING_WITHIN_S, SHUTTER_GIVEN_UP_S, SHUTTER_MISSING_S, STAMP_SIGMA_S,
};
use crate::flight::event::ShutterEdge;
use crate::flight::fault::Fault;
use crate::flight::frame_record::Reason;
use crate::flight::time::Time;

/// Difference of an exposure from the one asked for that two stamps make, s.
const STAMPS_S: f32 = 4.0 * STAMP_SIGMA_S;

/// Action that is due for the frame in flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) enum Due {
    /// Nothing is due, or nothing that concerns the other machines.
    Nothing,
    /// The shutter is to open at a time, for an exposure, s; the rows of a TDI sensor move at
    /// `rows_mm_s`, mm/s.
    Open {
        at: Time,
        exposure_s: f32,
        rows_mm_s: f32,
    },
    /// The frame is to be called off: the stage is not at speed, or first light has not come.
    CallOff(Reason),
    /// The shutter has been open for too long and is to be told to close.
    Close,
    /// The shutter did not close when told to: the exposure is to be recorded, with a fault.
    GivenUp,
    /// The exposure is to be recorded.
    Record,
}

/// Findings of an edge of the shutter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in super::super) struct Edge {
    pub(in super::super) is_first_light: bool,
    /// First light has come before the shutter was told to open.
    pub(in super::super) is_unasked: bool,
    pub(in super::super) fault: Option<Fault>,
    /// The shutter is to close, or stay closed.
    pub(in super::super) is_to_close: bool,
}

impl FrameMachine {
    /// Takes an edge of the shutter's sensor. A fault that it shows goes into the record.
    pub(in super::super) fn see_edge(
        &mut self,
        time: Time,
        edge: ShutterEdge,
        tolerance_s: f32,
    ) -> Edge {
        let frame = self.in_flight.as_mut();
        let seen = frame.and_then(|frame| match edge {
            ShutterEdge::Opened => frame.open(time, tolerance_s),
            ShutterEdge::Closed => frame.close(time, tolerance_s),
        });
        let seen = seen.unwrap_or_else(|| {
            self.kept.count_unexpected_edge();
            Edge {
                fault: Some(Fault::ShutterUnexpected),
                // A second opening edge must not close the shutter of the exposure under way.
                is_to_close: edge == ShutterEdge::Opened && !self.is_exposing(),
                ..Edge::default()
            }
        });
        if let Some(fault) = seen.fault {
            self.note(fault);
        }
        seen
    }

    /// Returns the action that is due for the frame in flight in this round.
    pub(in super::super) fn look(&mut self, now: Time, setup: &Setup, stage: &StageMachine) -> Due {
        let Some(frame) = &mut self.in_flight else {
            return Due::Nothing;
        };
        let tolerance_s = setup.settings.shutter_tolerance_s;
        match frame.phase {
            Phase::RunUp { first_light } => frame.tell(now, first_light, setup, stage),
            Phase::Tracking { first_light }
                if now.seconds_since(first_light) > tolerance_s + SHUTTER_MISSING_S =>
            {
                Due::CallOff(Reason::ShutterMissing)
            }
            Phase::Triggered { .. } | Phase::Tracking { .. } => Due::Nothing,
            Phase::Exposing {
                opened,
                told_to_close,
            } => frame.await_end(now, opened, told_to_close, tolerance_s),
            Phase::Closed(Light { closed, .. }) => {
                let is_read = stage.track().last().is_some_and(|it| it.time >= closed);
                if is_read
                    || !setup.camera.has_stage()
                    || now.seconds_since(closed) > READING_WITHIN_S
                {
                    // Recording takes as long again and is left to the next round.
                    frame.measure(setup, stage);
                }
                Due::Nothing
            }
            Phase::Measured(..) => Due::Record,
        }
    }
}

impl InFlight {
    /// Tells the shutter to open in the last round before it is time, if the stage is at speed;
    /// tells it a little later if the stage is at speed by then; or gives up.
    fn tell(&mut self, now: Time, first_light: Time, setup: &Setup, stage: &StageMachine) -> Due {
        let latency_s = setup.settings.shutter_latency_s;
        let planned = first_light.plus_s(-latency_s);
        if now.plus_s(LEAD_S) < planned {
            return Due::Nothing;
        }
        if now.seconds_since(planned) > setup.settings.shutter_tolerance_s {
            return Due::CallOff(if self.faults.contains(Fault::Overload) {
                Reason::Fault(Fault::Overload)
            } else {
                Reason::NotAtSpeed
            });
        }
        let (exposure_s, travel_mm) = (self.asked.exposure.exposure_s, self.planned_travel_mm);
        if !stage.is_steady(
            setup,
            now,
            exposure_s,
            setup.allowed_change_mm(travel_mm, exposure_s),
        ) {
            return Due::Nothing;
        }
        let at = planned.max(now);
        self.phase = Phase::Tracking {
            first_light: at.plus_s(latency_s),
        };
        Due::Open {
            at,
            exposure_s,
            rows_mm_s: travel_mm / exposure_s,
        }
    }

    /// Takes first light; `None` if it has come before.
    fn open(&mut self, opened: Time, tolerance_s: f32) -> Option<Edge> {
        let expected = match self.phase {
            Phase::Triggered { .. } | Phase::RunUp { .. } => None,
            Phase::Tracking { first_light } => Some(first_light),
            Phase::Exposing { .. } | Phase::Closed(_) | Phase::Measured(..) => return None,
        };
        self.phase = Phase::Exposing {
            opened,
            told_to_close: None,
        };
        let late_s = expected.map(|expected| opened.seconds_since(expected));
        self.late_s = late_s.unwrap_or(0.0);
        let fault = match late_s {
            Some(late_s) if late_s > tolerance_s => Some(Fault::ShutterLate),
            Some(late_s) if late_s >= -tolerance_s => None,
            _ => Some(Fault::ShutterUnexpected),
        };
        Some(Edge {
            is_first_light: true,
            is_unasked: expected.is_none(),
            fault,
            // The command may not have left yet; closing prevents a second opening.
            is_to_close: expected.is_some() && fault == Some(Fault::ShutterUnexpected),
        })
    }

    /// Tells a shutter that is open for too long to close, and gives up if that does not help.
    fn await_end(&mut self, now: Time, opened: Time, told: Option<Time>, tolerance_s: f32) -> Due {
        let planned = opened.plus_s(self.asked.exposure.exposure_s);
        match told {
            None if now.seconds_since(planned) > tolerance_s => {
                self.faults.insert(Fault::ShutterLong);
                self.phase = Phase::Exposing {
                    opened,
                    told_to_close: Some(now),
                };
                Due::Close
            }
            Some(told) if now.seconds_since(told) > SHUTTER_GIVEN_UP_S => {
                self.assume_last_light(opened);
                Due::GivenUp
            }
            _ => Due::Nothing,
        }
    }

    /// Takes last light; `None` if it does not end an exposure.
    fn close(&mut self, closed: Time, tolerance_s: f32) -> Option<Edge> {
        let Phase::Exposing { opened, .. } = self.phase else {
            return None;
        };
        if closed <= opened {
            return None;
        }
        self.phase = Phase::Closed(Light {
            opened,
            closed,
            is_end_assumed: false,
        });
        let longer_s = closed.seconds_since(opened) - self.asked.exposure.exposure_s;
        Some(Edge {
            fault: if longer_s > tolerance_s {
                Some(Fault::ShutterLong)
            } else {
                (longer_s < -tolerance_s).then_some(Fault::ShutterShort)
            },
            ..Edge::default()
        })
    }

    /// Returns the time of light that may have passed before the edge which counts as first light,
    /// s: a sensor that has missed the opening edge and shows a bounce of it makes the exposure
    /// later and shorter by the same, which is σ of the centroid in time and place.
    pub(super) fn unseen_s(&self, light: Light) -> f32 {
        let shorter_s = self.asked.exposure.exposure_s - light.closed.seconds_since(light.opened);
        (self.late_s.min(shorter_s) - STAMPS_S).max(0.0)
    }

    /// Assumes last light at its planned time, since its edge was not seen.
    pub(super) fn assume_last_light(&mut self, opened: Time) {
        self.phase = Phase::Closed(Light {
            opened,
            closed: opened.plus_s(self.asked.exposure.exposure_s),
            is_end_assumed: true,
        });
    }
}
