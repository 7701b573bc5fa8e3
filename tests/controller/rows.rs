//! Rows of a TDI sensor: their principal point and its σ.

use std::f32::consts::SQRT_2;

use fmc_camera::flight::camera::{CameraParameters, Mechanism};
use fmc_camera::flight::controller::Start;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::controller::timing::STAMP_SIGMA_S;
use fmc_camera::flight::event::{Event, ShutterEdge};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::Flag;
use fmc_camera::flight::settings::FlightSettings;

use crate::controller::bench::{Bench, camera, exposed, only};

/// Speed of the rows, mm/s: 100 mm at 0.1 1/s.
const SPEED_MM_S: f32 = 10.0;

/// Exposure time of the settings, s.
const EXPOSURE_S: f32 = 1.0 / 300.0;

fn armed() -> Bench {
    let camera = CameraParameters {
        mechanism: Mechanism::Tdi {
            first_transfer: 0.5,
        },
        ..camera()
    };
    let mut bench = Bench::with(&camera, FlightSettings::default(), Start::Orderly);
    bench.arm();
    bench.send(Event::Trigger);
    bench
}

#[test]
fn sigma_of_rows_is_that_of_the_stamps_wherever_first_light_falls() {
    // First light starts the clock of the rows.
    for late_s in [-0.0009, 0.0, 0.0004, 0.0009] {
        let mut bench = armed();
        bench.shutter_late_s = late_s;
        bench.run(100);
        let frame = exposed(&only(&bench));
        assert!((frame.interior.motion.centroid_mm - SPEED_MM_S / 600.0).abs() < 1e-3);
        // Both stamps change the time between, at whose end the charge lies four rows on.
        let sigma = frame.principal_point_sigma;
        let off_mm = 4.0 * 0.008_75 - frame.interior.motion.centroid_mm;
        let expected_mm = SQRT_2 * off_mm * STAMP_SIGMA_S / EXPOSURE_S;
        assert!(
            (sigma.frame_mm - expected_mm).abs() < 0.01 * expected_mm,
            "{sigma:?}"
        );
        assert!(sigma.common_mm.abs() < 1e-9);
    }
}

#[test]
fn rows_go_on_as_long_as_the_shutter_may_be_open() {
    let mut bench = armed();
    bench.run_until(100, |state| state == State::Exposing);
    bench.edges.clear();
    bench.run(100);
    let record = only(&bench);
    assert!(record.flags.contains(Flag::LastLightAssumed));
    // 1 ms of tolerance, 50 ms and two rounds: the centroid may lie half as far on.
    let frame_mm = exposed(&record).principal_point_sigma.frame_mm;
    let later_s = frame_mm / (0.5 * SPEED_MM_S);
    assert!((0.051..0.054).contains(&later_s), "{later_s} s");
}

#[test]
fn rows_whose_clock_had_not_been_told_to_start_may_have_stood() {
    let mut bench = armed();
    assert_eq!(bench.camera.controller().state(), State::RunUp);
    bench.send(Event::Shutter(ShutterEdge::Opened));
    bench.run(3);
    bench.send(Event::Shutter(ShutterEdge::Closed));
    bench.run(20);
    let record = only(&bench);
    assert!(record.faults.contains(Fault::ShutterUnexpected));
    assert!(record.flags.contains(Flag::PlannedMotion));
    assert!(record.flags.contains(Flag::StaticCorrection));
    let frame = exposed(&record);
    let (centroid_mm, sigma) = (
        frame.interior.motion.centroid_mm,
        frame.principal_point_sigma,
    );
    assert!(centroid_mm > 0.01 && sigma.frame_mm >= centroid_mm);
    assert!(frame.smear_um > 1e3 * SPEED_MM_S * 0.003);
}
