//! A lens whose focus drifts with its temperature, against the focus of its records.

use fmc_camera::flight::frame_record::{Flag, Outcome};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::focus_check::{FocusError, focus_errors};
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::{flown, folder, passed};

/// Returns the shipped scenario with a number of exposures.
fn scenario(exposures: u32) -> MissionScenario {
    MissionScenario::read(&folder().join("temperature.toml"), Some(exposures)).unwrap()
}

fn errors(scenario: &MissionScenario, flown: &Flown) -> Vec<FocusError> {
    let errors = focus_errors(scenario, flown);
    errors.into_iter().map(Option::unwrap).collect()
}

/// Reported Δz of every record, µm.
fn reported_um(flown: &Flown) -> Vec<f32> {
    let of = |outcome: &Outcome| match outcome {
        Outcome::Exposed(frame) => 1000.0 * frame.interior.focus_shift_mm,
        Outcome::Refused(reason) => panic!("{reason}"),
    };
    let records = flown.frames.iter();
    records.map(|frame| of(&frame.record.outcome)).collect()
}

#[test]
fn focus_of_records_follows_a_lens_that_cools() {
    let scenario = scenario(200);
    let (flown, judgement) = passed(&scenario, 1);
    let is_checked = |what: &str| what.starts_with("focus shift within 1 µm");
    assert!(judgement.checks.iter().any(|it| is_checked(&it.what)));
    let errors = errors(&scenario, &flown);
    assert_eq!(errors.len(), 200);
    for error in &errors {
        // 0.3 µm of the curvature between two rows, and 0.2 °C since the last message.
        assert!(
            error.error_um.abs() < 0.75 && !error.is_flagged,
            "{error:?}"
        );
        assert!(error.corner_px.abs() < 0.05, "{error:?}");
    }
    let reported_um = reported_um(&flown);
    let (first, last) = (reported_um[0], reported_um[199]);
    assert!(first > 16.0 && last < -5.0, "{first} to {last} µm");
}

#[test]
fn lens_of_which_nobody_tells_the_temperature_has_wrong_records_with_their_flag() {
    let mut scenario = scenario(5);
    let table = scenario.written.temperature.as_mut().unwrap();
    table.told_every_s = 0.0;
    let flown = flown(&scenario, 1);
    for (frame, error) in flown.frames.iter().zip(errors(&scenario, &flown)) {
        assert!(frame.record.flags.contains(Flag::TemperatureUnknown));
        assert!(error.error_um < -16.0 && error.is_flagged, "{error:?}");
        assert!(error.corner_px < -1.0, "{error:?}");
    }
    assert!(reported_um(&flown).iter().all(|um| um.abs() < 1e-6));
}

#[test]
fn lens_warmer_than_its_table_has_the_nearest_row_and_its_flag() {
    let mut scenario = scenario(5);
    let table = scenario.written.temperature.as_mut().unwrap();
    table.start_c = 45.0;
    let flown = flown(&scenario, 1);
    for frame in &flown.frames {
        assert!(frame.record.flags.contains(Flag::TemperatureOutside));
    }
    assert!(
        reported_um(&flown)
            .iter()
            .all(|um| (um - 31.2).abs() < 1e-4)
    );
    let errors = errors(&scenario, &flown);
    assert!(
        errors.iter().all(|error| error.error_um < -5.0),
        "{errors:?}"
    );
}

#[test]
fn camera_whose_table_is_of_another_lens_is_found_by_the_check() {
    let mut scenario = scenario(5);
    // The plant is another than the table says.
    let table = scenario.written.temperature.as_mut().unwrap();
    table.focus_shift_um = [0.0, 1.5, -0.012, 0.0];
    let flown = flown(&scenario, 1);
    let judgement = fmc_simulation::mission::judgement::Judgement::of(&scenario, &flown);
    let focus = judgement
        .checks
        .iter()
        .find(|it| it.what.starts_with("focus shift"));
    assert!(!focus.unwrap().passed, "{focus:?}");
}
