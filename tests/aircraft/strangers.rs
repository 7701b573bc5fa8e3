//! Other talkers, positions and systems on the wires of receiver and autopilot.

use fmc_camera::flight::event::Event;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::instruments::{ALIVE_US, Instruments};

use super::instruments::*;
use crate::aircraft::targets::sentence;

#[test]
fn second_talker_is_refused_as_long_as_the_first_speaks() {
    let mut wires = Wires::default();
    for _ in 0..10 {
        wires.send(&speed_of("GP", 100.0), &[]);
        wires.send(&speed_of("GN", 60.0), &[]);
        wires.wait_ms(80);
    }
    assert_eq!(wires.taken(), [knots(100.0); 10]);
    let counters = wires.instruments.counters().receiver;
    assert_eq!((counters.read, counters.other_talker), (20, 10));
    assert!(counters.has_two_receivers());
    // The first has fallen silent.
    let until = wires.now_ms + ALIVE_US / 1000;
    while wires.now_ms < until {
        wires.send(&speed_of("GN", 60.0), &[]);
    }
    assert!(!wires.taken().is_empty());
    wires.send(&speed_of("GN", 60.0), &[]);
    assert_eq!(wires.taken(), [knots(60.0)]);
}

#[test]
fn second_position_is_refused_with_the_speeds_that_follow_it() {
    let mut wires = Wires::default();
    for index in 0..10_u8 {
        let minutes = 0.005 * f32::from(index);
        // 9 m per 0.005', and a receiver 18 km away.
        wires.send(&altitude_of("GP", minutes, 1200.0), &[]);
        wires.send(&speed_of("GP", 100.0), &[]);
        wires.send(&altitude_of("GP", minutes + 10.0, 500.0), &[]);
        wires.send(&speed_of("GP", 60.0), &[]);
        wires.wait_ms(50);
    }
    let first = [Event::Vh(VhSample::Altitude(1200.0)), knots(100.0)];
    assert_eq!(wires.taken(), first.repeat(10));
    let counters = wires.instruments.counters().receiver;
    assert_eq!((counters.other_position, counters.other_talker), (20, 0));
    assert!(counters.has_two_receivers());
}

#[test]
fn one_receiver_in_flight_is_one_receiver() {
    let mut wires = Wires::default();
    // 350 m/s to the north, with noise of 5 m, across a gap of 2.5 s.
    let from_ms = wires.now_ms;
    for index in 0..100_u32 {
        wires.wait_ms(if index == 50 { 2500 } else { 20 });
        #[expect(clippy::cast_precision_loss, reason = "seconds")]
        let elapsed_s = (wires.now_ms - from_ms) as f32 / 1000.0;
        let noise_m = if index % 2 == 0 { 5.0 } else { -5.0 };
        wires.send(
            &altitude_of("GP", 1.0 + (350.0 * elapsed_s + noise_m) / 1852.0, 1200.0),
            &[],
        );
    }
    assert_eq!(wires.taken().len(), 100);
    assert!(!wires.instruments.counters().receiver.has_two_receivers());
}

/// A sentence with the position of `altitude_of`, speed and a time of 2026.
fn time_of(talker: &str, minutes: f32, second: u8, knots: f32) -> Vec<u8> {
    let fields =
        format!("1200{second:02},A,48{minutes:07.4},N,01131.0,E,{knots:.1},054.7,010126,,,A");
    sentence(&format!("{talker}RMC"), fields.as_bytes())
}

#[test]
fn receiver_that_changes_its_talker_or_uses_two_stays_one_receiver() {
    let mut wires = Wires::default();
    for second in 0..9_u8 {
        let minutes = 0.05 * f32::from(second);
        // From two constellations on, the talker is another one for each sentence that names all.
        let of_all = if (3..6).contains(&second) { "GN" } else { "GP" };
        wires.send(&time_of(of_all, minutes, second, 100.0), &[]);
        wires.send(&altitude_of("GP", minutes, 1200.0), &[]);
        wires.send(&speed_of(of_all, 100.0), &[]);
        wires.wait_ms(900);
    }
    let taken = wires.taken();
    assert_eq!(taken.len(), 4 * 9, "{taken:?}");
    let counters = wires.instruments.counters().receiver;
    assert!(!counters.has_two_receivers(), "{counters:?}");
}

