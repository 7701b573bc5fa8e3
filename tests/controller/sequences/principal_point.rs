//! Sequences that gave wrong principal points without flag or fault.

use super::*;

#[test]
fn glitch_of_a_stage_without_force_is_no_motion() {
    // Readings of a stage without force were not checked: one wrong reading entered the centroid.
    let mut bench = stalled();
    let place_mm = bench.stage.offset_mm;
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Exposing);
    bench.run(5);
    round(&mut bench, 1e-3, Some(0.5));
    bench.run(60);
    let record = bench.records()[1];
    let off_mm = exposed(&record).interior.motion.centroid_mm - place_mm;
    assert!(
        off_mm.abs() < 1e-3 || record.flags.contains(Flag::EncoderGlitch),
        "{off_mm} mm off, flags {:?}",
        record.flags.iter().collect::<Vec<_>>()
    );
}

#[test]
fn closing_edge_never_seen_is_not_a_measured_centroid() {
    // The shutter closed in time, but its edge was lost: the centroid was that of 54 ms, with a σ
    // of 30 nm. `ShutterLong` with a closing edge that was seen looks the same.
    let mut bench = exposing_for(1.0 / 300.0);
    bench.edges.clear();
    bench.run(100);
    let record = bench.records()[0];
    let frame = exposed(&record);
    // The planned and true centroid is 0.
    let off_mm = frame.interior.motion.centroid_mm;
    assert!(
        off_mm.abs() <= 3.0 * frame.principal_point_sigma.total_mm()
            || record.flags.contains(Flag::StaticCorrection)
            || record.flags.contains(Flag::ExtrapolatedMotion),
        "{off_mm} mm off, σ {} mm, flags {:?}",
        frame.principal_point_sigma.total_mm(),
        record.flags.iter().collect::<Vec<_>>()
    );
}

#[test]
fn lost_place_is_not_found_again_by_clearing_it() {
    // The count was 0.5 mm off and the fault was cleared without a reference; frames counted as
    // measured again.
    let mut bench = Bench::armed();
    for _ in 0..3 {
        round(&mut bench, 1e-3, Some(0.5));
    }
    bench.run_until(200, |it| it == State::Degraded(Fault::Encoder));
    bench.send(Event::Command(Command::ClearFault));
    // From here on the stage follows the wrong count: reading = set point = true place + 0.5 mm.
    bench.run(2);
    bench.send(Event::Command(Command::Arm));
    bench.run(1500);
    for _ in 0..2 {
        bench.send(Event::Trigger);
        bench.run(200);
    }
    let record = bench.records()[1];
    assert!(!is_unflagged(&record), "0.5 mm off: {record:?}");
}

#[test]
fn gap_in_the_readings_is_flagged() {
    // `is_covered` checked only the ends: 12 of 20 ms were interpolated as if they had been
    // measured.
    let mut bench = exposing_for(0.02);
    bench.run(3);
    bench.is_read = false;
    bench.run(12);
    bench.is_read = true;
    bench.run(60);
    let record = bench.records()[0];
    assert!(!is_unflagged(&record), "{record:?}");
}

#[test]
fn readings_that_are_not_kept_do_not_narrow_sigma() {
    // A reading of every millisecond was counted; the track keeps 64 at most.
    let mut parameters = camera();
    parameters.limits.exposure_s = [0.001, 1.0];
    parameters.limits.vh_per_s = [0.01, 0.02];
    let mut settings = FlightSettings {
        exposure_s: 1.0,
        ..FlightSettings::default()
    };
    settings.drive.encoder_step_um = 2.0;
    let mut bench = Bench::with(&parameters, settings, Start::Orderly);
    bench.vh_per_s = Some(0.01);
    bench.arm();
    bench.send(Event::Trigger);
    bench.run(1300);
    let record = bench.records()[0];
    assert!(!record.flags.contains(Flag::ExtrapolatedMotion));
    let step_mm = 0.002;
    let frame_mm = exposed(&record).principal_point_sigma.frame_mm;
    let readings = step_mm * step_mm / (12.0 * frame_mm * frame_mm);
    assert!((30.0..=66.0).contains(&readings), "{readings} readings");
}

#[test]
fn wobble_in_the_exposure_is_smear() {
    // 9 µm away from the set point and back: the travel is right, so that the smear was given as
    // 0.1 px; it is 1 px.
    let mut bench = exposing_for(0.02);
    for tick in 1..=18_u8 {
        let off_um = 0.9 * f32::from(if tick < 10 { tick } else { 18 - tick });
        round(&mut bench, 1e-3, Some(1e-3 * off_um));
    }
    bench.run(60);
    let record = bench.records()[0];
    let smear_px = exposed(&record).smear_px;
    assert!(
        record.flags.contains(Flag::SmearOverBudget) || smear_px > 0.8,
        "smear {smear_px} px, faults {:?}",
        record.faults.iter().collect::<Vec<_>>()
    );
}

#[test]
fn reading_from_the_future_does_not_end_all_measuring() {
    // The time of a reading was not checked: all later readings counted as "not later" for 10 s and
    // were left out of the path, which then was the straight line to that reading.
    let mut bench = Bench::armed();
    let reading = StageReading {
        time: bench.now.plus_s(10.0),
        offset_mm: bench.place_mm(),
    };
    bench.send(Event::Stage(reading));
    bench.run(10);
    bench.send(Event::Trigger);
    bench.run(100);
    let record = bench.records()[0];
    let centroid_mm = exposed(&record).interior.motion.centroid_mm;
    assert!(
        centroid_mm.abs() < 1e-3
            || record.flags.contains(Flag::PlannedMotion)
            || record.faults.contains(Fault::Encoder),
        "{centroid_mm} mm, flags {:?} faults {:?}",
        record.flags.iter().collect::<Vec<_>>(),
        record.faults.iter().collect::<Vec<_>>()
    );
}
