//! Messages of an autopilot.

use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::mavlink::{
    ALTITUDE_PREFERRED, MavlinkError, MavlinkReading, MavlinkReceiver, MavlinkSender,
};

use crate::aircraft::targets::{Kind, frame, messages};

const AUTOPILOT: MavlinkSender = MavlinkSender {
    system: 1,
    component: 1,
};

fn answer(bytes: &[u8]) -> Option<Result<MavlinkReading, MavlinkError>> {
    let mut receiver = MavlinkReceiver::new();
    bytes
        .iter()
        .filter_map(|byte| receiver.receive(*byte))
        .last()
}

fn samples(bytes: &[u8]) -> Vec<VhSample> {
    answer(bytes).unwrap().unwrap().samples.to_vec()
}

/// Returns the payload of a position: 36 m/s north and 48 m/s east, 1200.5 m above the sea.
fn position() -> Vec<u8> {
    let mut payload = 1000_u32.to_le_bytes().to_vec();
    for number in [481_234_567, 115_678_901, 1_200_500, 1_000_000_i32] {
        payload.extend(number.to_le_bytes());
    }
    for number in [3600, 4800, 0, 9000_i16] {
        payload.extend(number.to_le_bytes());
    }
    payload
}

/// Returns the payload of a distance in cm, from a sensor for 1 m to 600 m.
fn distance(distance_cm: u16, kind: u8, orientation: u8) -> Vec<u8> {
    let mut payload = 1000_u32.to_le_bytes().to_vec();
    for number in [100, 60_000, distance_cm] {
        payload.extend(number.to_le_bytes());
    }
    payload.extend([kind, 1, orientation, 255]);
    payload
}

/// Returns the payload of altitude, height above terrain and clearance.
fn altitude(amsl: f32, above_terrain: f32, clearance: f32) -> Vec<u8> {
    let mut payload = 1000_u64.to_le_bytes().to_vec();
    for number in [0.0, amsl, 0.0, 0.0, above_terrain, clearance] {
        payload.extend(number.to_le_bytes());
    }
    payload
}

fn position_frame(kind: Kind) -> Vec<u8> {
    frame(kind, 33, 104, &position())
}

fn distance_frame(payload: &[u8]) -> Vec<u8> {
    frame(Kind::Two, 132, 85, payload)
}

fn altitude_frame(payload: &[u8]) -> Vec<u8> {
    frame(Kind::Two, 141, 47, payload)
}

#[test]
fn messages_of_both_versions_are_read() {
    for kind in [Kind::One, Kind::Two, Kind::Signed] {
        let found = samples(&position_frame(kind));
        assert_eq!(
            found,
            [VhSample::GroundSpeed(60.0), VhSample::Altitude(1200.5)]
        );
    }
    let found = samples(&altitude_frame(&altitude(1200.0, 1000.0, f32::NAN)));
    let expected = [VhSample::Altitude(1200.0), VhSample::TerrainHeight(200.0)];
    assert_eq!(found, expected);
    let time_us = 1_767_225_600_000_000_u64.to_le_bytes();
    let time = answer(&frame(Kind::One, 2, 137, &[&time_us[..], &[0; 4]].concat()));
    assert_eq!(time.unwrap().unwrap().unix_us, Some(1_767_225_600_000_000));
}

/// PX4 has started at 100 m, is 600 m above ground at 250 m, and sends 150 m as height above
/// terrain.
#[test]
fn height_above_terrain_that_is_not_above_the_sea_makes_no_terrain() {
    let found = samples(&altitude_frame(&altitude(850.0, 150.0, 600.0)));
    let expected = [
        VhSample::Altitude(850.0),
        VhSample::HeightAboveGround(600.0),
    ];
    assert_eq!(found, expected);
}

