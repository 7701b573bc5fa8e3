//! A flight that is over: records, what really happened, and what the camera said meanwhile.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::FrameRecord;

use super::oracle::FrameTruth;
use super::receiver::SentenceCounts;
use super::trace::Trace;

/// One trigger's record, and what really happened.
#[derive(Debug, Clone, PartialEq)]
pub struct FlownFrame {
    /// As the camera has it.
    pub record: FrameRecord,
    /// As it was; `None` where no light passed.
    pub truth: Option<FrameTruth>,
    /// When the computer got the record, µs.
    pub fetched_us: u64,
}

/// A flight that is over.
#[derive(Debug, Clone, PartialEq)]
pub struct Flown {
    /// What the camera is, in words.
    pub device: String,
    /// Triggers that were given, µs, in order.
    pub triggers_us: Vec<u64>,
    /// Every record, in order of the triggers.
    pub frames: Vec<FlownFrame>,
    /// Light of which no record knows.
    pub unrecorded: Vec<FrameTruth>,
    /// Faults as the camera named them, µs.
    pub announced: Vec<(u64, Fault)>,
    /// Changes of the camera's state, µs.
    pub states: Vec<(u64, State)>,
    /// When each injected fault could first be felt, µs.
    pub felt_us: Vec<Option<u64>>,
    /// Requests that the cut line lost.
    pub lost_requests: u32,
    /// The receiver's sentences, where it sends any.
    pub sentences: SentenceCounts,
    /// How far the stage truly was from the calibrated position at most, mm.
    pub farthest_mm: f64,
    /// The rounds of one frame.
    pub trace: Option<Trace>,
    /// Simulated time, s.
    pub duration_s: f64,
}

impl Flown {
    /// A flight that has not begun.
    pub(super) fn before(triggers_us: Vec<u64>, faults: usize) -> Self {
        Self {
            device: String::new(),
            triggers_us,
            frames: Vec::new(),
            unrecorded: Vec::new(),
            announced: Vec::new(),
            states: Vec::new(),
            felt_us: vec![None; faults],
            lost_requests: 0,
            sentences: SentenceCounts::default(),
            farthest_mm: 0.0,
            trace: None,
            duration_s: 0.0,
        }
    }

    /// What the camera was doing at a time, µs.
    #[must_use]
    pub fn state_at(&self, time_us: u64) -> Option<State> {
        let later = self.states.partition_point(|(since, _)| *since <= time_us);
        let (_, state) = self.states.get(later.checked_sub(1)?)?;
        Some(*state)
    }
}
