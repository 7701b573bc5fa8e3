//! Outcome of a fault, compared with the expected one.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Outcome};
use fmc_camera::flight::vh::VhSource;

use super::check::{Check, refused};
use super::clock::microseconds;
use super::clock::seconds;
use super::expectation::way_name;
use super::fault::InjectedFault;
use super::fault::line::Traffic;
use super::flown::{Flown, FlownFrame};
use super::frame_errors::FrameErrors;
use super::planned_fault::PlannedFault;
use super::scenario::MissionScenario;
use crate::wording;

/// Time before the onset of a fault within which a frame that it affects may have been triggered,
/// µs.
const FRAME_BEFORE_US: u64 = 1_000_000;

/// Judges the outcome of a fault.
pub(super) fn outcome(
    scenario: &MissionScenario,
    flown: &Flown,
    errors: &[Option<FrameErrors>],
    planned: &PlannedFault,
    felt_us: Option<u64>,
) -> Vec<Check> {
    let injection = &planned.injection;
    let onset_us = microseconds(injection.onset_s);
    let aftermath = Aftermath {
        flown,
        errors,
        name: injection.fault.name(),
        onset_us,
        end_us: microseconds(injection.end_s()),
        felt_us: felt_us.unwrap_or(onset_us),
    };
    let expected = &planned.expectation;
    let mut checks: Vec<Check> = [
        expected
            .fault
            .map(|fault| aftermath.fault(fault, expected.within_ms)),
        expected
            .state
            .as_deref()
            .map(|state| aftermath.state(state)),
        expected
            .refused
            .as_deref()
            .map(|reason| aftermath.refused_for(reason)),
        expected.flag.map(|flag| aftermath.flag(flag)),
        expected
            .refused_at_most
            .map(|most| aftermath.refused_at_most(most)),
        expected.vh_from.map(|way| aftermath.vh_from(way)),
        expected.smear_px.map(|most| aftermath.smear(most)),
        expected
            .armed_within_s
            .map(|within_s| aftermath.armed(within_s)),
    ]
    .into_iter()
    .flatten()
    .collect();
    if injection.fault == InjectedFault::UartCut {
        let carried = scenario.carried();
        // A cut between two triggers keeps no record back, and one over less than three holds no
        // two values of V/H.
        let triggers = aftermath.triggers();
        if carried.has(Traffic::Records) && triggers > 0 {
            checks.push(aftermath.records_kept());
        }
        if carried.has_vh() && triggers > 2 {
            checks.push(aftermath.uncertainty_grows());
        }
    }
    checks
}

/// The flight after the onset of a fault.
struct Aftermath<'a> {
    flown: &'a Flown,
    errors: &'a [Option<FrameErrors>],
    name: &'static str,
    onset_us: u64,
    /// Largest value of the type if the fault does not end.
    end_us: u64,
    felt_us: u64,
}

impl<'a> Aftermath<'a> {
    fn check(&self, what: &str, found: String, passed: bool) -> Check {
        Check {
            what: format!("{}: {what}", self.name),
            found,
            passed,
            is_vacuous: false,
        }
    }

    /// Creates a check of so many frames; over none it has failed.
    fn check_of(&self, frames: usize, what: &str, found: String, passed: bool) -> Check {
        let what = format!("{}: {what}", self.name);
        Check::over((frames, "frame"), what, found, passed)
    }

    /// Returns the frames that the fault can have affected: those that ended after its onset.
    fn later(&self) -> impl Iterator<Item = &'a FlownFrame> + use<'a> {
        let onset_us = self.onset_us;
        self.flown.frames.iter().filter(move |frame| {
            let is_near = frame.record.trigger.us() + FRAME_BEFORE_US >= onset_us;
            let ended_us = match &frame.record.outcome {
                Outcome::Exposed(exposed) => exposed.closed.us(),
                Outcome::Refused(_) => frame.fetched_us,
            };
            is_near && ended_us >= onset_us
        })
    }

    /// Returns the number of triggers during the fault.
    fn triggers(&self) -> usize {
        let span_us = self.onset_us..self.end_us;
        let triggers = self.flown.triggers_us.iter();
        triggers.filter(|time_us| span_us.contains(time_us)).count()
    }

    /// Returns the frames triggered during the fault.
    fn meanwhile(&self) -> impl Iterator<Item = &'a FlownFrame> + use<'a> {
        let span_us = self.onset_us..self.end_us;
        self.flown
            .frames
            .iter()
            .filter(move |frame| span_us.contains(&frame.record.trigger.us()))
    }

    fn fault(&self, fault: Fault, within_ms: Option<f64>) -> Check {
        let announced = self
            .flown
            .announced
            .iter()
            .find(|(time_us, one)| *time_us >= self.onset_us && *one == fault);
        let recorded = self
            .later()
            .any(|frame| frame.record.faults.contains(fault));
        let after_ms =
            announced.map(|(time_us, _)| 1e3 * seconds(time_us - self.felt_us.min(*time_us)));
        let passed = match within_ms {
            Some(within_ms) => after_ms.is_some_and(|after_ms| after_ms <= within_ms),
            None => after_ms.is_some() || recorded,
        };
        let what = match within_ms {
            Some(within_ms) => format!("{fault} named within {within_ms} ms"),
            None => format!("{fault} named"),
        };
        let found = match after_ms {
            Some(after_ms) => format!("{after_ms:.1} ms after it could be felt"),
            None if recorded => "in a record".to_owned(),
            None => "not named".to_owned(),
        };
        self.check(&what, found, passed)
    }

