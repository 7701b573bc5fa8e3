//! Findings of the aircraft's instruments: each is in the next record, and counted.

use fmc_camera::flight::attitude::AttitudeFinding;
use fmc_camera::flight::event::{AttitudeSample, Command, Event};
use fmc_camera::flight::findings::Findings;
use fmc_camera::flight::frame_record::{Flag, FrameRecord, Outcome};
use fmc_camera::flight::vh::{CONSISTENT_SAMPLES, VhSample};

use crate::controller::bench::Bench;

const LEVEL: AttitudeSample = AttitudeSample {
    pitch_deg: 0.0,
    roll_deg: 0.0,
    drift_deg: 0.0,
    rates_deg_s: [0.0; 3],
};

/// UTC of a pulse, µs since 1970.
const SECOND_US: u64 = 1_800_000_000_000_000;

fn vh(bench: &mut Bench, samples: &[VhSample]) {
    for sample in samples {
        bench.send(Event::Vh(*sample));
        bench.run(1);
    }
}

/// Sends pulses a second apart, each named by a time that may be off, s.
fn pulses(bench: &mut Bench, off_s: &[u64]) {
    for (second, off_s) in (0_u64..).zip(off_s) {
        bench.send(Event::TimePulse);
        bench.run(300);
        let named_us = SECOND_US + 1_000_000 * (second + off_s) + 100_000;
        bench.send(Event::GnssTime(named_us));
        bench.run(700);
    }
}

/// Makes the finding that a flag stands for.
fn inject(bench: &mut Bench, flag: Flag) {
    let height = VhSample::HeightAboveGround(600.0);
    match flag {
        Flag::VhNotANumber => vh(bench, &[VhSample::GroundSpeed(f32::NAN)]),
        Flag::VhOutOfRange => vh(bench, &[VhSample::GroundSpeed(400.0)]),
        Flag::VhWrongSign => vh(bench, &[VhSample::GroundSpeed(-60.0)]),
        Flag::VhFeet => vh(
            bench,
            &[
                VhSample::GroundSpeed(60.0),
                height,
                VhSample::HeightAboveGround(600.0 / 0.3048),
            ],
        ),
        Flag::VhKnots => vh(
            bench,
            &[
                VhSample::GroundSpeed(60.0),
                VhSample::GroundSpeed(60.0 * 3600.0 / 1852.0),
            ],
        ),
        Flag::VhJump => vh(
            bench,
            &[
                VhSample::InertialSpeed(60.0),
                VhSample::InertialSpeed(100.0),
            ],
        ),
        Flag::VhFrozen => {
            for _ in 0..52 {
                vh(bench, &[height]);
                bench.run(99);
            }
        }
        Flag::VhFromThePast => {
            vh(bench, &[height]);
            bench.send_at(bench.now.plus_s(-0.005), Event::Vh(height));
        }
        Flag::VhDisagreement => vh(
            bench,
            &[VhSample::GroundSpeed(60.0), VhSample::InertialSpeed(66.0)],
        ),
        Flag::VhUnconfirmed => {
            bench.vh_per_s = Some(0.15);
            bench.run(u32::from(CONSISTENT_SAMPLES) + 1);
        }
        Flag::UtcMissingPulses => {
            pulses(bench, &[0]);
            bench.run(2000);
            bench.send(Event::TimePulse);
        }
        Flag::UtcExtraPulse => {
            bench.send(Event::TimePulse);
            bench.run(400);
            bench.send(Event::TimePulse);
        }
        Flag::UtcPulsesMoved => {
            pulses(bench, &[0]);
            bench.run(400);
            pulses(bench, &[0, 0, 0]);
        }
        Flag::UtcWrongSecond => pulses(bench, &[0, 0, 0, 1]),
        Flag::UtcStepped => pulses(bench, &[0, 0, 0, 1, 1, 1]),
        Flag::UtcFromThePast => {
            bench.send(Event::TimePulse);
            bench.send_at(bench.now.plus_s(-0.005), Event::TimePulse);
        }
        Flag::UtcNoPulse => bench.send(Event::GnssTime(SECOND_US)),
        Flag::AttitudeNotANumber => bench.send(Event::Attitude(AttitudeSample {
            roll_deg: f32::NAN,
            ..LEVEL
        })),
        Flag::AttitudeOutOfRange => bench.send(Event::Attitude(AttitudeSample {
            rates_deg_s: [0.0, -61.0, 0.0],
            ..LEVEL
        })),
        Flag::AttitudeSilent => {
            bench.send(Event::Attitude(LEVEL));
            bench.run(1000);
        }
        other => panic!("{} tells of no instrument", other.name()),
    }
}

