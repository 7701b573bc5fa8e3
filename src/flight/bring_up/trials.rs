//! Trials of mechanism and shutter, made round by round.

use super::{
    JOG_HOLD_S, JOG_SPEED_MM_S, JOG_WITHIN_UM, MAX_DUTY, MAX_DUTY_WAY_UM, MAX_JOG_ERROR_UM,
    NotTried, SHUTTER_LEAD_S, SILENT_DUTY_S, SILENT_WAY_UM, Trial, TrialEnd, TrialReport,
};
use crate::flight::drive::StageReading;
use crate::flight::drive::flown_drive::FlownDrive;
use crate::flight::drive::loop_settings::LoopSettings;
use crate::flight::drive::settings::DriveSettings;
use crate::flight::event::Action;
use crate::flight::fault::Fault;
use crate::flight::input_levels::InputLevels;
use crate::flight::round_guard::LONGEST_ROUND_US;
use crate::flight::stage::Setpoint;
use crate::flight::time::Time;

/// Trials, one at a time.
#[derive(Debug)]
pub(in crate::flight) struct Trials {
    report: Option<TrialReport>,
    /// Findings of its rounds; `None` before the first.
    run: Option<Run>,
    /// `true` if the shutter has to be closed with the next round.
    closes_shutter: bool,
}

impl Trials {
    /// No trial.
    pub(in crate::flight) const NONE: Self = Self {
        report: None,
        run: None,
        closes_shutter: false,
    };

    /// The last trial; `None` before the first.
    pub(in crate::flight) const fn report(&self) -> Option<TrialReport> {
        self.report
    }

    /// Begins a trial with the next round. The drive gets the default settings, with [`MAX_DUTY`].
    pub(in crate::flight) fn begin(
        &mut self,
        trial: Trial,
        drive: &mut impl FlownDrive,
        offset_mm: Option<f32>,
        levels: &InputLevels,
    ) -> Result<(), NotTried> {
        if self.under_way().is_some() {
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
        let is_set = !trial.has_force() || drive.set_settings(trial_settings()).is_ok();
        self.run = None;
        self.report = Some(TrialReport {
            trial,
            end: (!is_set).then_some(TrialEnd::Drive),
            from_mm: offset_mm,
            to_mm: offset_mm,
            largest_error_um: 0.0,
        });
        Ok(())
    }

    fn under_way(&mut self) -> Option<&mut TrialReport> {
        self.report.as_mut().filter(|report| report.end.is_none())
    }

    /// Ends the trial that is under way; the caller releases the stage. The shutter is closed with
    /// the next round.
    pub(in crate::flight) fn end(&mut self, end: TrialEnd) {
        let has_begun = self.run.is_some();
        if let Some(report) = self.under_way() {
            report.end = Some(end);
            let is_open = has_begun && !report.trial.has_force();
            self.closes_shutter |= is_open;
        }
    }

    /// Returns `true` once if the shutter has to be closed, as a trial was ended between two
    /// rounds.
    pub(in crate::flight) const fn take_close(&mut self) -> bool {
        core::mem::replace(&mut self.closes_shutter, false)
    }

    /// Makes a round of the trial that is under way. Returns the action that is left to the board.
    pub(in crate::flight) fn round(
        &mut self,
        drive: &mut impl FlownDrive,
        now: Time,
        reading: Result<StageReading, Fault>,
        levels: &InputLevels,
    ) -> Option<Action> {
        let offset_mm = reading.ok().map(|reading| reading.offset_mm);
        let offset_mm = offset_mm.filter(|offset_mm| offset_mm.is_finite());
        let before = self.run;
        let report = self.under_way()?;
        report.to_mm = offset_mm;
        let run = if let Some(run) = before {
            let duty = drive.asked_duty().unwrap_or(MAX_DUTY);
            run.next(now, offset_mm, duty)
        } else {
            // The settings of the drive may have changed since the last reading.
            report.from_mm = offset_mm;
            Run::begin(now, offset_mm)
        };
        let action = match report.trial {
            Trial::Shutter { exposure_s } => {
                report.shutter(exposure_s, &run, before.is_none(), levels)
            }
            Trial::Jog { .. } | Trial::Duty { .. } => {
                report.force(drive, now, &run, levels);
                None
            }
        };
        self.run = Some(run);
        action
    }
}

/// The settings of the drive in a trial: the default ones, with a bounded duty.
fn trial_settings() -> DriveSettings {
    let settings = DriveSettings::default();
    DriveSettings {
        velocity_loop: LoopSettings {
            max_duty: MAX_DUTY,
            ..settings.velocity_loop
        },
        ..settings
    }
}

/// Findings of the rounds of a trial.
#[derive(Debug, Clone, Copy)]
struct Run {
    /// Time of the first round.
    since: Time,
    /// Time of the last round.
    last: Time,
    /// `true` if the last round came too late.
    is_late: bool,
    /// Reading from which the encoder has not gone by more than [`SILENT_WAY_UM`], mm.
    stood_mm: f32,
    /// Integral of the duty over the time since it has stood there, s.
    silent_duty_s: f32,
}

impl Run {
    fn begin(now: Time, offset_mm: Option<f32>) -> Self {
        Self {
            since: now,
            last: now,
            is_late: false,
            stood_mm: offset_mm.unwrap_or(0.0),
            silent_duty_s: 0.0,
        }
    }

