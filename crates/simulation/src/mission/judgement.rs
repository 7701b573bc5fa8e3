//! Judgement of a flight by its limits and by the expected outcomes of its faults.

use fmc_camera::flight::frame_record::Outcome;

use super::check::{Check, refused};
use super::flown::Flown;
use super::focus_check;
use super::frame_errors::FrameErrors;
use super::outcome::outcome;
use super::physical_truth::TrueWorld;
use super::scenario::MissionScenario;
use super::sigma_checks;
use super::spurious_faults;
use crate::judge::answers::Answers;
use crate::judge::verdict::Verdict;
use crate::wording;

/// Largest error of a principal point, in units of its stated σ.
const SIGMAS: f64 = 3.0;

/// Judgement of a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Errors of each frame, in the order of the frames.
    pub errors: Vec<Option<FrameErrors>>,
    /// Errors of each frame with the σ that its record states, in the order of the frames.
    pub verdicts: Vec<Option<Verdict>>,
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
        let verdicts = verdicts(scenario, flown);
        let mut checks = vec![
            unanswered(flown),
            spurious_faults::check(scenario, flown),
            coordinates(scenario, flown, &errors),
        ];
        checks.extend(focus_check::check(scenario, flown));
        checks.extend(sigma_checks::of(scenario, &verdicts));
        if scenario.faults.is_empty() {
            checks.push(nominal_smear(scenario, &errors));
            checks.push(refused(flown, 0));
        } else {
            checks.push(predicted_smear(scenario, flown, &errors));
        }
        for (fault, felt_us) in scenario.faults.iter().zip(&flown.felt_us) {
            checks.extend(outcome(scenario, flown, &errors, fault, *felt_us));
        }
        Self {
            errors,
            verdicts,
            checks,
        }
    }

    /// Returns true if every check is as it should be.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.checks.iter().all(|check| check.passed)
    }
}

/// Compares the records of a flight with the physical truth, in the order of the frames.
pub(crate) fn verdicts(scenario: &MissionScenario, flown: &Flown) -> Vec<Option<Verdict>> {
    let world = TrueWorld::of(scenario, &flown.clock);
    flown
        .frames
        .iter()
        .map(|frame| Verdict::of(&frame.record, &world.truth(frame.truth.as_ref()?)))
        .collect()
}

/// Checks that every trigger has its record.
fn unanswered(flown: &Flown) -> Check {
    let records = flown.frames.iter().map(|frame| &frame.record);
    let answers = Answers::of(&flown.triggers_us, records);
    Check::over(
        (answers.triggers, "trigger"),
        "every trigger has its record".to_owned(),
        format!(
            "{} of {} answered in order, {} too many",
            answers.answered,
            wording::counted(answers.triggers, "trigger"),
            wording::counted(answers.extra, "record")
        ),
        answers.are_complete(),
    )
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
    Check::over(
        (clean().count(), "frame"),
        format!(
            "principal point within {limit_px} px of the truth, or {SIGMAS} σ where the record says more, in all frames without fault or flag"
        ),
        format!(
            "{}, largest error {worst:.4} px, {} of light that did not pass",
            wording::counted(clean().count(), "frame"),
            wording::counted(invented, "record")
        ),
        are_right && invented == 0,
    )
}

/// Checks the smear of a flight in which nothing goes wrong.
fn nominal_smear(scenario: &MissionScenario, errors: &[Option<FrameErrors>]) -> Check {
    let limit_px = scenario.written.limits.smear_px;
    let worst = errors
        .iter()
        .flatten()
        .map(|errors| errors.smear_px)
        .fold(0.0, f64::max);
    Check::over(
        (errors.iter().flatten().count(), "frame"),
        format!("smear of all frames at most {limit_px} px, attitude included"),
        format!("largest {worst:.4} px"),
        worst <= limit_px,
    )
}

/// Checks the smear of a flight with faults: the camera predicts the smear that it cannot prevent.
fn predicted_smear(
    scenario: &MissionScenario,
    flown: &Flown,
    errors: &[Option<FrameErrors>],
) -> Check {
    let limit_px = scenario.written.limits.smear_px;
    let without_fault: Vec<&FrameErrors> = flown
        .frames
        .iter()
        .zip(errors)
        .filter(|(frame, _)| frame.record.faults.is_empty())
        .filter_map(|(_, errors)| errors.as_ref())
        .collect();
    let excess = without_fault
        .iter()
        .map(|errors| errors.smear_px - errors.predicted_px)
        .fold(f64::NEG_INFINITY, f64::max);
    Check::over(
        (without_fault.len(), "frame"),
        format!("no frame without fault smeared by {limit_px} px more than predicted"),
        format!("at most {excess:.4} px more"),
        excess <= limit_px,
    )
}