fn of_instruments() -> impl Iterator<Item = Flag> {
    Flag::ALL.into_iter().filter(|it| it.is_of_instrument())
}

fn count(bench: &Bench, flag: Flag) -> u32 {
    bench.camera.controller().findings().of(flag).unwrap()
}

fn next_record(bench: &mut Bench) -> FrameRecord {
    bench.send(Event::Trigger);
    bench.run(100);
    *bench.records().last().unwrap()
}

#[test]
fn every_finding_is_in_the_next_record_and_counted() {
    assert_eq!(of_instruments().count(), 20);
    for flag in of_instruments() {
        let mut bench = Bench::armed();
        let before = next_record(&mut bench);
        assert!(!before.flags.contains(flag), "{}", flag.name());
        assert_eq!(count(&bench, flag), 0);
        inject(&mut bench, flag);
        let record = next_record(&mut bench);
        assert!(matches!(record.outcome, Outcome::Exposed(_)));
        let found: Vec<_> = record.flags.iter().map(Flag::name).collect();
        assert!(record.flags.contains(flag), "{}: {found:?}", flag.name());
        assert!(count(&bench, flag) > 0, "{}", flag.name());
    }
}

#[test]
fn nothing_is_found_where_nothing_is_wrong() {
    let mut bench = Bench::armed();
    pulses(&mut bench, &[0, 0, 0]);
    vh(
        &mut bench,
        &[
            VhSample::GroundSpeed(60.0),
            VhSample::HeightAboveGround(600.0),
        ],
    );
    bench.send(Event::Attitude(LEVEL));
    let record = next_record(&mut bench);
    let found: Vec<_> = record.flags.iter().map(Flag::name).collect();
    assert_eq!(found, ["with attitude"]);
    assert_eq!(*bench.camera.controller().findings(), Findings::NONE);
}

#[test]
fn counters_and_flags_of_instruments_are_the_same_ones() {
    let counted = Findings::default();
    let counted: Vec<_> = counted.iter().map(|(flag, _)| flag).collect();
    assert_eq!(counted, of_instruments().collect::<Vec<_>>());
}

#[test]
fn what_holds_is_in_every_record_and_what_has_passed_in_one() {
    let mut bench = Bench::armed();
    let good = VhSample::GroundSpeed(60.0);
    let has = |bench: &mut Bench, flag| next_record(bench).flags.contains(flag);
    // The flag holds as long as this is the last sample of its source.
    vh(&mut bench, &[VhSample::GroundSpeed(f32::NAN)]);
    for _ in 0..3 {
        assert!(has(&mut bench, Flag::VhNotANumber));
    }
    // The finding held until now, and from here on no more.
    vh(&mut bench, &[good]);
    assert!(has(&mut bench, Flag::VhNotANumber));
    assert!(!has(&mut bench, Flag::VhNotANumber));
    assert_eq!(count(&bench, Flag::VhNotANumber), 1);
    // The finding comes and goes between two frames.
    vh(&mut bench, &[VhSample::GroundSpeed(f32::NAN), good]);
    assert!(has(&mut bench, Flag::VhNotANumber));
    assert!(!has(&mut bench, Flag::VhNotANumber));
    // Two sources disagree.
    vh(&mut bench, &[good, VhSample::InertialSpeed(66.0), good]);
    for _ in 0..3 {
        assert!(has(&mut bench, Flag::VhDisagreement));
    }
    assert_eq!(count(&bench, Flag::VhDisagreement), 1);
}