#[test]
fn distance_counts_downward_within_its_range_and_with_a_signal() {
    const DOWN: u8 = 25;
    let laser = samples(&distance_frame(&distance(50_000, 0, DOWN)));
    assert_eq!(laser, [VhSample::LaserHeight(500.0)]);
    let radar = samples(&distance_frame(&distance(50_000, 3, DOWN)));
    assert_eq!(radar, [VhSample::HeightAboveGround(500.0)]);
    assert_eq!(
        answer(&distance_frame(&distance(50_000, 0, 0))),
        None,
        "forward"
    );
    for beyond_cm in [0, 99, 60_001, u16::MAX] {
        let found = answer(&distance_frame(&distance(beyond_cm, 0, DOWN)));
        assert_eq!(found, Some(Err(MavlinkError::NoDistance)));
    }
    let mut invalid = distance(50_000, 0, DOWN);
    invalid.extend([0; 24]);
    invalid.push(1);
    let found = answer(&distance_frame(&invalid));
    assert_eq!(found, Some(Err(MavlinkError::NoDistance)));
    let unknown = answer(&distance_frame(&distance(50_000, 99, DOWN)));
    assert_eq!(unknown, Some(Err(MavlinkError::Malformed)));
}

#[test]
fn what_the_autopilot_does_not_know_is_not_read() {
    let unknown = altitude(f32::NAN, f32::NAN, -1.0);
    assert_eq!(answer(&altitude_frame(&unknown)), None);
    let without_terrain = samples(&altitude_frame(&altitude(1200.0, -1001.0, f32::NAN)));
    assert_eq!(without_terrain, [VhSample::Altitude(1200.0)]);
    let infinite = altitude(f32::INFINITY, 0.0, -1.0);
    let found = answer(&altitude_frame(&infinite));
    assert!(matches!(found, Some(Err(MavlinkError::OutOfRange(_)))));
    let mut nowhere = position();
    nowhere[4..12].fill(0);
    let found = answer(&frame(Kind::Two, 33, 104, &nowhere));
    assert_eq!(found, Some(Err(MavlinkError::NoFix)));
    let found = answer(&frame(Kind::Two, 2, 137, &[0]));
    assert_eq!(found, Some(Err(MavlinkError::NoFix)));
}

#[test]
fn altitude_comes_from_the_message_that_has_the_terrain_too() {
    let mut receiver = MavlinkReceiver::new();
    let of_position = |receiver: &mut MavlinkReceiver| {
        messages(receiver, &position_frame(Kind::Two))[0]
            .samples
            .len()
    };
    assert_eq!(of_position(&mut receiver), 2);
    messages(
        &mut receiver,
        &altitude_frame(&altitude(1200.0, 1000.0, -1.0)),
    );
    for _ in 0..ALTITUDE_PREFERRED {
        assert_eq!(of_position(&mut receiver), 1);
    }
    assert_eq!(of_position(&mut receiver), 2);
}

/// Roll 0.1, pitch -0.05 and yaw in rad, rates of 0.01, 0.02 and 0.03 rad/s.
fn attitude(boot_ms: u32, yaw_rad: f32) -> Vec<u8> {
    let mut payload = boot_ms.to_le_bytes().to_vec();
    for number in [0.1, -0.05, yaw_rad, 0.01, 0.02, 0.03_f32] {
        payload.extend(number.to_le_bytes());
    }
    frame(Kind::Two, 30, 39, &payload)
}

#[test]
fn attitude_has_its_drift_from_the_track_of_the_last_second() {
    let mut receiver = MavlinkReceiver::new();
    assert_eq!(messages(&mut receiver, &attitude(1000, 0.9)), []);
    messages(&mut receiver, &position_frame(Kind::Two));
    let read = messages(&mut receiver, &attitude(1500, 0.9));
    let attitude_of = |read: &[MavlinkReading]| read[0].attitude.unwrap();
    let sample = attitude_of(&read);
    // The track is 36 m/s north and 48 m/s east: atan(4/3) = 53.1301°.
    let found = [sample.pitch_deg, sample.roll_deg, sample.drift_deg];
    let degrees = |radians: f32| radians.to_degrees();
    for (found, expected) in
        found
            .into_iter()
            .zip([degrees(-0.05), degrees(0.1), 53.130_1 - degrees(0.9)])
    {
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    }
    // About right, forward and up.
    for (found, expected) in sample.rates_deg_s.into_iter().zip([0.02, 0.01, -0.03]) {
        assert!((found - degrees(expected)).abs() < 1e-5, "{found}");
    }
    let behind = attitude_of(&messages(&mut receiver, &attitude(1500, -2.9)));
    assert!((behind.drift_deg - (53.130_1 + degrees(2.9) - 360.0)).abs() < 1e-4);
    assert_eq!(messages(&mut receiver, &attitude(2001, 0.9)), []);
}

