//! Aids for the bring-up of a board, before a camera is loaded: levels of its lines, counts of
//! their edges, and trials of mechanism and shutter that are bounded in size and time.
//!
//! A trial is of a camera that is not prepared for flight, and of one at a time. It begins with the
//! round after the message that has asked for it, and ends by itself, also if the cable is cut: no
//! force lasts longer than [`MAX_TRIAL_S`] and a round, which is
//! [`LONGEST_ROUND_US`](super::round_guard::LONGEST_ROUND_US) at most. Rounds that fail to come end
//! jog and duty as they end a flight ([`RoundGuard`](super::round_guard::RoundGuard)).
//!
//! Jog and duty have the default [`DriveSettings`](super::drive::settings::DriveSettings), with
//! [`MAX_DUTY`], whatever an earlier flight has set: a step of 0.1 µm, and neither motor nor
//! encoder reversed. The drive keeps them until a camera is prepared. The settings of the board's
//! lines ([`InputSettings`](super::input_settings::InputSettings)) are those of the last flight
//! that was prepared since its start. Before the first the brake is not used, and a switch whose
//! line is high counts as closed, so that jog and duty are refused where switches close to ground.
//!
//! # Accuracy
//! In the model of [`Plant::REFERENCE`](super::drive::loop_settings::Plant::REFERENCE), by
//! `tests/link/trial_faults.rs`: a stage whose encoder is silent, falls silent or counts backwards
//! is stopped within 0.5 mm and below 25 mm/s in a jog; under [`MAX_DUTY`] with an encoder that is
//! or falls silent, within 0.62 mm and below 31 mm/s. The way after its release is in it; friction
//! makes it shorter. Jogs of 20 µm and more follow within half of [`MAX_JOG_ERROR_UM`] with mass
//! and force 30 % off, and twice the friction; friction may end a shorter one as not following.

pub(super) mod trials;

use core::fmt;

use super::event::{Event, ShutterEdge};

/// Longest way of a jog, µm.
pub const MAX_JOG_UM: f32 = 200.0;

/// Speed of a jog, mm/s.
pub const JOG_SPEED_MM_S: f32 = 1.0;

/// Time for which the stage is held at the end of a jog, s.
pub const JOG_HOLD_S: f32 = 0.1;

/// Following error that ends a jog, µm: motor or encoder is reversed, or the stage does not move.
pub const MAX_JOG_ERROR_UM: f32 = 20.0;

/// Following error within which a jog has to end, µm: the integral of the loop need not have come
/// to rest.
pub const JOG_WITHIN_UM: f32 = 10.0;

/// Largest duty of a trial, of 1.
pub const MAX_DUTY: f32 = 0.2;

/// Way within which an encoder counts as silent, µm: five counts of the default step.
pub const SILENT_WAY_UM: f32 = 0.5;

/// Integral of the duty over the time for which an encoder may be silent, s: 7.5 ms of
/// [`MAX_DUTY`].
pub const SILENT_DUTY_S: f32 = 1.5e-3;

/// Longest time of a duty, s.
pub const MAX_DUTY_S: f32 = 0.2;

/// Way that ends a duty, µm.
pub const MAX_DUTY_WAY_UM: f32 = 500.0;

/// Exposures of a test of the shutter, s.
pub const TEST_EXPOSURE_S: [f32; 2] = [1e-4, 0.1];

/// Time from the message to the shutter's command, s.
pub const SHUTTER_LEAD_S: f32 = 0.02;

/// Longest time of a trial, s: that of the longest jog.
pub const MAX_TRIAL_S: f32 = 1e-3 * MAX_JOG_UM / JOG_SPEED_MM_S + JOG_HOLD_S;

/// A trial of mechanism or shutter.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Trial {
    /// Moves the stage by the control loop with its default gains and [`MAX_DUTY`], then releases
    /// it.
    Jog {
        /// Way along the FMC axis, µm, up to [`MAX_JOG_UM`] either way.
        way_um: f32,
    },
    /// Drives the motor with a duty, then releases it.
    Duty {
        /// Pulse width, up to [`MAX_DUTY`] either way; positive is along the FMC axis.
        duty: f32,
        /// Time, s, up to [`MAX_DUTY_S`].
        time_s: f32,
    },
    /// Opens the shutter for a time; the edges of its sensor are counted. It is under way until the
    /// command to close, and a low supply or a camera that is loaded or prepared closes the shutter
    /// earlier.
    Shutter {
        /// Time from the command to open to the command to close, s, within [`TEST_EXPOSURE_S`].
        exposure_s: f32,
    },
}

/// The reason why a trial has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TrialEnd {
    /// It is complete.
    Done,
    /// A limit switch has closed.
    LimitSwitch,
    /// The supply is low.
    SupplyLow,
    /// The stage was farther from its set point than [`MAX_JOG_ERROR_UM`], or at the end than
    /// [`JOG_WITHIN_UM`]; or its encoder was silent under a duty for [`SILENT_DUTY_S`], or during
    /// all of a duty.
    NotFollowing,
    /// The stage has moved by [`MAX_DUTY_WAY_UM`].
    FarEnough,
    /// The drive has failed, or its encoder.
    Drive,
    /// A camera was loaded or prepared.
    Loaded,
    /// Rounds have failed to come for
    /// [`LONGEST_ROUND_US`](super::round_guard::LONGEST_ROUND_US).
    Pause,
}