#[test]
fn finding_of_an_exposure_is_in_its_own_record_and_of_a_refusal_in_the_next() {
    let mut bench = Bench::armed();
    bench.send(Event::Trigger);
    bench.run(5);
    // The finding comes while the frame before is not finished.
    bench.send(Event::Trigger);
    vh(&mut bench, &[VhSample::GroundSpeed(400.0)]);
    bench.run(100);
    let [exposed, refused] = bench.records()[..] else {
        panic!("{:?}", bench.records());
    };
    assert!(exposed.flags.contains(Flag::VhOutOfRange));
    assert!(matches!(refused.outcome, Outcome::Refused(_)));
    assert!(!refused.flags.contains(Flag::VhOutOfRange));
}

#[test]
fn last_finding_is_told_with_its_age() {
    let mut bench = Bench::armed();
    let last = |bench: &Bench| bench.camera.controller().last_finding();
    assert_eq!(last(&bench), None);
    for flag in [Flag::VhOutOfRange, Flag::UtcNoPulse, Flag::VhNotANumber] {
        inject(&mut bench, flag);
        bench.run(400);
        let found = last(&bench).unwrap();
        assert_eq!(found.flag, flag);
        assert!((found.age_s - 0.4).abs() < 0.003, "{found:?}");
        // Good samples leave it.
        vh(&mut bench, &[VhSample::GroundSpeed(60.0)]);
        assert_eq!(last(&bench).map(|found| found.flag), Some(flag));
    }
}

#[test]
fn missing_pulses_are_counted_one_by_one() {
    let mut bench = Bench::armed();
    inject(&mut bench, Flag::UtcMissingPulses);
    assert_eq!(count(&bench, Flag::UtcMissingPulses), 2);
}

#[test]
fn pulses_that_have_moved_are_in_every_record_until_the_operator_trusts_them() {
    let mut bench = Bench::armed();
    pulses(&mut bench, &[0; 4]);
    bench.run(10);
    pulses(&mut bench, &[4; 4]);
    assert_eq!(count(&bench, Flag::UtcPulsesMoved), 1);
    for _ in 0..3 {
        assert!(next_record(&mut bench).flags.contains(Flag::UtcPulsesMoved));
    }
    assert_eq!(count(&bench, Flag::UtcPulsesMoved), 1);
    bench.send(Event::Command(Command::ClearFault));
    // Between the last record and the command they were not trusted.
    let flagged = [(); 3].map(|()| next_record(&mut bench).flags.contains(Flag::UtcPulsesMoved));
    assert_eq!(flagged, [true, false, false]);
}

#[test]
fn rates_that_change_from_attitude_to_attitude_add_to_the_smear() {
    let smear_um = |rate_deg_s: f32| {
        let mut bench = Bench::armed();
        for number in 0..32 {
            let sign = if number % 2 == 0 { 1.0 } else { -1.0 };
            bench.send(Event::Attitude(AttitudeSample {
                rates_deg_s: [0.0, 0.0, sign * rate_deg_s],
                ..LEVEL
            }));
            bench.run(1);
        }
        bench.send(Event::Attitude(LEVEL));
        let record = next_record(&mut bench);
        assert!(record.flags.contains(Flag::WithAttitude));
        let Outcome::Exposed(frame) = record.outcome else {
            panic!("{record:?}");
        };
        frame.smear_um
    };
    let [still, calm, rough] = [0.0, 0.05, 0.5].map(smear_um);
    // 1 °/s of change, 100 mm and 1/300 s: 5.8 µm, and more in the corners.
    assert!(still < calm && calm < rough, "{still}, {calm}, {rough} µm");
    assert!(rough - still > 5.8, "{still}, {rough} µm");
}

#[test]
fn attitudes_that_are_silent_have_the_flag_of_that_name() {
    let flag = Flag::of_attitude(AttitudeFinding::Silent);
    assert_eq!(flag, Flag::AttitudeSilent);
}
