//! Completed flight: records, true exposures and what the camera reported in between.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::io::instruments::counters::InstrumentCounters;

use super::camera_clock::CameraClock;
use super::oracle::FrameTruth;
use super::receiver::SentenceCounts;
use super::trace::Trace;

/// The record of a trigger with the true exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct FlownFrame {
    /// Record of the camera.
    pub record: FrameRecord,
    /// True exposure; `None` if no light passed.
    pub truth: Option<FrameTruth>,
    /// Time at which the computer got the record, µs.
    pub fetched_us: u64,
    /// Faults that it named then: those of a record that is in doubt later are not among them.
    pub fetched_faults: Faults,
}

/// A completed flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Flown {
    /// Description of the camera.
    pub device: String,
    /// The camera's clock.
    pub clock: CameraClock,
    /// Times of the triggers on the camera's clock, µs, in order.
    pub triggers_us: Vec<u64>,
    /// All records, in the order of the triggers.
    pub frames: Vec<FlownFrame>,
    /// Exposures without a record.
    pub unrecorded: Vec<FrameTruth>,
    /// Exposures in doubt, which the records hold as such.
    pub in_doubt: Option<InDoubt>,
    /// Faults with the times at which the camera named them, µs.
    pub announced: Vec<(u64, Fault)>,
    /// Changes of the camera's state, µs.
    pub states: Vec<(u64, State)>,
    /// Time at which each injected fault could first be felt, µs.
    pub felt_us: Vec<Option<u64>>,
    /// Number of requests that the cut line lost.
    pub lost_requests: u32,
    /// Counts of the receiver's sentences, if it sends any.
    pub sentences: SentenceCounts,
    /// Counts of the camera's wires of receiver and autopilot, if there are any.
    pub instruments: Option<InstrumentCounters>,
    /// Greatest true distance of the stage from the calibrated position, mm.
    pub farthest_mm: f64,
    /// Rounds around one frame.
    pub trace: Option<Trace>,
    /// Simulated time, s.
    pub duration_s: f64,
}

impl Flown {
    /// Creates the state before the first round.
    pub(super) fn before(clock: CameraClock, triggers_us: Vec<u64>, faults: usize) -> Self {
        Self {
            device: String::new(),
            clock,
            triggers_us,
            frames: Vec::new(),
            unrecorded: Vec::new(),
            in_doubt: None,
            announced: Vec::new(),
            states: Vec::new(),
            felt_us: vec![None; faults],
            lost_requests: 0,
            sentences: SentenceCounts::default(),
            instruments: None,
            farthest_mm: 0.0,
            trace: None,
            duration_s: 0.0,
        }
    }

    /// Marks the exposures whose records have been fetched and are in doubt, as the camera does
    /// with those that it still has.
    pub(super) fn doubt(&mut self, exposures: InDoubt) {
        for frame in &mut self.frames {
            frame.record.doubt(&exposures);
        }
        self.in_doubt = Some(match self.in_doubt {
            Some(before) => before.with(exposures),
            None => exposures,
        });
    }

    /// Returns the state of the camera at a time, µs.
    #[must_use]
    pub fn state_at(&self, time_us: u64) -> Option<State> {
        let later = self.states.partition_point(|(since, _)| *since <= time_us);
        let (_, state) = self.states.get(later.checked_sub(1)?)?;
        Some(*state)
    }
}