/// A trial, and what has come of it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrialReport {
    /// The trial.
    pub trial: Trial,
    /// The reason why it has ended; `None` while it is under way.
    pub end: Option<TrialEnd>,
    /// Position of the stage at its beginning, mm from the encoder's zero; `None` without a
    /// reading.
    pub from_mm: Option<f32>,
    /// Position at its end, or now, mm.
    pub to_mm: Option<f32>,
    /// Largest following error of a jog, µm.
    pub largest_error_um: f32,
}

/// The reason why a trial is refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NotTried {
    /// The camera is prepared for flight.
    Prepared,
    /// Another trial is under way.
    UnderWay,
    /// A limit switch is closed, or its wire is broken.
    LimitSwitch,
    /// The supply is low.
    SupplyLow,
    /// The encoder gives no reading.
    NoReading,
    /// A number of the trial is outside its bounds.
    OutOfBounds {
        /// The number, in the unit of the trial.
        value: f32,
        /// Smallest allowed value.
        min: f32,
        /// Largest allowed value.
        max: f32,
    },
}

/// Levels of the board's lines, `true` for high.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[allow(clippy::struct_excessive_bools, reason = "each is a line")]
pub struct LineLevels {
    /// Trigger.
    pub trigger: bool,
    /// Time pulse of the satellite receiver.
    pub time_pulse: bool,
    /// The shutter's sensor: opened.
    pub shutter_opened: bool,
    /// The shutter's sensor: closed.
    pub shutter_closed: bool,
    /// Index mark of the encoder.
    pub index: bool,
    /// Track A of the encoder.
    pub encoder_a: bool,
    /// Track B of the encoder.
    pub encoder_b: bool,
    /// Limit switch at the negative end.
    pub limit_low: bool,
    /// Limit switch at the positive end.
    pub limit_high: bool,
    /// Brake input.
    pub brake: bool,
}

/// Counts of edges since the start, each up to the largest number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EdgeCounts {
    /// Edges of the trigger that are stamped.
    pub trigger: u32,
    /// Edges of the time pulse that are stamped.
    pub time_pulse: u32,
    /// Edges of the shutter's sensor: opened.
    pub shutter_opened: u32,
    /// Edges of the shutter's sensor: closed.
    pub shutter_closed: u32,
    /// Crossings of the index mark while no camera is prepared.
    pub index: u32,
    /// Edges that were lost before they could be counted, of all lines.
    pub lost: u32,
}

impl EdgeCounts {
    /// Counts an edge of a line.
    pub(super) const fn count(&mut self, event: Event) {
        let count = match event {
            Event::Trigger => &mut self.trigger,
            Event::TimePulse => &mut self.time_pulse,
            Event::Shutter(ShutterEdge::Opened) => &mut self.shutter_opened,
            Event::Shutter(ShutterEdge::Closed) => &mut self.shutter_closed,
            _ => return,
        };
        *count = count.saturating_add(1);
    }
}

impl Trial {
    /// Returns `true` if it puts force on the stage.
    const fn has_force(self) -> bool {
        matches!(self, Self::Jog { .. } | Self::Duty { .. })
    }

    /// Checks the numbers against their bounds; a NaN is in none.
    fn check(self) -> Result<(), NotTried> {
        let within = |value: f32, [min, max]: [f32; 2]| {
            if value >= min && value <= max {
                Ok(())
            } else {
                Err(NotTried::OutOfBounds { value, min, max })
            }
        };
        match self {
            Self::Jog { way_um } => within(way_um, [-MAX_JOG_UM, MAX_JOG_UM]),
            Self::Duty { duty, time_s } => {
                within(duty, [-MAX_DUTY, MAX_DUTY])?;
                within(time_s, [0.0, MAX_DUTY_S])
            }
            Self::Shutter { exposure_s } => within(exposure_s, TEST_EXPOSURE_S),
        }
    }
}

impl fmt::Display for TrialEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Done => "complete",
            Self::LimitSwitch => "ended: a limit switch has closed",
            Self::SupplyLow => "ended: the supply is low",
            Self::NotFollowing => "ended: the stage does not follow",
            Self::FarEnough => "ended: the stage has moved far enough",
            Self::Drive => "ended: the drive has failed",
            Self::Loaded => "ended: a camera was loaded or prepared",
            Self::Pause => "ended: rounds of the control loop failed to come",
        })
    }
}

impl fmt::Display for NotTried {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Prepared => f.write_str(
                "it is prepared for flight: switch it off and on, or load a calibration that ends the flight",
            ),
            Self::UnderWay => f.write_str("another trial is under way"),
            Self::LimitSwitch => f.write_str("a limit switch is closed, or its wire is broken"),
            Self::SupplyLow => f.write_str("its supply is low"),
            Self::NoReading => f.write_str("its encoder gives no reading"),
            Self::OutOfBounds { value, min, max } => {
                write!(f, "{value} is outside {min} to {max}")
            }
        }
    }
}

impl core::error::Error for NotTried {}
