//! Copies of the flight in memory that a reset leaves alone.

use super::after_reset::STEADY_S;
use super::flight_memory::{FlightMemory, KeptFlight, KeptHead, KeptRecord};
use super::loading::Whole;
use crate::flight::camera::CameraParameters;
use crate::flight::controller::{Controller, FlightState};
use crate::flight::settings::FlightSettings;
use crate::flight::time::Time;

/// Copies of a flight.
#[derive(Debug)]
pub(super) struct FlightKeeper {
    /// `None` in a camera without such memory.
    pub(super) memory: Option<&'static FlightMemory>,
    pub(super) head: KeptHead,
    /// Longest time from the last round before the start until the clock ran, ms, by the board.
    pub(super) reset_ms: Option<u32>,
    /// Time of the last round that is kept.
    last: Option<Time>,
    /// Time of the first round after the start.
    first: Option<Time>,
    /// The camera is to be switched off: the flight does not go on.
    is_ending: bool,
}

impl FlightKeeper {
    /// No memory.
    pub(super) const NONE: Self = Self {
        memory: None,
        head: KeptHead {
            build: 0,
            writing: 0,
            boot: 1,
            flight: 0,
            resumed: 0,
            has_round: false,
            prepared: None,
        },
        reset_ms: None,
        last: None,
        first: None,
        is_ending: false,
    };

    /// Keeps a flight for which the camera has been prepared.
    #[inline(never)]
    pub(super) fn begin(
        &mut self,
        settings: &FlightSettings,
        parameters: Option<&CameraParameters>,
        controller: Option<&Controller>,
    ) {
        self.head.flight = controller.map_or(self.head.flight, Controller::flight);
        self.head.resumed = 0;
        self.head.prepared = None;
        let Some(memory) = self.memory else {
            return;
        };
        // Until the settings are whole there is no flight.
        self.write_head();
        let (Some(parameters), Some(controller)) = (parameters, controller) else {
            return;
        };
        if let (Some(calibration), Some(settings), Some(())) = (
            controller.calibration(),
            memory.write_settings(settings),
            memory.write_parameters(&Whole(parameters), None),
        ) {
            self.head.prepared = Some(KeptFlight {
                calibration,
                earlier: controller.earlier_calibrations(),
                has_grids: !parameters.grids.is_empty(),
                settings,
                state: controller.flight_state(),
            });
            self.write_head();
        }
    }

    /// Goes on with other parameters. They are written beside those before: the step is taken as a
    /// whole with the state, which names them.
    #[inline(never)]
    pub(super) fn exchange(&mut self, parameters: &CameraParameters, controller: &Controller) {
        let (Some(memory), Some(kept)) = (self.memory, &mut self.head.prepared) else {
            return;
        };
        let in_use = Some(kept.calibration.crc);
        let written = memory.write_parameters(&Whole(parameters), in_use);
        if let (Some(calibration), Some(())) = (controller.calibration(), written) {
            kept.calibration = calibration;
            kept.earlier = controller.earlier_calibrations();
            kept.has_grids = !parameters.grids.is_empty();
            self.write_head();
        } else {
            self.end();
        }
    }

    /// Forgets the flight: its camera is to be prepared anew.
    pub(super) fn end(&mut self) {
        if self.head.prepared.take().is_some() {
            self.write_head();
        }
    }

    /// Notes that no round comes for seconds, though the watchdog is fed.
    #[cfg(feature = "store")]
    pub(super) fn pause(&mut self) {
        if self.head.has_round {
            self.head.has_round = false;
            self.write_head();
        }
    }

    /// Notes that the camera is to be switched off.
    pub(super) const fn note_power_off(&mut self) {
        self.is_ending = true;
    }

    /// Copies what has changed. Returns the time of the first round after the start, once.
    #[inline]
    pub(super) fn keep(&mut self, controller: Option<&mut Controller>) -> Option<Time> {
        let memory = self.memory?;
        let kept = self.head.prepared.as_ref()?;
        let controller = controller?;
        let mut state = controller.flight_state();
        state.is_flying &= !self.is_ending;
        let are_told = |state: &FlightState| (state.records.left(), state.in_doubt);
        if are_told(&state) != are_told(&kept.state) {
            // Before records that are written into the slots of acknowledged ones.
            self.note_state(state);
        }
        while let Some(unkept) = controller.next_unkept() {
            self.head.writing = self.head.writing.wrapping_add(1);
            let record = KeptRecord {
                flight: self.head.flight,
                writing: self.head.writing,
                is_pending: unkept.is_pending,
                boot: unkept.boot,
                record: unkept.record,
            };
            memory.write_record(&record, unkept.slot, unkept.outdated);
            controller.note_kept(unkept.record.sequence, unkept.slot);
        }
        let kept = self.head.prepared.as_ref();
        if kept.is_none_or(|kept| state != kept.state) {
            self.note_state(state);
        }
        let now = controller.last_event();
        if now != self.last
            && let Some(now) = now
        {
            self.last = Some(now);
            memory.write_time(now);
            if !self.head.has_round {
                self.head.has_round = true;
                self.write_head();
            }
            let Some(first) = self.first else {
                self.first = Some(now);
                return Some(now);
            };
            if self.head.resumed > 0 && now.seconds_since(first) > STEADY_S {
                self.head.resumed = 0;
                self.write_head();
            }
        }
        None
    }

    /// Notes another state of the flight.
    fn note_state(&mut self, state: FlightState) {
        let Some(kept) = &mut self.head.prepared else {
            return;
        };
        if state.is_flying && !kept.state.is_flying {
            // Somebody has armed the camera.
            self.head.resumed = 0;
        }
        kept.state = state;
        self.write_head();
    }

    /// Writes the state anew.
    pub(super) fn write_head(&mut self) {
        if let Some(memory) = self.memory {
            self.head.writing = self.head.writing.wrapping_add(1);
            memory.write_head(&self.head);
        }
    }
}
