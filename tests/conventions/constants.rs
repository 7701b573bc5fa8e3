//! The constants of section 11.

use crate::conventions::document::{names, rows, running_text};
use fmc_camera::flight::exposure::Limits;
use fmc_camera::flight::smear_prediction::COVERAGE;
use fmc_camera::flight::stage::{POSITION_NM, RUN_UP_RESERVE};
use fmc_camera::flight::utc::{
    CLOCK_TOLERANCE_PPM, CONSISTENT_PULSES, CONSISTENT_TIMES, DRIFT_WANDER_PPM_PER_S, HOLDOVER_S,
    UNMEASURED_DRIFT_PPM, WORST_PULSE_SIGMA_S,
};
use fmc_camera::flight::vh::agreement::{CONTRADICTION_SIGMAS, SHARE_OF_EXCESS, TRUSTED_S};
use fmc_camera::flight::vh::channel::{
    CONFIRMED_WITHIN, CONSISTENT_SAMPLES, GUST_SIGMAS, NOISE_SIGMAS,
};
use fmc_camera::flight::vh::settings::{LEAST_HEIGHT_M, LEAST_SPEED_M_S, LEAST_VH_PER_S};
use fmc_camera::flight::vh::unit_watch::{UNIT_RELEASE, UNIT_TOLERANCE};
use fmc_camera::geometry::estimation::adjustment::{MIN_POINTS, MIN_REGRESSOR_MM, MIN_SPREAD};
use fmc_camera::geometry::estimation::design::MIN_SEPARATION;
use fmc_camera::geometry::frame_correction::SHORT_KERNEL_NM;
use fmc_camera::geometry::image_motion::LEAST_GROUND_SCALE;
use fmc_camera::geometry::inverse::{FREE_STEPS, LAST_RESIDUAL_NM, MAX_STEPS};
use fmc_camera::geometry::invertibility::{MAX_DISC_SLOPE, MIN_SCALE};
use fmc_camera::geometry::newton_step::{LEFT_BY_ONE_STEP_NM, MAX_LAST_STEP_FRACTION};
use fmc_camera::geometry::principal_distance::FLATNESS_TERMS;
use fmc_camera::geometry::range::{MAX_FOCUS_FRACTION, MAX_ROWS};
use fmc_camera::geometry::sensor::{MAX_SIDE_MM, MAX_SIDE_PX};

#[test]
fn documented_constants_are_those_of_the_code() {
    let constants = [
        ("MAX_SIDE_PX", MAX_SIDE_PX.to_string()),
        ("MAX_SIDE_MM", MAX_SIDE_MM.to_string()),
        ("MAX_ROWS", MAX_ROWS.to_string()),
        ("FLATNESS_TERMS", FLATNESS_TERMS.to_string()),
        ("MAX_FOCUS_FRACTION", MAX_FOCUS_FRACTION.to_string()),
        ("MIN_SCALE", MIN_SCALE.to_string()),
        ("MAX_DISC_SLOPE", MAX_DISC_SLOPE.to_string()),
        ("SHORT_KERNEL_NM", SHORT_KERNEL_NM.to_string()),
        ("LEFT_BY_ONE_STEP_NM", LEFT_BY_ONE_STEP_NM.to_string()),
        ("MAX_LAST_STEP_FRACTION", MAX_LAST_STEP_FRACTION.to_string()),
        ("FREE_STEPS", FREE_STEPS.to_string()),
        ("LAST_RESIDUAL_NM", LAST_RESIDUAL_NM.to_string()),
        ("MAX_STEPS", MAX_STEPS.to_string()),
        ("MIN_POINTS", MIN_POINTS.to_string()),
        ("MIN_SPREAD", MIN_SPREAD.to_string()),
        ("MIN_REGRESSOR_MM", MIN_REGRESSOR_MM.to_string()),
        ("MIN_SEPARATION", MIN_SEPARATION.to_string()),
        ("LEAST_GROUND_SCALE", LEAST_GROUND_SCALE.to_string()),
        ("RUN_UP_RESERVE", RUN_UP_RESERVE.to_string()),
        ("POSITION_NM", POSITION_NM.to_string()),
        ("LEAST_VH_PER_S", LEAST_VH_PER_S.to_string()),
        ("LEAST_SPEED_M_S", LEAST_SPEED_M_S.to_string()),
        ("LEAST_HEIGHT_M", LEAST_HEIGHT_M.to_string()),
        ("NOISE_SIGMAS", NOISE_SIGMAS.to_string()),
        ("GUST_SIGMAS", GUST_SIGMAS.to_string()),
        ("CONSISTENT_SAMPLES", CONSISTENT_SAMPLES.to_string()),
        ("UNIT_TOLERANCE", UNIT_TOLERANCE.to_string()),
        ("UNIT_RELEASE", UNIT_RELEASE.to_string()),
        ("CONFIRMED_WITHIN", CONFIRMED_WITHIN.to_string()),
        ("CONTRADICTION_SIGMAS", CONTRADICTION_SIGMAS.to_string()),
        ("TRUSTED_S", TRUSTED_S.to_string()),
        ("SHARE_OF_EXCESS", SHARE_OF_EXCESS.to_string()),
        ("COVERAGE", COVERAGE.to_string()),
        ("CLOCK_TOLERANCE_PPM", CLOCK_TOLERANCE_PPM.to_string()),
        ("UNMEASURED_DRIFT_PPM", UNMEASURED_DRIFT_PPM.to_string()),
        ("DRIFT_WANDER_PPM_PER_S", DRIFT_WANDER_PPM_PER_S.to_string()),
        ("HOLDOVER_S", HOLDOVER_S.to_string()),
        ("WORST_PULSE_SIGMA_S", WORST_PULSE_SIGMA_S.to_string()),
        ("CONSISTENT_TIMES", CONSISTENT_TIMES.to_string()),
        ("CONSISTENT_PULSES", CONSISTENT_PULSES.to_string()),
    ];
    let documented: Vec<_> = rows("constant")
        .into_iter()
        .map(|row| (names(row[0])[0], row[1].to_owned()))
        .collect();
    assert_eq!(documented, constants);
}

#[test]
fn documented_default_limits_are_those_of_the_code() {
    let Limits {
        vh_per_s: [least, most],
        exposure_s: [shortest, longest],
    } = Limits::DEFAULT;
    let [shortest, longest] = [shortest, longest].map(|seconds| seconds.recip().round());
    let sentence =
        format!("V/H (1/s) {least} to {most} and exposures (s) 1/{shortest} to 1/{longest}");
    assert!(running_text().contains(&sentence), "{sentence}");
}