#[test]
fn talker_of_another_time_or_place_is_another_receiver() {
    let mut wires = Wires::default();
    wires.send(&time_of("GP", 1.0, 10, 100.0), &[]);
    // 13 s late, and 18 km away.
    wires.send(&time_of("GN", 1.0, 23, 60.0), &[]);
    wires.send(&time_of("GN", 11.0, 10, 60.0), &[]);
    wires.send(&speed_of("GN", 60.0), &[]);
    let first = [knots(100.0), Event::GnssTime(1_767_268_810_000_000)];
    assert_eq!(wires.taken(), first);
    let counters = wires.instruments.counters().receiver;
    assert_eq!((counters.read, counters.other_talker), (4, 3));
}

#[test]
fn other_system_is_refused_and_counted() {
    let mut wires = Wires::default();
    for _ in 0..5 {
        wires.send(&[], &[height(7, 800.0), height(9, 300.0)].concat());
    }
    assert_eq!(wires.taken(), [above_ground(800.0); 5]);
    let counters = wires.instruments.counters().autopilot;
    assert_eq!(
        (counters.system, counters.read, counters.other_system),
        (Some(7), 10, 5)
    );
    wires.wait_ms(ALIVE_US / 1000);
    wires.send(&[], &height(9, 300.0));
    assert_eq!(wires.taken(), [above_ground(300.0)]);
    let mut wires = Wires {
        instruments: Instruments::of_system(9),
        ..Wires::default()
    };
    wires.send(&[], &[height(7, 800.0), height(9, 300.0)].concat());
    wires.wait_ms(2 * ALIVE_US / 1000);
    wires.send(&[], &height(7, 800.0));
    assert_eq!(wires.taken(), [above_ground(300.0)]);
    assert_eq!(wires.instruments.counters().autopilot.other_system, 2);
    wires.instruments.clear();
    assert_eq!(wires.instruments.counters().autopilot.system, Some(9));
}

#[test]
fn receiver_counts_before_what_the_autopilot_makes_of_it() {
    let mut wires = Wires::default();
    let alone = [VhSample::GroundSpeed(60.0), VhSample::Altitude(1200.5)].map(Event::Vh);
    wires.send(&[], &position());
    assert_eq!(wires.taken(), alone);
    wires.send(&speed_of("GP", 100.0), &[]);
    wires.send(&[], &position());
    let beside = [VhSample::InertialSpeed(60.0), VhSample::Altitude(1200.5)].map(Event::Vh);
    assert_eq!(wires.taken()[1..], beside);
    wires.send(&altitude_of("GP", 1.0, 1150.0), &position());
    assert!(!wires.taken().is_empty());
    wires.send(&[], &position());
    assert_eq!(wires.taken(), [Event::Vh(VhSample::InertialSpeed(60.0))]);
    wires.wait_ms(ALIVE_US / 1000);
    wires.send(&[], &position());
    assert_eq!(wires.taken(), alone);
}

#[test]
fn time_of_the_autopilot_is_ignored_while_the_receiver_gives_time() {
    let unix_us = 1_767_268_811_000_000_u64;
    let time = from([1, 1], 2, 137, &unix_us.to_le_bytes());
    let of_autopilot = Event::GnssTime(unix_us - 250_000);
    let mut wires = Wires::default();
    wires.send(&[], &time);
    assert_eq!(wires.taken(), [of_autopilot]);
    wires.send(&time_of("GP", 1.0, 10, 100.0), &[]);
    wires.taken();
    wires.send(&[], &time);
    assert_eq!(wires.taken(), []);
    assert_eq!(wires.instruments.counters().autopilot.read, 2);
    wires.wait_ms(ALIVE_US / 1000);
    wires.send(&[], &time);
    assert_eq!(wires.taken(), [of_autopilot]);
}