    /// Returns the run after another round, up to which the drive has had a duty.
    fn next(self, now: Time, offset_mm: Option<f32>, duty: f32) -> Self {
        let mut run = Self {
            last: now,
            is_late: now.us_since(self.last) > u64::from(LONGEST_ROUND_US),
            silent_duty_s: self.silent_duty_s
                + libm::fabsf(duty) * now.seconds_since(self.last).max(0.0),
            ..self
        };
        if let Some(offset_mm) = offset_mm
            && differ_by_um(offset_mm, self.stood_mm) > SILENT_WAY_UM
        {
            (run.stood_mm, run.silent_duty_s) = (offset_mm, 0.0);
        }
        run
    }

    fn elapsed_s(&self) -> f32 {
        self.last.seconds_since(self.since)
    }
}

/// Returns the distance of two offsets, µm.
fn differ_by_um(a_mm: f32, b_mm: f32) -> f32 {
    1e3 * libm::fabsf(a_mm - b_mm)
}

/// Request of a round to the drive.
enum Step {
    Follow(Setpoint),
    Push(f32),
}

impl TrialReport {
    /// Makes a round of a trial of the shutter, which works without rounds from its command on.
    fn shutter(
        &mut self,
        exposure_s: f32,
        run: &Run,
        is_first: bool,
        levels: &InputLevels,
    ) -> Option<Action> {
        if levels.supply_low {
            self.end = Some(TrialEnd::SupplyLow);
            return (!is_first).then_some(Action::CloseShutter);
        }
        if is_first {
            let at = run.since.plus_s(SHUTTER_LEAD_S);
            return Some(Action::OpenShutter { at, exposure_s });
        }
        if run.elapsed_s() >= SHUTTER_LEAD_S + exposure_s {
            self.end = Some(TrialEnd::Done);
        }
        None
    }

    /// Makes a round of a trial with force, or ends it and releases the stage.
    fn force(&mut self, drive: &mut impl FlownDrive, now: Time, run: &Run, levels: &InputLevels) {
        let done = self.step(run, levels).and_then(|step| {
            let done = match step {
                Step::Follow(setpoint) => drive.follow(now, setpoint),
                Step::Push(duty) => drive.push(now, duty),
            };
            done.map_err(|_| TrialEnd::Drive)
        });
        if let Err(end) = done {
            self.end = Some(end);
            drive.release();
        }
    }

    fn step(&mut self, run: &Run, levels: &InputLevels) -> Result<Step, TrialEnd> {
        if levels.supply_low {
            return Err(TrialEnd::SupplyLow);
        }
        if run.is_late {
            return Err(TrialEnd::Pause);
        }
        if levels.limit_low || levels.limit_high {
            return Err(TrialEnd::LimitSwitch);
        }
        let (Some(from_mm), Some(offset_mm)) = (self.from_mm, self.to_mm) else {
            return Err(TrialEnd::Drive);
        };
        let step = match self.trial {
            Trial::Jog { way_um } => {
                let step = self.jog(way_um, [from_mm, offset_mm], run.elapsed_s())?;
                Step::Follow(step)
            }
            Trial::Duty { duty, time_s } => {
                let moved_um = differ_by_um(offset_mm, from_mm);
                if moved_um >= MAX_DUTY_WAY_UM {
                    return Err(TrialEnd::FarEnough);
                }
                if run.elapsed_s() >= time_s {
                    let has_pushed = libm::fabsf(duty) * time_s > 0.0;
                    return Err(if has_pushed && moved_um <= SILENT_WAY_UM {
                        TrialEnd::NotFollowing
                    } else {
                        TrialEnd::Done
                    });
                }
                Step::Push(duty)
            }
            Trial::Shutter { .. } => return Err(TrialEnd::Done),
        };
        if run.silent_duty_s > SILENT_DUTY_S {
            return Err(TrialEnd::NotFollowing);
        }
        Ok(step)
    }

    /// Returns the set point of a jog after a time.
    fn jog(
        &mut self,
        way_um: f32,
        [from_mm, offset_mm]: [f32; 2],
        elapsed_s: f32,
    ) -> Result<Setpoint, TrialEnd> {
        let way_mm = 1e-3 * way_um;
        let moving_s = libm::fabsf(way_mm) / JOG_SPEED_MM_S;
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
        let error_um = differ_by_um(offset_mm, setpoint.offset_mm);
        self.largest_error_um = self.largest_error_um.max(error_um);
        if error_um > MAX_JOG_ERROR_UM {
            return Err(TrialEnd::NotFollowing);
        }
        if elapsed_s < moving_s + JOG_HOLD_S {
            Ok(setpoint)
        } else if error_um <= JOG_WITHIN_UM {
            Err(TrialEnd::Done)
        } else {
            Err(TrialEnd::NotFollowing)
        }
    }
}
