//! Encoders of every step, phase, side and play: none leads to a fault by itself, and σ covers the
//! principal point.

use fmc_camera::flight::frame_record::Outcome;
use fmc_simulation::mechanics::EncoderSide;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::flown;

/// Steps of an encoder, µm: the smallest and the largest that a stage is flown with, and between.
const STEPS_UM: [f64; 6] = [0.01, 0.05, 0.2, 0.5, 1.0, 5.0];

/// Plays, µm: none, that of a ball screw, and that of a worn one.
const PLAYS_UM: [f64; 3] = [0.0, 5.0, 50.0];

/// Returns the errors of a short flight's principal points in units of their σ.
fn normalised_errors(change: impl FnOnce(&mut MissionScenario), seed: u64) -> Vec<f64> {
    let mut scenario = MissionScenario::nominal(Some(6)).unwrap();
    change(&mut scenario);
    let mechanics = scenario.written.mechanics;
    let flown = flown(&scenario, seed);
    assert!(!flown.frames.is_empty());
    for frame in &flown.frames {
        assert!(
            frame.record.faults.is_empty(),
            "{:?}, {mechanics:?}",
            frame.record.faults
        );
    }
    let errors = Judgement::of(&scenario, &flown).errors;
    errors
        .into_iter()
        .flatten()
        .map(|errors| errors.pp_error_px / errors.sigma_px)
        .collect()
}

#[test]
fn no_step_phase_side_or_play_of_an_encoder_leads_to_a_fault_or_out_of_its_sigma() {
    let mut errors = Vec::new();
    for (seed, step_um) in (1..).zip(STEPS_UM) {
        for play_um in PLAYS_UM {
            for side in [EncoderSide::Screw, EncoderSide::Stage] {
                for phase in [-0.5, -0.2, 0.4] {
                    errors.extend(normalised_errors(
                        |scenario| {
                            let mechanics = &mut scenario.written.mechanics;
                            mechanics.encoder_step_um = step_um;
                            mechanics.encoder_phase_um = Some(phase * step_um);
                            mechanics.encoder_side = side;
                            mechanics.backlash_um = play_um;
                        },
                        seed,
                    ));
                }
            }
        }
    }
    // A stage with a worn screw inside its loop may not be at speed in time.
    assert!(errors.len() > 500, "{}", errors.len());
    let largest = errors
        .iter()
        .fold(0.0_f64, |most, error| most.max(error.abs()));
    let rms = (errors.iter().map(|error| error * error).sum::<f64>()
        / f64::from(u32::try_from(errors.len()).unwrap()))
    .sqrt();
    println!(
        "{} exposures: error/σ rms {rms:.2}, largest {largest:.2}",
        errors.len()
    );
    assert!(largest < 4.0, "{largest}");
    assert!((0.6..1.2).contains(&rms), "{rms}");
}

/// A stage that stands, without V/H or after a stall, is on one of the flanks of its play, and one
/// that is pushed against the axis is ahead by all of it. One whose screw has turned round between
/// two readings (seeds 8 and 12) is somewhere between.
#[test]
fn standing_stage_carries_its_play() {
    for (name, play_um, seed) in [
        ("vh-drop-out", 1.0, 3),
        ("vh-drop-out", 1.0, 12),
        ("vh-drop-out", 20.0, 3),
        ("vh-frozen", 1.0, 8),
        ("vh-frozen", 20.0, 3),
        ("uart-cut", 20.0, 3),
    ] {
        let mut scenario = crate::mission::support::fault_scenario(name);
        scenario.written.mechanics.backlash_um = play_um;
        let flown = flown(&scenario, seed);
        let errors = Judgement::of(&scenario, &flown).errors;
        let (mut standing, mut turned) = (0, 0);
        for (frame, errors) in flown.frames.iter().zip(&errors) {
            let (Outcome::Exposed(exposed), Some(errors)) = (&frame.record.outcome, errors) else {
                continue;
            };
            if exposed.interior.motion.travel_mm.abs() < 1e-4 {
                standing += 1;
                let common_um = 1e3 * exposed.principal_point_sigma.common_mm;
                turned += u32::from((0.06..0.3).contains(&common_um));
            }
            let ratio = errors.pp_error_px / errors.sigma_px;
            assert!(
                ratio.abs() <= 3.0,
                "{name}, seed {seed}, trigger {}: {ratio} σ",
                frame.record.sequence
            );
        }
        assert!(standing > 0, "{name}");
        let turns_round = [8, 12].contains(&seed);
        assert!(!turns_round || turned > 5, "{name}, seed {seed}: {turned}");
    }
}
