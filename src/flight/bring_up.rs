//! Aids for the bring-up of a board, before a camera is loaded: levels of its lines, counts of
//! their edges, and trials of mechanism and shutter that are bounded in size and time.
//!
//! A trial is of a camera that is not prepared for flight, and of one at a time. It ends by itself:
//! no force lasts longer than [`MAX_TRIAL_S`] after the message that has asked for it, also if the
//! cable is cut. Rounds that fail to come end it as they end a flight
//! ([`RoundGuard`](super::round_guard::RoundGuard)).

use core::fmt;

use super::drive::StageReading;
use super::drive::flown_drive::FlownDrive;
use super::event::{Action, Event, ShutterEdge};
use super::fault::Fault;
use super::input_levels::InputLevels;
use super::round_guard::LONGEST_ROUND_US;
use super::stage::Setpoint;
use super::time::Time;

/// Longest way of a jog, µm.
pub const MAX_JOG_UM: f32 = 200.0;

/// Speed of a jog, mm/s.
pub const JOG_SPEED_MM_S: f32 = 1.0;

/// Time for which the stage is held at the end of a jog, s.
pub const JOG_HOLD_S: f32 = 0.1;

/// Following error that ends a jog, µm: motor or encoder is reversed, or the stage does not move.
pub const MAX_JOG_ERROR_UM: f32 = 100.0;

/// Largest duty of a trial, of 1.
pub const MAX_DUTY: f32 = 0.2;

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
    /// Moves the stage by the control loop with its default gains, then releases it.
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
    /// Opens the shutter for a time; the edges of its sensor are counted.
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
    /// The stage was farther from its set point than [`MAX_JOG_ERROR_UM`].
    NotFollowing,
    /// The stage has moved by [`MAX_DUTY_WAY_UM`].
    FarEnough,
    /// The drive has failed, or its encoder.
    Drive,
    /// A camera was loaded or prepared.
    Loaded,
    /// Rounds have failed to come for [`LONGEST_ROUND_US`].
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

/// Trials, one at a time.
#[derive(Debug)]
pub(super) struct Trials {
    report: Option<TrialReport>,
    /// Time since which the trial runs, from its first round on, and time of its last round.
    since: Option<[Time; 2]>,
}

impl Trials {
    /// No trial.
    pub(super) const NONE: Self = Self {
        report: None,
        since: None,
    };

    /// The last trial; `None` before the first.
    pub(super) const fn report(&self) -> Option<TrialReport> {
        self.report
    }

    /// Begins a trial with the next round.
    pub(super) fn begin(
        &mut self,
        trial: Trial,
        offset_mm: Option<f32>,
        levels: &InputLevels,
    ) -> Result<(), NotTried> {
        if self.is_under_way() {
            return Err(NotTried::UnderWay);
        }
        trial.check()?;
        if levels.supply_low {
            return Err(NotTried::SupplyLow);
        }
        if trial.has_force() {
            if levels.limit_low || levels.limit_high {
                return Err(NotTried::LimitSwitch);
            }
            if offset_mm.is_none() {
                return Err(NotTried::NoReading);
            }
        }
        self.since = None;
        self.report = Some(TrialReport {
            trial,
            end: None,
            from_mm: offset_mm,
            to_mm: offset_mm,
            largest_error_um: 0.0,
        });
        Ok(())
    }

    fn is_under_way(&self) -> bool {
        self.report.is_some_and(|report| report.end.is_none())
    }

    /// Ends the trial that is under way; the caller releases the stage.
    pub(super) fn end(&mut self, end: TrialEnd) {
        if let Some(report) = &mut self.report {
            report.end.get_or_insert(end);
        }
    }

    /// Makes a round of the trial that is under way. Returns the action that is left to the board.
    pub(super) fn round(
        &mut self,
        drive: &mut impl FlownDrive,
        now: Time,
        reading: Result<StageReading, Fault>,
        levels: &InputLevels,
    ) -> Option<Action> {
        let report = self.report.as_mut().filter(|it| it.end.is_none())?;
        let offset_mm = reading.ok().map(|reading| reading.offset_mm);
        report.to_mm = offset_mm;
        let [since, last] = self.since.unwrap_or([now; 2]);
        self.since = Some([since, now]);
        let elapsed_s = now.seconds_since(since);
        let step = match (report.trial, report.from_mm, offset_mm) {
            _ if levels.supply_low => Err(TrialEnd::SupplyLow),
            _ if now.us_since(last) > u64::from(LONGEST_ROUND_US) => Err(TrialEnd::Pause),
            (Trial::Shutter { exposure_s }, ..) => {
                report.end = Some(TrialEnd::Done);
                let at = now.plus_s(SHUTTER_LEAD_S);
                return Some(Action::OpenShutter { at, exposure_s });
            }
            _ if levels.limit_low || levels.limit_high => Err(TrialEnd::LimitSwitch),
            (Trial::Jog { way_um }, Some(from_mm), Some(offset_mm)) => {
                report.jog(way_um, from_mm, offset_mm, elapsed_s)
            }
            (Trial::Duty { duty, time_s }, Some(from_mm), Some(offset_mm)) => {
                if elapsed_s >= time_s {
                    Err(TrialEnd::Done)
                } else if libm::fabsf(offset_mm - from_mm) >= 1e-3 * MAX_DUTY_WAY_UM {
                    Err(TrialEnd::FarEnough)
                } else {
                    Ok(Step::Push(duty))
                }
            }
            _ => Err(TrialEnd::Drive),
        };
        let done = match step {
            Ok(Step::Follow(setpoint)) => drive.follow(now, setpoint),
            Ok(Step::Push(duty)) => drive.push(now, duty),
            Err(end) => {
                report.end = Some(end);
                drive.release();
                return None;
            }
        };
        if done.is_err() {
            report.end = Some(TrialEnd::Drive);
            drive.release();
        }
        None
    }
}

/// Request of a round to the drive.
enum Step {
    Follow(Setpoint),
    Push(f32),
}

impl TrialReport {
    /// Returns the set point of a jog after a time.
    fn jog(
        &mut self,
        way_um: f32,
        from_mm: f32,
        offset_mm: f32,
        elapsed_s: f32,
    ) -> Result<Step, TrialEnd> {
        let way_mm = 1e-3 * way_um;
        let moving_s = libm::fabsf(way_mm) / JOG_SPEED_MM_S;
        if elapsed_s >= moving_s + JOG_HOLD_S {
            return Err(TrialEnd::Done);
        }
        let setpoint = if elapsed_s < moving_s {
            let speed_mm_s = libm::copysignf(JOG_SPEED_MM_S, way_mm);
            Setpoint {
                offset_mm: from_mm + speed_mm_s * elapsed_s,
                speed_mm_s,
                acceleration_mm_s2: 0.0,
            }
        } else {
            Setpoint {
                offset_mm: from_mm + way_mm,
                speed_mm_s: 0.0,
                acceleration_mm_s2: 0.0,
            }
        };
        let error_um = 1e3 * libm::fabsf(offset_mm - setpoint.offset_mm);
        self.largest_error_um = self.largest_error_um.max(error_um);
        if error_um > MAX_JOG_ERROR_UM {
            return Err(TrialEnd::NotFollowing);
        }
        Ok(Step::Follow(setpoint))
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
            Self::Prepared => f.write_str("it is prepared for flight: start it again first"),
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