    fn state(&self, state: &str) -> Check {
        let found = self
            .flown
            .states
            .iter()
            .find(|(time_us, one)| *time_us >= self.onset_us && one.name() == state);
        self.check(
            &format!("state {state}"),
            found.map_or("never".to_owned(), |(time_us, one)| {
                format!("{one} at {:.3} s", seconds(*time_us))
            }),
            found.is_some(),
        )
    }

    fn refused_for(&self, reason: &str) -> Check {
        let found = self
            .later()
            .filter(|frame| match frame.record.outcome {
                Outcome::Refused(one) => one.name() == reason,
                Outcome::Exposed(_) => false,
            })
            .count();
        self.check_of(
            self.later().count(),
            &format!("a trigger refused: {reason}"),
            format!("{found} refused so"),
            found > 0,
        )
    }

    fn flag(&self, flag: Flag) -> Check {
        let found = self
            .later()
            .filter(|frame| frame.record.flags.contains(flag))
            .count();
        self.check_of(
            self.later().count(),
            &format!("a frame with the flag \"{}\"", flag.name()),
            wording::counted(found, "frame"),
            found > 0,
        )
    }

    fn refused_at_most(&self, most: usize) -> Check {
        let check = refused(self.flown, most);
        Check {
            what: format!("{}: {}", self.name, check.what),
            ..check
        }
    }

    fn vh_from(&self, way: VhSource) -> Check {
        let frames = self.meanwhile().filter_map(exposed).count();
        let last = self.meanwhile().filter_map(exposed).last();
        let found = last.and_then(|exposed| exposed.vh).map(|vh| vh.source);
        self.check_of(
            frames,
            &format!("V/H from {} in the end", way_name(way)),
            found.map_or("no V/H".to_owned(), |found| way_name(found).to_owned()),
            found == Some(way),
        )
    }

    fn smear(&self, most_px: f64) -> Check {
        let smears_px: Vec<f64> = self
            .flown
            .frames
            .iter()
            .zip(self.errors)
            .filter(|(frame, _)| frame.record.trigger.us() >= self.onset_us)
            .filter_map(|(_, errors)| errors.as_ref())
            .map(|errors| errors.smear_px)
            .collect();
        let largest_px = smears_px.iter().copied().fold(0.0, f64::max);
        self.check_of(
            smears_px.len(),
            &format!("no frame after the onset smeared by more than {most_px} px"),
            format!("largest {largest_px:.4} px"),
            largest_px <= most_px,
        )
    }

    /// Judges whether the camera compensates again soon after the end of the fault.
    fn armed(&self, within_s: f64) -> Check {
        let flies = |state: State| !matches!(state, State::Fault(_) | State::Degraded(_));
        let armed_us = if self.flown.state_at(self.end_us).is_some_and(flies) {
            Some(self.end_us)
        } else {
            self.flown
                .states
                .iter()
                .find(|(time_us, state)| *time_us >= self.end_us && *state == State::Armed)
                .map(|(time_us, _)| *time_us)
        };
        let after_s = armed_us.map(|armed_us| seconds(armed_us - self.end_us));
        self.check(
            &format!("armed within {within_s} s after its end"),
            after_s.map_or("not armed".to_owned(), |after_s| {
                format!("{after_s:.3} s after it")
            }),
            after_s.is_some_and(|after_s| after_s <= within_s),
        )
    }

    /// Judges whether the records of a cut arrive after it.
    fn records_kept(&self) -> Check {
        let kept = self.meanwhile().count();
        let too_soon = self
            .flown
            .frames
            .iter()
            .filter(|frame| (self.onset_us..self.end_us).contains(&frame.fetched_us))
            .count();
        let last_us = self
            .meanwhile()
            .map(|frame| frame.fetched_us)
            .max()
            .unwrap_or(self.end_us);
        self.check_of(
            kept,
            "records of the cut come after it, and none comes during it",
            format!(
                "{kept} kept, the last fetched {:.3} s after its end; {too_soon} during it",
                seconds(last_us.saturating_sub(self.end_us))
            ),
            too_soon == 0 && last_us >= self.end_us,
        )
    }

    /// Judges the uncertainty of a V/H that no source renews: it has to grow from frame to frame.
    fn uncertainty_grows(&self) -> Check {
        let held: Vec<f32> = self
            .meanwhile()
            .filter(|frame| frame.record.flags.contains(Flag::LastGoodVh))
            .filter_map(exposed)
            .filter_map(|exposed| Some(exposed.vh?.sigma_per_s))
            .collect();
        // A single value cannot grow.
        let pairs = held.len().saturating_sub(1);
        let grows = held
            .iter()
            .zip(held.iter().skip(1))
            .all(|(one, next)| one < next);
        let found = match (held.first(), held.last()) {
            (Some(first), Some(last)) => format!(
                "{} with the last good V/H, σ from {first:.5} to {last:.5} 1/s",
                wording::counted(held.len(), "frame")
            ),
            _ => "no frame with the last good V/H".to_owned(),
        };
        self.check_of(pairs, "σ of a V/H that is held grows", found, grows)
    }
}

fn exposed(frame: &FlownFrame) -> Option<&ExposedFrame> {
    match &frame.record.outcome {
        Outcome::Exposed(exposed) => Some(exposed),
        Outcome::Refused(_) => None,
    }
}
