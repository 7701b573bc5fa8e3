//! The report of a mission.

pub mod frames_plot;
pub mod histogram;
pub mod html;
mod style;
pub mod summary;
pub mod text;
pub mod timeline;
pub mod truth_csv;

use fmc_camera::flight::frame_record::FrameRecord;
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;

/// Everything a report is made of.
#[derive(Debug, Clone, Copy)]
pub struct MissionReport<'a> {
    /// What was flown.
    pub scenario: &'a MissionScenario,
    /// Seed of air, noise and jitter.
    pub seed: u64,
    /// What happened.
    pub flown: &'a Flown,
    /// What is found of it.
    pub judgement: &'a Judgement,
}

impl MissionReport<'_> {
    /// The records, in order.
    #[must_use]
    pub fn records(&self) -> Vec<FrameRecord> {
        self.flown.frames.iter().map(|frame| frame.record).collect()
    }
}
