//! Following of the stage with the gains of the library, against the documented bounds.

use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::{
    following_error_bounds::FollowingErrorBounds, loop_settings::LoopSettings,
};
use fmc_simulation::mechanics::{EncoderSide, MechanicsSettings};

use crate::mechanics::profile::{ACCELERATION_MM_S2, FASTEST_MM_S, Profile};
use crate::mechanics::support::{Followed, drive_for, followed};

const SPEEDS_MM_S: [f64; 4] = [5.0, 10.0, 17.0, 25.0];

/// Times of the profile's corners after a tick, s.
const CORNERS_S: [f64; 3] = [0.0, 0.3e-3, 0.7e-3];

/// Returns fly-back, run-up, cruise, stop and fly-back again, after some strokes to and fro.
fn profile(speed_mm_s: f64, corner_s: f64, strokes: u32) -> Profile {
    let mut profile = Profile::at_rest(0.02 + corner_s);
    profile.strokes(strokes);
    profile.measure_from_here();
    let start_mm = -0.5 * (speed_mm_s * speed_mm_s / ACCELERATION_MM_S2 + speed_mm_s * 0.025);
    profile.move_to(start_mm, FASTEST_MM_S, ACCELERATION_MM_S2);
    profile.rest(0.04);
    profile.cruise(speed_mm_s, 0.025, ACCELERATION_MM_S2);
    profile.rest(0.04);
    // The room allows the fastest fly-back.
    profile.move_to(1.6, FASTEST_MM_S, ACCELERATION_MM_S2);
    profile.rest(0.04);
    profile.move_to(-1.6, FASTEST_MM_S, ACCELERATION_MM_S2);
    profile.rest(0.3);
    profile
}

fn worst(stages: &[MechanicsSettings], strokes: u32) -> Followed {
    let mut worst = Followed::default();
    for settings in stages {
        for speed_mm_s in SPEEDS_MM_S {
            for corner_s in CORNERS_S {
                let profile = profile(speed_mm_s, corner_s, strokes);
                worst = worst.worst(followed(*settings, drive_for(settings), &profile));
            }
        }
    }
    worst
}

/// Returns stages with mass, friction and force 30 % up and down.
fn varied(stage: MechanicsSettings) -> Vec<MechanicsSettings> {
    let mut stages = Vec::new();
    for mass in [0.7, 1.3] {
        for friction in [0.7, 1.3] {
            for force in [0.7, 1.3] {
                stages.push(MechanicsSettings {
                    mass_kg: stage.mass_kg * mass,
                    coulomb_n: stage.coulomb_n * friction,
                    breakaway_n: stage.breakaway_n * friction,
                    force_n: stage.force_n * force,
                    ..stage
                });
            }
        }
    }
    stages
}

fn coarse() -> MechanicsSettings {
    MechanicsSettings {
        encoder_step_um: 0.5,
        ..MechanicsSettings::default()
    }
}

fn slow() -> MechanicsSettings {
    MechanicsSettings {
        encoder_latency_s: 2e-4,
        duty_latency_s: 2e-4,
        ..MechanicsSettings::default()
    }
}

fn assert_within(found: Followed, bounds: &FollowingErrorBounds) {
    println!("{found:.2?}");
    let pairs = [
        ("cruise", found.cruise_um, bounds.cruise_um),
        ("smear", found.smear_um, bounds.smear_um),
        ("ramp", found.ramp_um, bounds.ramp_um),
        ("fly-back", found.fly_back_um, bounds.fly_back_um),
        ("rest", found.rest_um, bounds.rest_um),
        ("seen", found.seen_um, bounds.seen_um),
    ];
    for (name, found_um, bound_um) in pairs {
        let bound_um = f64::from(bound_um);
        assert!(
            found_um <= bound_um,
            "{name}: {found_um} µm > {bound_um} µm"
        );
    }
    // The documented bounds must be near the measured values, not a multiple of them.
    for (name, found_um, bound_um) in pairs {
        let bound_um = f64::from(bound_um);
        assert!(
            found_um >= 0.6 * bound_um,
            "{name}: {found_um} µm << {bound_um} µm"
        );
    }
}

#[test]
fn stage_that_was_tuned_on_follows_within_the_documented_bounds() {
    assert_within(
        worst(&[MechanicsSettings::default()], 0),
        &LoopSettings::NOMINAL,
    );
}

#[test]
fn coarse_encoder_is_followed_within_the_documented_bounds() {
    assert_within(worst(&[coarse()], 0), &LoopSettings::COARSE);
}

#[test]
fn stages_thirty_per_cent_off_follow_within_the_documented_bounds_once_learned() {
    let mut stages = varied(MechanicsSettings::default());
    stages.extend(varied(coarse()));
    stages.extend(varied(slow()));
    assert_within(worst(&stages, 2), &LoopSettings::LEARNED);
}

#[test]
fn stages_thirty_per_cent_off_are_stable_before_anything_is_learned() {
    let mut stages = varied(MechanicsSettings::default());
    stages.extend(varied(coarse()));
    stages.extend(varied(slow()));
    assert_within(worst(&stages, 0), &LoopSettings::UNLEARNED);
}

#[test]
fn play_inside_the_loop_and_much_of_it_does_not_hunt() {
    let stages = [
        MechanicsSettings {
            encoder_side: EncoderSide::Stage,
            ..MechanicsSettings::default()
        },
        MechanicsSettings {
            backlash_um: 10.0,
            ..MechanicsSettings::default()
        },
    ];
    for stage in stages {
        let found = worst(&[stage], 0);
        println!("{found:.2?}");
        assert_eq!(found.hunting, 0);
        // With the play on the side of fly-back, the exposure is free of it.
        assert!(
            found.cruise_um <= 1.0 && found.smear_um <= 0.94,
            "{found:?}"
        );
    }
}

#[test]
fn stage_at_rest_gets_no_duty() {
    let mut stages = varied(MechanicsSettings::default());
    stages.extend(varied(coarse()));
    stages.push(MechanicsSettings::default());
    for strokes in [0, 2] {
        assert_eq!(worst(&stages, strokes).hunting, 0, "{strokes}");
    }
}

#[test]
fn documented_bounds_keep_the_smear_below_a_quarter_of_a_pixel() {
    // The limit is 0.25 px of 3.76 µm.
    for bounds in [
        LoopSettings::NOMINAL,
        LoopSettings::COARSE,
        LoopSettings::LEARNED,
    ] {
        assert!(bounds.smear_um <= 0.94 && bounds.cruise_um <= 2.0 && bounds.ramp_um <= 8.0);
    }
    let _ = DriveSettings::default().checked().unwrap();
}
