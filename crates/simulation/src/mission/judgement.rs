//! Judgement of a flight by its limits and by the expected outcomes of its faults.

use fmc_camera::flight::frame_record::{Outcome, Reason};

use super::check::{Check, refused};
use super::flown::Flown;
use super::frame_errors::FrameErrors;
use super::outcome::outcome;
use super::scenario::MissionScenario;
use crate::wording;

/// Largest error of a principal point, in units of its stated σ.
const SIGMAS: f64 = 3.0;

/// Judgement of a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Errors of each frame, in the order of the frames.
    pub errors: Vec<Option<FrameErrors>>,
    /// Findings of the judgement.
    pub checks: Vec<Check>,
}

impl Judgement {
    /// Judges a flight.
    #[must_use]
    pub fn of(scenario: &MissionScenario, flown: &Flown) -> Self {
        let errors: Vec<Option<FrameErrors>> = flown
            .frames
            .iter()
            .map(|frame| FrameErrors::of(&scenario.camera, frame))
            .collect();
        let mut checks = vec![unanswered(flown), coordinates(scenario, flown, &errors)];
        if scenario.faults.is_empty() {
            checks.push(nominal_smear(scenario, &errors));
            checks.push(refused(flown, 0));
        } else {
            checks.push(predicted_smear(scenario, flown, &errors));
        }
        for (fault, felt_us) in scenario.faults.iter().zip(&flown.felt_us) {
            checks.extend(outcome(scenario, flown, &errors, fault, *felt_us));
        }
        Self { errors, checks }
    }

    /// Returns true if every check is as it should be.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.checks.iter().all(|check| check.passed)
    }
}

/// Checks that every trigger has its record at its own time, numbered without a gap. Of triggers
/// refused because the camera's memory was full, all but the last may have the time of the first.
fn unanswered(flown: &Flown) -> Check {
    let answered = flown
        .triggers_us
        .iter()
        .zip(&flown.frames)
        .zip(1_u32..)
        .filter(|((trigger_us, frame), number)| {
            let record = &frame.record;
            let is_full = record.outcome == Outcome::Refused(Reason::RecordsFull);
            let is_its_time = record.trigger.us() == **trigger_us
                || is_full && record.trigger.us() < **trigger_us;
            record.sequence == *number && is_its_time
        })
        .count();
    let missing = flown.triggers_us.len() - answered;
    let extra = flown.frames.len().saturating_sub(flown.triggers_us.len());
    Check {
        what: "every trigger has its record".to_owned(),
        found: format!(
            "{answered} of {} answered in order, {} too many",
            wording::counted(flown.triggers_us.len(), "trigger"),
            wording::counted(extra, "record")
        ),
        passed: missing == 0 && extra == 0,
    }
}

/// Checks the principal points of the frames that the camera vouches for: the error is at most the
/// limit, or [`SIGMAS`] where the camera states a larger uncertainty.
fn coordinates(scenario: &MissionScenario, flown: &Flown, errors: &[Option<FrameErrors>]) -> Check {
    let limit_px = scenario.written.limits.pp_error_px;
    let clean = || errors.iter().flatten().filter(|errors| errors.is_clean);
    let worst = clean()
        .map(|errors| errors.pp_error_px.abs())
        .fold(0.0, f64::max);
    let are_right = clean()
        .all(|errors| errors.pp_error_px.abs() <= f64::max(limit_px, SIGMAS * errors.sigma_px));
    // A record of light that did not pass is worse than any error.
    let invented = flown
        .frames
        .iter()
        .filter(|frame| {
            matches!(frame.record.outcome, Outcome::Exposed(_)) && frame.truth.is_none()
        })
        .count();
    Check {
        what: format!(
            "principal point within {limit_px} px of the truth, or {SIGMAS} σ where the record says more, in all frames without fault or flag"
        ),
        found: format!(
            "{}, largest error {worst:.4} px, {} of light that did not pass",
            wording::counted(clean().count(), "frame"),
            wording::counted(invented, "record")
        ),
        passed: are_right && invented == 0,
    }
}

/// Checks the smear of a flight in which nothing goes wrong.
fn nominal_smear(scenario: &MissionScenario, errors: &[Option<FrameErrors>]) -> Check {
    let limit_px = scenario.written.limits.smear_px;
    let worst = errors
        .iter()
        .flatten()
        .map(|errors| errors.smear_px)
        .fold(0.0, f64::max);
    Check {
        what: format!("smear of all frames at most {limit_px} px, attitude included"),
        found: format!("largest {worst:.4} px"),
        passed: worst <= limit_px,
    }
}

/// Checks the smear of a flight with faults: the camera predicts the smear that it cannot prevent.
fn predicted_smear(
    scenario: &MissionScenario,
    flown: &Flown,
    errors: &[Option<FrameErrors>],
) -> Check {
    let limit_px = scenario.written.limits.smear_px;
    let excess = flown
        .frames
        .iter()
        .zip(errors)
        .filter(|(frame, _)| frame.record.faults.is_empty())
        .filter_map(|(_, errors)| errors.as_ref())
        .map(|errors| errors.smear_px - errors.predicted_px)
        .fold(f64::NEG_INFINITY, f64::max);
    Check {
        what: format!("no frame without fault smeared by {limit_px} px more than predicted"),
        found: format!("at most {excess:.4} px more"),
        passed: excess <= limit_px,
    }
}