#[test]
fn drift_is_the_shorter_way_round_in_either_direction() {
    // The track is 36 m/s south and 48 m/s west: 53.1301° less than half a turn, to the left.
    let mut payload = position();
    for (place, number) in [(20, -3600_i16), (22, -4800)] {
        payload[place..place + 2].copy_from_slice(&number.to_le_bytes());
    }
    let mut receiver = MavlinkReceiver::new();
    messages(&mut receiver, &frame(Kind::Two, 33, 104, &payload));
    let heading_deg = 150.0_f32;
    let read = messages(&mut receiver, &attitude(1500, heading_deg.to_radians()));
    let drift_deg = read[0].attitude.unwrap().drift_deg;
    // -126.8699° - 150° + 360°.
    assert!((drift_deg - 83.1301).abs() < 1e-4, "{drift_deg}");
}

#[test]
fn reading_names_its_system_and_bytes_of_no_frame_are_counted() {
    let mut receiver = MavlinkReceiver::new();
    let heartbeat = frame(Kind::Two, 0, 50, &[0; 9]);
    let stream = [
        &position_frame(Kind::One)[..],
        &heartbeat,
        &heartbeat,
        &position_frame(Kind::Signed),
    ];
    let read = messages(&mut receiver, &stream.concat());
    assert!(read.iter().all(|reading| reading.sender == AUTOPILOT));
    assert_eq!((read.len(), receiver.take_unexplained()), (2, 0));
    // Another baud rate: bits of half a byte each, taken for bytes.
    let noise: Vec<u8> = stream.concat().iter().map(|byte| byte ^ 0xa6).collect();
    assert_eq!(messages(&mut receiver, &noise), []);
    messages(&mut receiver, &[0; 280]);
    let unexplained = usize::try_from(receiver.take_unexplained()).unwrap();
    assert!(unexplained > noise.len() / 2, "{unexplained}");
}

#[test]
fn damaged_frame_is_not_read_and_the_next_is() {
    let next = altitude_frame(&altitude(1200.0, 1000.0, 990.0));
    let next_samples = [
        VhSample::Altitude(1200.0),
        VhSample::HeightAboveGround(990.0),
    ];
    for kind in [Kind::One, Kind::Two] {
        let whole = position_frame(kind);
        for damage in 0..whole.len() {
            for bit in 0..8 {
                let mut bytes = whole.clone();
                bytes[damage] ^= 1 << bit;
                // A wrong length hides the next frame until as many bytes have come as it claims.
                bytes.extend(&next);
                bytes.extend([0; 280]);
                let found = messages(&mut MavlinkReceiver::new(), &bytes);
                assert_eq!(found.len(), 1, "byte {damage} bit {bit}");
                assert_eq!(found[0].samples, next_samples);
            }
        }
    }
}

#[test]
fn false_beginning_hides_no_message() {
    let hidden = [position_frame(Kind::One), position_frame(Kind::Two)].concat();
    let bytes = [&[0xfd, 255, 0][..], &hidden, &hidden, &hidden, &[0; 280]].concat();
    assert_eq!(messages(&mut MavlinkReceiver::new(), &bytes).len(), 6);
    for end in 1..position_frame(Kind::Two).len() {
        let bytes = [&position_frame(Kind::Two)[..end], &hidden, &[0; 280]].concat();
        assert_eq!(
            messages(&mut MavlinkReceiver::new(), &bytes).len(),
            2,
            "{end}"
        );
    }
}
