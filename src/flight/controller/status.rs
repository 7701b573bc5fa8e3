//! The camera's status.

use super::Controller;
use super::readiness::Mode;
use crate::flight::calibration_id::CalibrationId;
use crate::flight::camera;
use crate::flight::findings::{Findings, LastFinding};
use crate::flight::frame_record::FrameRecord;
use crate::flight::in_doubt::InDoubt;
use crate::flight::stage::Setpoint;
use crate::flight::time::Time;
use crate::flight::vh::VhMonitor;

/// Counts of events since the controller was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counts {
    /// Triggers.
    pub triggers: u32,
    /// Records with an exposure.
    pub exposed: u32,
    /// Records without an exposure.
    pub refused: u32,
    /// Wrong encoder readings that were left out.
    pub glitches: u32,
    /// Rounds of the control loop that came late.
    pub late_ticks: u32,
    /// Edges of the shutter that the camera had not commanded.
    pub unexpected_edges: u32,
    /// Events that could not be kept until the control loop came round.
    pub lost_events: u32,
}

impl Controller {
    /// The sources of V/H.
    #[must_use]
    pub const fn vh(&self) -> &VhMonitor {
        &self.aircraft.vh
    }

    /// Counts of the findings of the aircraft's instruments.
    #[must_use]
    pub const fn findings(&self) -> &Findings {
        self.aircraft.findings()
    }

    /// The last finding of the aircraft's instruments; `None` if there was none.
    #[must_use]
    pub fn last_finding(&self) -> Option<LastFinding> {
        let (time, flag) = self.aircraft.last_finding()?;
        let now = self.readiness.last_event().unwrap_or(time);
        Some(LastFinding {
            flag,
            age_s: now.seconds_since(time).max(0.0),
        })
    }

    /// Drift of the camera's time by the time pulses, ppm, positive if it runs fast; `None` before
    /// it is measured.
    #[must_use]
    pub const fn time_drift_ppm(&self) -> Option<f32> {
        self.aircraft.utc.drift_ppm()
    }

    /// Returns the counts so far.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        let [triggers, exposed, refused, unexpected_edges] = self.frame.kept.counts();
        Counts {
            triggers,
            exposed,
            refused,
            glitches: self.stage.glitches(),
            late_ticks: self.readiness.late_ticks(),
            unexpected_edges,
            lost_events: self.readiness.lost_events(),
        }
    }

    /// Returns `true` if the encoder has lost its place.
    #[must_use]
    pub const fn is_place_lost(&self) -> bool {
        self.stage.is_place_lost()
    }

    /// Place of the index mark by the last crossing along the FMC axis, mm from the calibrated
    /// position; `None` before the first, or without a mark.
    #[must_use]
    pub const fn index_mm(&self) -> Option<f32> {
        self.stage.index.last_mm()
    }

    /// Exposures whose principal points are in doubt, since the encoder was found wrong at the
    /// index mark; `None` if it was not.
    #[must_use]
    pub const fn in_doubt(&self) -> Option<InDoubt> {
        self.stage.index.in_doubt()
    }

    /// Root mean square of the stage's following error over about a second, µm, within 6 %.
    #[must_use]
    pub fn following_rms_um(&self) -> f32 {
        self.stage.following_error().rms_um()
    }

    /// Returns `true` if the camera is armed, with compensation or without, or a frame is in
    /// flight: calibration and settings must stay.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.frame.is_in_flight()
            || !matches!(self.readiness.mode(), Mode::Standby | Mode::Fault(_))
    }

    /// Returns `true` unless the supply is too low to move the stage.
    #[must_use]
    pub const fn is_supply_good(&self) -> bool {
        self.readiness.is_supply_good()
    }

    /// Number and frame of the last recorded exposure, for the correction of its points.
    #[must_use]
    pub const fn latest(&self) -> Option<&(u32, camera::Frame)> {
        self.frame.kept.latest()
    }

    /// The oldest record with this number or a higher one.
    #[must_use]
    pub fn record(&self, from_sequence: u32) -> Option<FrameRecord> {
        let (entry, boot) = self.frame.kept.records().from(from_sequence)?;
        let calibration = self.calibrations.of(entry.sequence);
        Some(entry.record(calibration, boot, self.flight))
    }

    /// The calibration in use; `None` if it has no identity.
    #[must_use]
    pub const fn calibration(&self) -> Option<CalibrationId> {
        self.calibrations.present()
    }

    /// Number of the flight, from 1; each preparation of a camera begins another.
    #[must_use]
    pub const fn flight(&self) -> u32 {
        self.flight
    }

    /// Records that have not been acknowledged.
    #[must_use]
    pub fn kept(&self) -> u32 {
        self.frame.kept.records().kept()
    }

    /// Forgets the records up to this number, which the PC has. Returns the number of those left.
    pub fn acknowledge(&mut self, through: u32) -> u32 {
        self.frame.kept.records_mut().acknowledge(through)
    }

    /// Returns the set point of a time; `None` if the stage is released.
    #[must_use]
    pub fn setpoint(&self, now: Time) -> Option<Setpoint> {
        self.stage.setpoint(now)
    }
}
