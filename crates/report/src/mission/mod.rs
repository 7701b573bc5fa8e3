//! Report of a mission.

pub mod coverage_plot;
mod flags;
pub mod frames_plot;
pub mod histogram;
pub mod html;
pub mod sigma_figures;
pub mod smear_plot;
mod style;
pub mod summary;
pub mod text;
pub mod timeline;
pub mod truth_csv;

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;

/// Content of a report.
#[derive(Debug, Clone, Copy)]
pub struct MissionReport<'a> {
    /// Scenario that was flown.
    pub scenario: &'a MissionScenario,
    /// Seed of air, noise and jitter.
    pub seed: u64,
    /// Course of the flight.
    pub flown: &'a Flown,
    /// Judgement of the flight.
    pub judgement: &'a Judgement,
}

impl MissionReport<'_> {
    /// Returns the calibration of the first record; a flight has one.
    fn calibration(&self) -> Option<CalibrationId> {
        self.flown.frames.first()?.record.calibration
    }

    /// Returns the records, in order.
    #[must_use]
    pub fn records(&self) -> Vec<FrameRecord> {
        self.flown.frames.iter().map(|frame| frame.record).collect()
    }
}
