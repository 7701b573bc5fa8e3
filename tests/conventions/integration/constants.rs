//! Constants of the camera's decisions.

use fmc_camera::flight::control_loop::MAX_EVENTS;
use fmc_camera::flight::controller::timing::{
    ATTITUDE_WITHIN_S, CLOCK_JUMP_S, EXERCISE_REACH, EXERCISE_WAYS, LATE_EVENT_S, LATE_TICK_S,
    LEAD_S, LONGEST_GAP, OVERLOAD_ROUNDS, OVERLOAD_WINDOW_S, PAUSE_S, READING_GAP_PART,
    READING_GAP_S, READING_WITHIN_S, READINGS_CEASE_S, REMEMBERED_ROUNDS, SETTLED_ROUNDS,
    SHUTTER_GIVEN_UP_S, SHUTTER_MISSING_S, STAMP_SIGMA_S, STANDING_S, TICK_S, UNLEARNED_TOLERANCE,
};
use fmc_camera::flight::lens_temperature::TEMPERATURE_VALID_S;
use fmc_camera::flight::record_log::CAPACITY;
use fmc_camera::flight::round_guard::LONGEST_ROUND_US;

use super::rows;
use crate::conventions::document::names;

const TIMING: &str = include_str!("../../../src/flight/controller/timing.rs");

#[test]
fn documented_constants_are_those_of_the_code() {
    let constants = [
        ("EXERCISE_WAYS", EXERCISE_WAYS.to_string()),
        ("EXERCISE_REACH", EXERCISE_REACH.to_string()),
        ("UNLEARNED_TOLERANCE", UNLEARNED_TOLERANCE.to_string()),
        ("TICK_S", TICK_S.to_string()),
        ("LATE_EVENT_S", LATE_EVENT_S.to_string()),
        ("LATE_TICK_S", LATE_TICK_S.to_string()),
        ("CLOCK_JUMP_S", CLOCK_JUMP_S.to_string()),
        ("PAUSE_S", PAUSE_S.to_string()),
        ("OVERLOAD_ROUNDS", OVERLOAD_ROUNDS.to_string()),
        ("OVERLOAD_WINDOW_S", OVERLOAD_WINDOW_S.to_string()),
        ("SHUTTER_MISSING_S", SHUTTER_MISSING_S.to_string()),
        ("SHUTTER_GIVEN_UP_S", SHUTTER_GIVEN_UP_S.to_string()),
        ("STANDING_S", STANDING_S.to_string()),
        ("SETTLED_ROUNDS", SETTLED_ROUNDS.to_string()),
        ("REMEMBERED_ROUNDS", REMEMBERED_ROUNDS.to_string()),
        ("READING_WITHIN_S", READING_WITHIN_S.to_string()),
        ("STAMP_SIGMA_S", STAMP_SIGMA_S.to_string()),
        ("ATTITUDE_WITHIN_S", ATTITUDE_WITHIN_S.to_string()),
        ("LEAD_S", LEAD_S.to_string()),
        ("READINGS_CEASE_S", READINGS_CEASE_S.to_string()),
        ("READING_GAP_S", READING_GAP_S.to_string()),
        ("READING_GAP_PART", READING_GAP_PART.to_string()),
        ("LONGEST_GAP", LONGEST_GAP.to_string()),
        ("MAX_EVENTS", MAX_EVENTS.to_string()),
        ("LONGEST_ROUND_US", LONGEST_ROUND_US.to_string()),
        ("TEMPERATURE_VALID_S", TEMPERATURE_VALID_S.to_string()),
        ("CAPACITY", CAPACITY.to_string()),
    ];
    let documented: Vec<_> = rows("constant")
        .into_iter()
        .map(|row| (names(row[0])[0], row[1].to_owned()))
        .collect();
    assert_eq!(documented, constants);
}

#[test]
fn no_constant_of_the_controller_is_left_out() {
    let documented: Vec<_> = rows("constant")
        .into_iter()
        .map(|row| names(row[0])[0])
        .collect();
    let timing = TIMING
        .lines()
        .filter_map(|line| line.strip_prefix("pub const ")?.split(':').next());
    for name in timing {
        assert!(documented.contains(&name), "{name}");
    }
}
