//! Sequences that gave wrong records.

use super::*;

#[test]
fn attitude_that_cannot_be_used_is_not_in_the_smear() {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run(15);
    bench.send(Event::Attitude(AttitudeSample {
        pitch_deg: f32::NAN,
        roll_deg: 0.0,
        drift_deg: 0.0,
        rates_deg_s: [0.0; 3],
    }));
    bench.run(100);
    assert!(!bench.records()[0].flags.contains(Flag::WithAttitude));
}

#[test]
fn attitude_that_cannot_be_used_does_not_displace_the_last_good_one() {
    // It displaced the good one, and neither that nor σ of an unknown attitude was in the smear.
    let smear_um = |pitch_deg: &[f32]| {
        let mut bench = Bench::armed();
        bench.send(Event::Trigger);
        bench.run(15);
        for pitch_deg in pitch_deg {
            bench.send(Event::Attitude(AttitudeSample {
                pitch_deg: *pitch_deg,
                roll_deg: 5.0,
                drift_deg: 0.0,
                rates_deg_s: [0.0, 2.0, 0.0],
            }));
        }
        bench.run(100);
        exposed(&bench.records()[0]).smear_um
    };
    let good_um = smear_um(&[3.0]);
    assert!(good_um > 2.0 * smear_um(&[]), "{good_um} µm");
    for bad_deg in [f32::NAN, f32::INFINITY, 91.0] {
        assert!((smear_um(&[3.0, bad_deg]) - good_um).abs() < 1e-3);
    }
}

#[test]
fn motion_that_was_measured_before_the_clock_jumped_is_recorded() {
    // The record had `planned motion` beside the measured one.
    let mut bench = exposing_for(1.0 / 300.0);
    while !bench.edges.is_empty() {
        bench.round();
    }
    assert_eq!(bench.camera.controller().state(), State::Exposing);
    bench.edges.clear();
    bench.now = Time::from_us(3_600_000_000);
    bench.run(5);
    let record = bench.records()[0];
    assert!(record.faults.contains(Fault::Clock));
    // There is no index mark: counts may have been lost.
    assert!(record.flags.iter().eq([Flag::Unreferenced]));
    assert!(exposed(&record).principal_point_sigma.frame_mm < 1e-3);
}

#[test]
fn utc_of_a_shutter_that_may_have_stayed_open_is_as_uncertain() {
    // The centroid was that of the planned exposure, with the σ of a pulse.
    let mut bench = Bench::armed();
    for second in 0..4 {
        bench.send(Event::TimePulse);
        bench.run(100);
        bench.send(Event::GnssTime(1_800_000_000_000_000 + 1_000_000 * second));
        bench.run(900);
    }
    for (lost, least_s, most_s) in [(false, 0.0, 1e-5), (true, 0.025, 0.03)] {
        bench.send(Event::Trigger);
        bench.run_until(200, |it| it == State::Exposing);
        if lost {
            bench.edges.clear();
        }
        bench.run(100);
        let record = *bench.records().last().unwrap();
        assert_eq!(record.flags.contains(Flag::LastLightAssumed), lost);
        let sigma_s = exposed(&record).centroid_utc.unwrap().sigma_s;
        // Half of 1 ms of tolerance, 50 ms and two rounds.
        assert!((least_s..most_s).contains(&sigma_s), "{sigma_s} s");
    }
}

#[test]
fn shutter_that_opens_before_its_command_is_not_opened_again() {
    // The command waits at the board for another 1.7 ms; it was not withdrawn.
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run_until(100, |it| it == State::Tracking);
    bench.edges.clear();
    bench.send(Event::Shutter(ShutterEdge::Opened));
    bench.round();
    assert_eq!(closes(&bench), 1, "{:?}", bench.actions);
}

#[test]
fn exposure_cut_by_a_clock_jump_is_not_measured() {
    // As `clock_that_jumps_ends_the_frame_and_is_a_fault`, one round later: the last light is
    // assumed; the path up to it counted as "continued", with a σ of 30 nm.
    let mut bench = exposing_for(1.0 / 300.0);
    bench.run(1);
    bench.edges.clear();
    bench.now = Time::from_us(3_600_000_000);
    bench.run(5);
    let record = bench.records()[0];
    assert!(
        record.flags.contains(Flag::StaticCorrection),
        "σ {} mm, flags {:?}",
        exposed(&record).principal_point_sigma.total_mm(),
        record.flags.iter().collect::<Vec<_>>()
    );
}

#[test]
fn round_before_the_one_before_is_a_jump_of_the_clock() {
    // Stamps of interrupts may be 10 ms old, but rounds come in order.
    let mut bench = Bench::armed();
    bench.now = bench.now.plus_s(-0.006);
    bench.round();
    assert_eq!(
        bench.camera.controller().state(),
        State::Fault(Fault::Clock)
    );
}

#[test]
fn attitude_of_a_camera_flown_backwards_is_about_its_own_axes() {
    // Rates are about the camera's axes, and the camera is not turned: in flight against the axis
    // they act in the opposite direction.
    let smear_px = |direction, pitch_rate_deg_s| {
        let mut bench = Bench::new(FlightSettings {
            direction,
            ..FlightSettings::default()
        });
        bench.arm();
        bench.send(Event::Drive(Fault::Drive));
        bench.run_until(200, |it| it == State::Degraded(Fault::Drive));
        bench.send(Event::Attitude(AttitudeSample {
            pitch_deg: 0.0,
            roll_deg: 0.0,
            drift_deg: 0.0,
            rates_deg_s: [pitch_rate_deg_s, 0.0, 0.0],
        }));
        bench.send(Event::Trigger);
        bench.run(100);
        exposed(&bench.records()[0]).smear_px
    };
    let ahead = [1.0, -1.0].map(|rate| smear_px(FlightDirection::Forward, rate));
    let back = [1.0, -1.0].map(|rate| smear_px(FlightDirection::Reverse, rate));
    assert!((ahead[0] - ahead[1]).abs() > 1.0);
    assert!(
        (back[0] - ahead[1]).abs() < 0.01 && (back[1] - ahead[0]).abs() < 0.01,
        "ahead {ahead:?} px, back {back:?} px"
    );
}

#[cfg(feature = "link")]
mod link {
    use super::*;
    use fmc_camera::io::link::deck::{FlightDeck, RigDeck};

    #[test]
    fn watchdog_is_not_forgotten_by_preparing_twice() {
        // `RigDeck::prepare` passed its start to the first controller only; the second did not know
        // of it, and neither did any record.
        let mut deck = RigDeck::new(Start::AfterWatchdog);
        deck.load(identified(&camera()));
        deck.prepare(&FlightSettings::default()).unwrap();
        deck.prepare(&FlightSettings::default()).unwrap();
        assert_eq!(
            deck.controller().unwrap().state(),
            State::Fault(Fault::Watchdog)
        );
    }
}
