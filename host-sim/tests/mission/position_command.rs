//! A stage that follows a position command, with an absolute sensor, against its true motion.

use fmc_camera::flight::drive::kind::DriveKind;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::Flag;
use fmc_camera::flight::settings::FlightSettings;
use fmc_simulation::mechanics::{Injection, MechanicalFault, Mechanics};
use fmc_simulation::mission::flight_loop::{FlightOptions, fly};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;
use host_sim::device::{FlyingDevice as _, InProcess};

use crate::mission::support::{folder, passed};

/// Returns the shipped scenario with a number of exposures.
fn scenario(exposures: u32) -> MissionScenario {
    MissionScenario::read(&folder().join("position-command.toml"), Some(exposures)).unwrap()
}

#[test]
fn hysteresis_creep_and_wrong_travel_leave_errors_as_sigma_says() {
    let mut ratios = Vec::new();
    for seed in 1..=3 {
        let scenario = scenario(100);
        let (flown, judgement) = passed(&scenario, seed);
        for (frame, verdict) in flown.frames.iter().zip(&judgement.verdicts) {
            let unreferenced = frame.record.flags.contains(Flag::Unreferenced);
            assert!(!unreferenced, "{:?}", frame.record);
            let stated = verdict.unwrap().principal_point_mm;
            assert!(stated.sigma < 1e-4, "{stated:?}");
            ratios.push(stated.ratio());
        }
    }
    assert_eq!(ratios.len(), 300);
    let squares: f64 = ratios.iter().map(|ratio| ratio * ratio).sum();
    let rms = (squares / 300.0).sqrt();
    // docs/integration.md has 1.0.
    assert!((0.9..1.15).contains(&rms), "{rms}");
}

#[test]
fn without_its_correction_the_stage_falls_behind_its_set_point() {
    // The correction has something to take out in the test above.
    let scenario = scenario(3);
    let mut settings = scenario.flight_settings();
    settings.drive.position_command.correction_rate_per_s = 0.0;
    let (flown, _) = flown_with(&scenario, &settings, &[]);
    let (_, first) = flown.announced[0];
    assert!(matches!(first, Fault::Stall | Fault::Runaway), "{first}");
}

fn flown_with(
    scenario: &MissionScenario,
    settings: &FlightSettings,
    faults: &[Injection],
) -> (Flown, Judgement) {
    let mut device = InProcess::default();
    device
        .prepare(&scenario.camera.parameters(), settings)
        .unwrap();
    let mut mechanics = Mechanics::seeded(scenario.written.mechanics, 1).unwrap();
    for fault in faults {
        mechanics.inject(*fault);
    }
    let options = FlightOptions {
        seed: 1,
        frame: None,
    };
    let flown = fly(scenario, options, mechanics, &mut device, |_| {}).unwrap();
    let judgement = Judgement::of(scenario, &flown);
    (flown, judgement)
}

#[test]
fn sensor_that_sticks_or_saturates_is_a_fault_and_no_record_is_wrong_without_a_word() {
    let scenario = scenario(8);
    // It repeats one word from then on, or is off its scale.
    let stuck = MechanicalFault::EncoderScale { percent: -100.0 };
    let saturated = MechanicalFault::EncoderGlitch { counts: 1_000_000 };
    for (fault, named) in [
        (stuck, &[Fault::Encoder, Fault::Stall][..]),
        (saturated, &[Fault::Encoder]),
    ] {
        // At rest, in the run-up, in the exposure, after it, and in fly-back.
        for from_s in [1.9, 2.01, 2.026, 2.0275, 2.035, 2.06, 3.3] {
            let (flown, judgement) = flown_with(
                &scenario,
                &scenario.flight_settings(),
                &[Injection::from(fault, from_s)],
            );
            let (_, first) = flown.announced[0];
            assert!(named.contains(&first), "{fault:?} at {from_s}: {first}");
            let has_named = flown.announced.iter().any(|(_, it)| *it == Fault::Encoder);
            assert!(has_named, "{fault:?} at {from_s}: {:?}", flown.announced);
            let (mut judged, mut told) = (0, 0);
            for (frame, verdict) in flown.frames.iter().zip(&judgement.verdicts) {
                let Some(verdict) = verdict else { continue };
                let stated = verdict.principal_point_mm;
                judged += 1;
                // The exposure in which a sensor sticks is that of a stage that stands.
                let is_told = frame.record.faults.contains(Fault::Stall);
                assert!(
                    stated.ratio().abs() < 5.0 || is_told,
                    "{fault:?} at {from_s}: {stated:?}, {:?}",
                    frame.record
                );
                told += u32::from(is_told);
            }
            assert!(judged > 4 && told <= 1, "{judged}, {told}");
        }
    }
}

#[test]
fn settings_for_another_kind_of_drive_than_the_scenarios_are_refused_with_both() {
    let path = folder().join("position-command.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let told = |text: &str| {
        MissionScenario::parse("own.toml", text, &folder(), Some(2), None)
            .map(|scenario| scenario.flight_settings().drive.kind)
            .map_err(|error| error.to_string())
    };
    assert_eq!(told(&text), Ok(DriveKind::PositionCommand));
    let motor = format!("{text}\n[settings]\nexposure_s = 0.003333333\n");
    let error = told(&motor).unwrap_err();
    assert!(
        error.contains("position_stage") && error.contains("drive.kind = \"Motor\""),
        "{error}"
    );
    let settings = "[settings.drive]\nkind = \"PositionCommand\"\nencoder_step_um = 0.1\n";
    let taken = told(&format!("{text}\n{settings}"));
    assert_eq!(taken, Ok(DriveKind::PositionCommand));
    let nominal = include_str!("../../scenarios/mission.toml");
    let error = told(&format!("{nominal}\n{settings}")).unwrap_err();
    assert!(
        error.contains("lacks position_stage") && error.contains("PositionCommand"),
        "{error}"
    );
    let wrong = text.replace("resonance_hz = 100.0", "resonance_hz = 1.0");
    let error = told(&wrong).unwrap_err();
    assert!(
        error.contains("position_stage.resonance_hz = 1 is outside 20"),
        "{error}"
    );
}
