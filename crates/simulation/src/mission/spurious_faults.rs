//! Faults that a camera names although nobody has injected any.

use fmc_camera::flight::controller::state::State;

use super::check::Check;
use super::clock::microseconds;
use super::flown::Flown;
use super::scenario::MissionScenario;

/// Returns the names of the faults that came before any that was injected: announced, in a record
/// or in the state of a camera that flies without compensation. Each is named once.
pub(crate) fn of(scenario: &MissionScenario, flown: &Flown) -> Vec<String> {
    let onsets = scenario.faults.iter();
    // The camera names faults by its own clock.
    let first_onset_us = onsets
        .map(|fault| fault.injection.onset_s)
        .min_by(f64::total_cmp)
        .map(|onset_s| microseconds(flown.clock.shown_s(onset_s)));
    let is_spurious = |time_us: u64| first_onset_us.is_none_or(|onset_us| time_us < onset_us);
    let announced = flown.announced.iter().copied();
    let degraded = flown
        .states
        .iter()
        .filter_map(|(time_us, state)| match state {
            State::Degraded(fault) => Some((*time_us, *fault)),
            _ => None,
        });
    let recorded = flown.frames.iter().flat_map(|frame| {
        let faults = frame.fetched_faults;
        faults.iter().map(|fault| (frame.fetched_us, fault))
    });
    let mut spurious: Vec<String> = announced
        .chain(degraded)
        .chain(recorded)
        .filter(|(time_us, _)| is_spurious(*time_us))
        .map(|(_, fault)| fault.to_string())
        .collect();
    spurious.sort();
    spurious.dedup();
    spurious
}

/// Checks that the camera names no fault before the first that is injected.
pub(super) fn check(scenario: &MissionScenario, flown: &Flown) -> Check {
    let spurious = of(scenario, flown);
    Check::over(
        (flown.triggers_us.len(), "trigger"),
        "no fault but those injected".to_owned(),
        if spurious.is_empty() {
            "none before them".to_owned()
        } else {
            spurious.join(", ")
        },
        spurious.is_empty(),
    )
}
