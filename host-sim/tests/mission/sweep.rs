//! Faults at many places of the cycle and in many sizes: none leads to a silent wrong coordinate.

use fmc_camera::flight::frame_record::Flag;
use fmc_simulation::mechanics::EncoderSide;
use fmc_simulation::mission::expectation::Expectation;
use fmc_simulation::mission::fault::{InjectedFault, Injection};
use fmc_simulation::mission::file::{ReceiverFormat, VhSourceName, VhTable};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::planned_fault::PlannedFault;
use fmc_simulation::mission::scenario::MissionScenario;

use crate::mission::support::flown;

/// Trigger of the third frame, s.
const TRIGGER_S: f64 = 3.8;

/// Returns a short mission with a fault near its third frame.
pub(crate) fn with(injection: Injection) -> MissionScenario {
    let mut scenario = MissionScenario::nominal(Some(5)).unwrap();
    // The receiver has named its seconds before the first frame.
    scenario.written.flight.first_trigger_s = TRIGGER_S - 0.8;
    scenario.interval_s = 0.4;
    scenario.faults = vec![PlannedFault {
        injection,
        expectation: Expectation::default(),
    }];
    scenario
}

fn onsets_ms(from: i32, to: i32, step: usize) -> impl Iterator<Item = f64> + Clone {
    (from..to)
        .step_by(step)
        .map(|ms| TRIGGER_S + 1e-3 * f64::from(ms))
}

/// Returns the failed findings of a flight, and its silent errors.
fn complaints(scenario: &MissionScenario, flown: &Flown) -> Vec<String> {
    let judgement = Judgement::of(scenario, flown);
    let failed = judgement.checks.iter().filter(|check| !check.passed);
    let mut complaints: Vec<String> = failed
        .map(|check| format!("{}: {}", check.what, check.found))
        .collect();
    for (frame, errors) in flown.frames.iter().zip(&judgement.errors) {
        let Some(errors) = errors else {
            continue;
        };
        let number = frame.record.sequence;
        let flags: Vec<&str> = frame.record.flags.iter().map(Flag::name).collect();
        let faults: Vec<String> = frame
            .record
            .faults
            .iter()
            .map(|fault| fault.to_string())
            .collect();
        // With or without a fault, the record's own σ must cover an error of more than a tenth of a
        // pixel.
        let sigma_px = errors.sigma_px;
        if errors.pp_error_px.abs() > f64::max(0.1, 3.0 * sigma_px) {
            complaints.push(format!(
                "frame {number}: principal point off by {:.3} px, σ {sigma_px:.4} px, {flags:?} {faults:?}",
                errors.pp_error_px
            ));
        }
        let excess_px = errors.smear_px - errors.predicted_px;
        if excess_px > 0.25 {
            complaints.push(format!(
                "frame {number}: smear {:.3} px, predicted {:.3} px, {flags:?} {faults:?}",
                errors.smear_px, errors.predicted_px
            ));
        }
    }
    let half_stroke_mm = 0.5 * scenario.camera.fmc.stroke_mm;
    if flown.farthest_mm > half_stroke_mm {
        complaints.push(format!("stage at {:.3} mm", flown.farthest_mm));
    }
    if !flown.unrecorded.is_empty() {
        complaints.push(format!(
            "{} exposures without a record",
            flown.unrecorded.len()
        ));
    }
    complaints
}

/// Returns the same mission with the encoder on the stage, so that play does not hide errors from
/// the camera.
fn on_the_stage(injection: Injection) -> MissionScenario {
    let mut scenario = with(injection);
    scenario.written.mechanics.encoder_side = EncoderSide::Stage;
    scenario
}

/// Flies each injection; `allowed` are complaints that belong to the fault.
fn sweep(injections: impl Iterator<Item = Injection>, allowed: &[&str]) {
    sweep_of(injections.map(with), allowed);
}

fn sweep_of(scenarios: impl Iterator<Item = MissionScenario>, allowed: &[&str]) {
    let mut flights = 0;
    let mut complained: Vec<String> = Vec::new();
    for scenario in scenarios {
        flights += 1;
        let flown = flown(&scenario, 3);
        let mut found = complaints(&scenario, &flown);
        found.retain(|one| !allowed.iter().any(|allowed| one.contains(allowed)));
        if !found.is_empty() {
            let injection = &scenario.faults[0].injection;
            complained.push(format!(
                "{} of {} at {:.4} s for {} s: {found:?}",
                injection.fault, injection.size, injection.onset_s, injection.duration_s
            ));
        }
    }
    assert!(
        complained.is_empty(),
        "{} of {flights} flights:\n{}",
        complained.len(),
        complained.join("\n")
    );
}

/// Returns every onset with every size and duration.
fn grid(
    fault: InjectedFault,
    onsets_s: impl Iterator<Item = f64>,
    sizes: &'static [f64],
    durations_s: &'static [f64],
) -> impl Iterator<Item = Injection> {
    onsets_s.flat_map(move |onset_s| {
        sizes.iter().flat_map(move |size| {
            durations_s.iter().map(move |duration_s| {
                Injection::new(fault, onset_s)
                    .of_size(*size)
                    .lasting(*duration_s)
            })
        })
    })
}

#[test]
fn encoder_glitch_anywhere_in_the_cycle_moves_no_coordinate_silently() {
    let sizes = &[-300.0, 30.0, 300.0, 2000.0];
    let glitches = grid(
        InjectedFault::EncoderGlitch,
        onsets_ms(-3, 90, 4),
        sizes,
        &[0.001],
    );
    sweep(glitches, &[]);
}

