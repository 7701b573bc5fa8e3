//! Components of an autopilot's system, its terrain and its clock.

use fmc_camera::flight::event::{AttitudeSample, Event};
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcClock;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::instruments::Instruments;

use super::instruments::*;
use crate::aircraft::targets::{Kind, frame};

const GIMBAL: [u8; 2] = [1, 154];
const AUTOPILOT: [u8; 2] = [1, 1];

fn track(sender: [u8; 2], [north_cm_s, east_cm_s]: [i16; 2]) -> Vec<u8> {
    let mut payload = 1000_u32.to_le_bytes().to_vec();
    for number in [481_234_567, 115_678_901, 1_200_500, 1_000_000_i32] {
        payload.extend(number.to_le_bytes());
    }
    for number in [north_cm_s, east_cm_s, 0, 9000] {
        payload.extend(number.to_le_bytes());
    }
    from(sender, 33, 104, &payload)
}

fn attitude(sender: [u8; 2], roll_rad: f32) -> Vec<u8> {
    let mut payload = 1000_u32.to_le_bytes().to_vec();
    for number in [roll_rad, 0.0, 0.0, 0.01, 0.01, 0.01_f32] {
        payload.extend(number.to_le_bytes());
    }
    from(sender, 30, 39, &payload)
}

fn attitudes(events: &[Event]) -> Vec<AttitudeSample> {
    let attitude = |event: &Event| match event {
        Event::Attitude(sample) => Some(*sample),
        _ => None,
    };
    events.iter().filter_map(attitude).collect()
}

#[test]
fn attitude_of_a_gimbal_is_not_the_aircrafts_whoever_speaks_first() {
    let mut wires = Wires::default();
    let of_gimbal = [track(GIMBAL, [6000, 0]), attitude(GIMBAL, 0.5)].concat();
    let of_autopilot = [track(AUTOPILOT, [6000, 0]), attitude(AUTOPILOT, 0.1)].concat();
    for _ in 0..5 {
        wires.send(&[], &of_gimbal);
        wires.send(&[], &of_autopilot);
        wires.send(&[], &attitude(GIMBAL, 0.5));
    }
    let rolls: Vec<f32> = attitudes(&wires.taken())
        .iter()
        .map(|sample| sample.roll_deg)
        .collect();
    let [gimbal, autopilot] = [0.5_f32, 0.1].map(f32::to_degrees);
    let (first, later) = rolls.split_first().unwrap();
    assert!((first - gimbal).abs() < 1e-4, "alone until then: {rolls:?}");
    assert_eq!(later.len(), 5);
    assert!(later.iter().all(|roll| (roll - autopilot).abs() < 1e-4));
    let counters = wires.instruments.counters().autopilot;
    assert_eq!((counters.system, counters.other_system), (Some(1), 13));
}

#[test]
fn track_and_altitude_of_another_system_change_nothing_of_the_one_in_use() {
    for instruments in [Instruments::new(), Instruments::of_system(1)] {
        let mut wires = Wires {
            instruments,
            ..Wires::default()
        };
        wires.send(&[], &track(AUTOPILOT, [6000, 0]));
        // Flies to the east, and knows its terrain.
        let mut other = track([2, 1], [0, 6000]);
        other.extend(from([2, 1], 141, 47, &altitude(500.0, 400.0, -1.0)));
        wires.send(&[], &other);
        wires.send(&[], &attitude(AUTOPILOT, 0.1));
        wires.send(&[], &track(AUTOPILOT, [6000, 0]));
        let events = wires.taken();
        let drifts: Vec<f32> = attitudes(&events)
            .iter()
            .map(|sample| sample.drift_deg)
            .collect();
        assert_eq!(drifts, [0.0]);
        let altitude = Event::Vh(VhSample::Altitude(1200.5));
        let altitudes = events.iter().filter(|event| **event == altitude);
        assert_eq!(altitudes.count(), 2, "{events:?}");
    }
}

/// Altitude above the sea of the receiver, terrain above the ellipsoid of the autopilot: their
/// difference would be wrong by the geoid's height.
#[test]
fn terrain_of_the_autopilot_is_not_subtracted_from_the_receivers_altitude() {
    let mut wires = Wires::default();
    let pair = from(AUTOPILOT, 141, 47, &altitude(1247.0, 1000.0, f32::NAN));
    wires.send(&[], &pair);
    let of_autopilot = [VhSample::Altitude(1247.0), VhSample::TerrainHeight(247.0)];
    assert_eq!(wires.taken(), of_autopilot.map(Event::Vh));
    wires.send(&altitude_of("GP", 1.0, 1200.0), &[]);
    wires.send(&[], &pair);
    assert_eq!(wires.taken(), [Event::Vh(VhSample::Altitude(1200.0))]);
}

#[test]
fn clock_of_the_autopilot_that_is_ahead_or_late_names_the_right_second() {
    const FIRST_S: u64 = 1_767_225_600;
    for ahead_us in [-700_000, -300_000, -20_000, 0, 15_000, 100_000, 240_000_i64] {
        // At every time of the second.
        for sent_us in (0..1_000_000).step_by(9973) {
            let mut instruments = Instruments::new();
            let mut clock = UtcClock::new(1e-6);
            for second in 0..4 {
                let pulse = Time::from_us(1_000_000 * (second + 1));
                assert_eq!(clock.pulse(pulse), None);
                let unix_us = (1_000_000 * (FIRST_S + second) + sent_us)
                    .checked_add_signed(ahead_us)
                    .unwrap();
                let message = from(AUTOPILOT, 2, 137, &unix_us.to_le_bytes());
                for byte in message {
                    instruments.push(fmc_camera::io::instruments::Wire::Autopilot, byte);
                }
                let came = Time::from_us(pulse.us() + sent_us);
                let mut events = instruments.round(came, 6).to_vec();
                events.extend(instruments.round(came, 6));
                let [(time, Event::GnssTime(unix_us))] = events[..] else {
                    panic!("{events:?}")
                };
                assert_eq!(clock.receiver_time(time, unix_us), None, "{ahead_us}");
            }
            let utc = clock.utc(Time::from_us(4_000_000)).unwrap();
            let expected_us = 1_000_000 * (FIRST_S + 3);
            assert_eq!(utc.unix_us, expected_us, "{ahead_us} µs at {sent_us} µs");
        }
    }
}

/// A cut message of the same wire hides whole ones until as many bytes have come as it claims.
#[test]
fn messages_behind_a_false_beginning_come_in_the_rounds_after_it_without_another_byte() {
    let times = [1_767_225_600_000_000, 1_767_225_601_000_000_u64];
    let mut hidden = Vec::new();
    for unix_us in times {
        let payload = [&unix_us.to_le_bytes()[..], &[0; 4]].concat();
        hidden.extend(frame(Kind::One, 2, 137, &payload));
    }
    // A position that claims all of the hidden bytes for its payload and checksum.
    let length = u8::try_from(hidden.len() - 2).unwrap();
    let false_beginning = [0xfe, length, 0, 1, 1, 33];
    let mut wires = Wires::default();
    wires.send(&[], &[&false_beginning[..], &hidden].concat());
    assert_eq!(wires.taken(), []);
    for unix_us in times {
        wires.round();
        assert_eq!(wires.taken(), [Event::GnssTime(unix_us - 250_000)]);
    }
    wires.round();
    assert_eq!(wires.taken(), []);
    let counters = wires.instruments.counters().autopilot;
    assert_eq!((counters.read, counters.checksum), (2, 1));
    assert_eq!(counters.unexplained_bytes, 6);
}
