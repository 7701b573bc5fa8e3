//! Findings of the camera's start about the flight before it.

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::flight::time::Time;

/// The camera's start, and what it has made of the flight that a reset has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AfterReset {
    /// Number of the start, from 1, counted in the camera's memory and in its records in flash, and
    /// anew if both are lost.
    pub boot: u32,
    /// Number of the last flight that was prepared, counted in the same way; 0 before the first.
    pub flight: u32,
    /// Fate of the flight.
    pub outcome: FlightAfterReset,
    /// Time of the last round before the reset, by the clock of that start; that of the last
    /// trigger, if the records are [from the flash](FlightAfterReset::FromFlash); `None` if there
    /// was none, or it is damaged.
    pub last_round: Option<Time>,
    /// Records of the flight that were not acknowledged, and are there.
    pub records: u32,
    /// Triggers among them whose frame the reset has ended.
    pub unfinished: u32,
    /// Triggers among them whose record was damaged.
    pub damaged: u32,
    /// Time in which triggers have left no record.
    pub without_eyes: WithoutEyes,
}

impl AfterReset {
    /// A start without a flight before it.
    pub const FIRST: Self = Self {
        boot: 1,
        flight: 0,
        outcome: FlightAfterReset::Nothing,
        last_round: None,
        records: 0,
        unfinished: 0,
        damaged: 0,
        without_eyes: WithoutEyes::NoFlight,
    };
}

/// Time without eyes: from the last round before a reset to the first after it. Triggers in it
/// leave no record.
///
/// It is an upper bound, of two parts. The camera's clock does not run over a reset, so the first
/// part is the longest that the board can take
/// ([`Station::bound_reset`](super::station::Station::bound_reset)); the clock measures the second.
/// Edges that a capture input stamps in the second part have records, or are counted as lost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WithoutEyes {
    /// The start has found no flight.
    NoFlight,
    /// There was a flight, and the camera cannot tell for how long it was without eyes: after a
    /// loss of the supply, where memory was of no use, after a start in which no round has come,
    /// while a calibration was being stored, and where the board has no bound.
    Unknown,
    /// No round has come since the start.
    GoesOn {
        /// Longest time from the last round until the clock ran again, ms: until the reset, of a
        /// watchdog its period, and from there until the clock.
        before_clock_ms: u32,
    },
    /// It has ended.
    AtMost {
        /// As in [`Self::GoesOn`], ms.
        before_clock_ms: u32,
        /// Time from the start of the clock until the first round, ms, rounded up.
        start_up_ms: u32,
    },
}

impl WithoutEyes {
    /// The longest it can have lasted, ms; `None` while it goes on, and if nobody knows.
    ///
    /// ```
    /// use fmc_camera::io::link::after_reset::WithoutEyes;
    ///
    /// let after_watchdog = WithoutEyes::AtMost { before_clock_ms: 566, start_up_ms: 21 };
    /// assert_eq!(after_watchdog.at_most_ms(), Some(587));
    /// assert_eq!(WithoutEyes::Unknown.at_most_ms(), None);
    /// ```
    #[must_use]
    pub const fn at_most_ms(&self) -> Option<u32> {
        match *self {
            Self::NoFlight => Some(0),
            Self::Unknown | Self::GoesOn { .. } => None,
            Self::AtMost {
                before_clock_ms,
                start_up_ms,
            } => Some(before_clock_ms.saturating_add(start_up_ms)),
        }
    }

    /// Ends with the first round after the start.
    pub(super) fn end(&mut self, first_round: Time) {
        if let Self::GoesOn { before_clock_ms } = *self {
            let start_up_ms = u32::try_from(first_round.us().div_ceil(1000)).unwrap_or(u32::MAX);
            *self = Self::AtMost {
                before_clock_ms,
                start_up_ms,
            };
        }
    }
}

/// Fate of the flight before a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FlightAfterReset {
    /// There was none, or the camera has been without supply, or it keeps none.
    Nothing,
    /// It goes on: triggers are answered.
    FliesOn,
    /// The camera is prepared as it was; it was not armed, or was to be switched off.
    StandsBy,
    /// As [`Self::StandsBy`], because its settings say so.
    SwitchedOff,
    /// As [`Self::StandsBy`], because it has gone on after [`RESETS_IN_A_ROW`] resets in a row.
    /// After one more the camera is not even prepared, which may be what leads to the reset: it
    /// holds the records.
    ResetAgain,
    /// All that was kept of it is damaged, and nothing of it is used.
    Damaged,
    /// Another build of the firmware has kept it.
    OtherBuild,
    /// Its settings are damaged: the camera is not prepared, and has the records.
    SettingsDamaged,
    /// Its calibration is damaged, or is no more the stored one; as before.
    NoCalibration,
    /// Its calibration was loaded with residual grids, which are not kept; as before.
    NoGrids,
    /// The camera cannot be prepared with these settings any more; as before.
    NotFlyable,
    /// The camera has been without supply, or its memory was of no use: its flash has the records.
    /// Up to two that followed the last one may be missing: that of a frame in flight, and one that
    /// was being written.
    FromFlash,
}

/// Number of resets in a row after which a flight goes on by itself, each within [`STEADY_S`] after
/// the one before. After one more the camera stays disarmed, and after the next unprepared.
pub const RESETS_IN_A_ROW: u8 = 3;

/// Time in flight without a reset after which resets are counted anew, s.
pub const STEADY_S: f32 = 10.0;

impl FlightAfterReset {
    /// The words for it.
    #[must_use]
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Nothing => "no flight",
            Self::FliesOn => "the flight goes on, without force on the stage",
            Self::StandsBy => "the flight is prepared, and not armed",
            Self::SwitchedOff => "the flight does not go on by its settings",
            Self::ResetAgain => "the flight does not go on: resets follow each other",
            Self::Damaged => "what was kept of the flight is damaged",
            Self::OtherBuild => "another build of the firmware has kept the flight",
            Self::SettingsDamaged => "the flight cannot go on: its settings are damaged",
            Self::NoCalibration => "the flight cannot go on: its calibration is gone",
            Self::NoGrids => "the flight cannot go on: its residual grids are gone",
            Self::NotFlyable => "the flight cannot go on: the camera cannot be prepared",
            Self::FromFlash => {
                "the records are from the flash: up to two after them may be missing"
            }
        }
    }
}

impl fmt::Display for FlightAfterReset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.describe())
    }
}