#[test]
fn jam_anywhere_in_the_cycle_moves_no_coordinate_silently() {
    let jams = grid(
        InjectedFault::Stall,
        onsets_ms(-3, 90, 4),
        &[1.0, 3.0, 50.0],
        &[0.002, 0.05],
    );
    sweep_of(jams.map(on_the_stage), &[]);
}

#[test]
fn swapped_wires_anywhere_in_the_cycle_move_no_coordinate_silently() {
    let swaps = grid(
        InjectedFault::SignError,
        onsets_ms(-3, 90, 4),
        &[1.0, 2.0],
        &[0.01, f64::INFINITY],
    );
    sweep_of(swaps.map(on_the_stage), &[]);
}

#[test]
fn stuck_bridge_anywhere_in_the_cycle_moves_no_coordinate_silently() {
    // A stage that obeys no command may run into its end stop.
    let stuck = grid(
        InjectedFault::Runaway,
        onsets_ms(-3, 90, 6),
        &[-1.0, -0.2, 0.2, 1.0],
        &[0.004, 0.02],
    );
    sweep_of(stuck.map(on_the_stage), &["stage at"]);
}

#[test]
fn limit_switch_anywhere_in_the_cycle_moves_no_coordinate_silently() {
    let switches = grid(
        InjectedFault::LimitSwitch,
        onsets_ms(-3, 90, 3),
        &[1.0],
        &[0.002, 0.1],
    );
    sweep_of(switches.map(on_the_stage), &[]);
}

#[test]
fn late_shutter_moves_no_coordinate_silently() {
    let late = grid(
        InjectedFault::ShutterLate,
        onsets_ms(-3, 1, 1).take(1),
        &[
            0.1, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0, 20.0, 50.0, 100.0,
        ],
        &[0.2],
    );
    sweep(late, &[]);
}

#[test]
fn shutter_that_misses_an_opening_or_an_edge_moves_no_coordinate_silently() {
    // An exposure whose first light is not seen has no record: the trigger is refused.
    let missing = grid(
        InjectedFault::ShutterMissing,
        onsets_ms(-3, 60, 4),
        &[0.0, 1.0, 2.0],
        &[0.05, 0.4],
    );
    sweep(missing, &["exposures without a record"]);
}

#[test]
fn bouncing_sensor_moves_no_coordinate_silently() {
    let bounces = grid(
        InjectedFault::ShutterDouble,
        onsets_ms(-3, 1, 1).take(1),
        &[
            0.01, 0.1, 0.5, 1.0, 2.0, 3.0, 3.3, 3.4, 4.0, 5.0, 8.0, 12.0, 20.0, 50.0,
        ],
        &[0.2],
    );
    sweep(bounces, &[]);
}

#[test]
fn trigger_at_any_time_after_another_moves_no_coordinate_silently() {
    let onsets = std::iter::once(TRIGGER_S - 0.01);
    let soon = grid(
        InjectedFault::TriggerOverlap,
        onsets,
        &[
            0.001, 0.5, 1.0, 2.0, 5.0, 8.0, 10.0, 12.0, 15.0, 18.0, 20.0, 23.0, 26.0, 29.0, 32.0,
            36.0, 40.0, 45.0, 50.0, 60.0, 70.0, 80.0, 100.0, 150.0, 200.0, 300.0, 360.0, 390.0,
            399.0,
        ],
        &[f64::INFINITY],
    );
    sweep(soon, &[]);
}

/// Returns a mission with a second source of V/H, which takes precedence over the other.
fn with_two_sources(injection: Injection) -> MissionScenario {
    let mut scenario = with(injection);
    let other = scenario.written.vh[0].clone();
    let first = VhTable {
        source: VhSourceName::Direct,
        ..other.clone()
    };
    scenario.written.vh = vec![first, other];
    scenario
}

fn faults_of_vh() -> Vec<Injection> {
    let grids = [
        (InjectedFault::VhDropOut, &[0.3, 1.0][..]),
        (
            InjectedFault::VhJump,
            &[-50.0, -10.0, 3.0, 10.0, 30.0, 100.0, 1000.0],
        ),
        (InjectedFault::VhNan, &[0.3, 1.0]),
        (InjectedFault::VhFrozen, &[0.0, 1.0]),
        (
            InjectedFault::VhWrongUnit,
            &[0.3048, 0.514_444, 1.943_844, 3.280_84],
        ),
        (InjectedFault::VhWrongSign, &[0.3, 1.0]),
    ];
    let durations = &[0.1, 0.45, f64::INFINITY];
    grids
        .into_iter()
        .flat_map(|(fault, sizes)| grid(fault, onsets_ms(-400, 0, 230), sizes, durations))
        .collect()
}

#[test]
fn fault_of_the_only_source_of_vh_moves_no_coordinate_and_smears_no_frame_silently() {
    sweep(faults_of_vh().into_iter(), &[]);
}

#[test]
fn fault_of_one_source_of_vh_beside_another_moves_no_coordinate_and_smears_no_frame_silently() {
    sweep_of(faults_of_vh().into_iter().map(with_two_sources), &[]);
}

#[test]
fn line_cut_anywhere_in_a_sentence_moves_no_coordinate_silently() {
    let scenarios = [0.003, 0.02, 0.3].into_iter().flat_map(|lasting_s| {
        (0..100).step_by(7).map(move |ms| {
            let onset_s = TRIGGER_S - 0.2 + 1e-3 * f64::from(ms);
            let cut = Injection::new(InjectedFault::UartCut, onset_s).of_size(lasting_s);
            let mut scenario = with(cut);
            scenario.written.line.receiver = ReceiverFormat::Nmea;
            scenario.written.line.baud = 9600;
            scenario
        })
    });
    sweep_of(scenarios, &[]);
}
