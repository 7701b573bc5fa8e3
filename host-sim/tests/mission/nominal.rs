//! The nominal mission and its limits.

use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::passed;

#[test]
fn nominal_mission_keeps_its_limits() {
    let scenario = MissionScenario::nominal(Some(50)).unwrap();
    let (flown, judgement) = passed(&scenario, 1);
    assert_eq!(flown.frames.len(), 50);
    assert!(flown.unrecorded.is_empty());
    let limits = &scenario.written.limits;
    assert!((limits.pp_error_px - 0.1).abs() < 1e-12 && (limits.smear_px - 0.25).abs() < 1e-12);
    for errors in &judgement.errors {
        let errors = errors.unwrap();
        assert!(
            errors.pp_error_px.abs() <= 0.1 && errors.smear_px <= 0.25,
            "{errors:?}"
        );
    }
}

#[test]
fn standing_stage_shows_in_the_truth() {
    // The motor is too weak for the same flight. The judgement must see that in the truth, without
    // the camera's set points.
    let mut scenario = MissionScenario::nominal(Some(10)).unwrap();
    scenario.written.mechanics.force_n = 0.3;
    let flown = crate::mission::support::flown(&scenario, 1);
    let judgement = fmc_simulation::mission::judgement::Judgement::of(&scenario, &flown);
    assert!(!judgement.passed());
}
