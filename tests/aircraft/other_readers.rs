//! Readings of both decoders beside those of the crates `nmea` and `mavlink`.

use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::mavlink::MavlinkReceiver;
use fmc_camera::io::nmea::{M_PER_S_PER_KNOT, NmeaError, NmeaReceiver};
use mavlink::dialects::common::{
    ALTITUDE_DATA, ATTITUDE_DATA, DISTANCE_SENSOR_DATA, GLOBAL_POSITION_INT_DATA, MavMessage,
    SYSTEM_TIME_DATA,
};
use mavlink::{MavlinkVersion, Message as _, MessageData as _};
use nmea::sentences::{parse_gga, parse_rmc, parse_vtg};
use nmea::{SentenceType, parse_nmea_sentence};
use proptest::prelude::*;

use crate::aircraft::targets::{Kind, frame, messages, received, sentence};

/// Speed or altitude and time, as the crate has them; `None` where it reads no sentence.
fn by_the_crate(text: &str) -> Option<(Option<VhSample>, Option<u64>)> {
    let sentence = parse_nmea_sentence(text.trim_end()).ok()?;
    let speed = |knots: f32| VhSample::GroundSpeed(knots * M_PER_S_PER_KNOT);
    match sentence.message_id {
        SentenceType::GGA => {
            let gga = parse_gga(sentence).ok()?;
            Some((gga.altitude.map(VhSample::Altitude), None))
        }
        SentenceType::RMC => {
            let rmc = parse_rmc(sentence).ok()?;
            let time = rmc.fix_date.zip(rmc.fix_time);
            let unix_us = time.map(|(date, time)| date.and_time(time).and_utc().timestamp_micros());
            let unix_us = unix_us.map(|us| u64::try_from(us).unwrap());
            Some((rmc.speed_over_ground.map(speed), unix_us))
        }
        _ => {
            let vtg = parse_vtg(sentence).ok()?;
            Some((vtg.speed_over_ground.map(speed), None))
        }
    }
}

/// Fields as receivers write them, some of them with values that do not exist.
fn sentences() -> impl Strategy<Value = (&'static str, String)> {
    let time = "([0-2][0-9][0-6][0-9][0-6][0-9](\\.[0-9]{1,3})?)?";
    let position =
        "([0-8][0-9][0-5][0-9]\\.[0-9]{2,5},[NS],[01][0-7][0-9][0-5][0-9]\\.[0-9]{2,5},[EW]|,,,)";
    let rmc = (
        time,
        position,
        "([0-9]{1,4}(\\.[0-9]{0,3})?)?",
        "([0-3][0-9][01][0-9][0-9]{2})?",
        "[ADEMNRFS]?",
    )
        .prop_map(|(time, position, knots, date, mode)| {
            (
                "GPRMC",
                format!("{time},A,{position},{knots},054.7,{date},020.3,E,{mode}"),
            )
        });
    let gga = (time, position, "[0-8]", "(-?[0-9]{1,5}(\\.[0-9]{0,3})?)?").prop_map(
        |(time, position, quality, altitude)| {
            (
                "GNGGA",
                format!("{time},{position},{quality},08,0.9,{altitude},M,46.9,M,,"),
            )
        },
    );
    let vtg = "[0-9]{1,4}(\\.[0-9]{0,3})?"
        .prop_map(|knots| ("GPVTG", format!("054.7,T,034.4,M,{knots},N,185.2,K,A")));
    prop_oneof![3 => rmc, 2 => gga, 1 => vtg]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(4000) })]

    #[test]
    fn sentence_that_is_accepted_says_what_the_crate_reads((name, fields) in sentences()) {
        let text = String::from_utf8(sentence(name, fields.as_bytes())).unwrap();
        let answer = received(&mut NmeaReceiver::new(), text.as_bytes()).pop().unwrap();
        let other = by_the_crate(&text);
        match answer {
            Ok(reading) => prop_assert_eq!(Some((reading.sample, reading.unix_us)), other),
            // A sentence that the crate cannot read is refused; one that it reads is refused for
            // its contents.
            Err(NmeaError::Malformed | NmeaError::InvalidTime | NmeaError::InvalidDate) => {
                prop_assert!(other.is_none(), "{}: {:?} {:?}", text, answer, other);
            }
            Err(_) => {}
        }
    }

    #[test]
    fn message_is_that_of_the_crate(payload in proptest::collection::vec(any::<u8>(), 1..40)) {
        let position = GLOBAL_POSITION_INT_DATA::deser(MavlinkVersion::V2, &payload).unwrap();
        let bytes = frame(Kind::Two, 33, 104, &payload);
        let read = messages(&mut MavlinkReceiver::new(), &bytes);
        let (north, east) = (f32::from(position.vx), f32::from(position.vy));
        let speed = VhSample::GroundSpeed(0.01 * libm::sqrtf(north * north + east * east));
        if let Some(reading) = read.first() {
            prop_assert_eq!(reading.samples[0], speed);
            #[expect(clippy::cast_precision_loss, reason = "as the camera does it")]
            let altitude = VhSample::Altitude(0.001 * position.alt as f32);
            prop_assert_eq!(reading.samples[1], altitude);
        }
        let altitude = ALTITUDE_DATA::deser(MavlinkVersion::V2, &payload).unwrap();
        let read = messages(&mut MavlinkReceiver::new(), &frame(Kind::Two, 141, 47, &payload));
        for sample in read.first().iter().flat_map(|reading| &reading.samples) {
            let expected = match sample {
                VhSample::Altitude(_) => VhSample::Altitude(altitude.altitude_amsl),
                VhSample::TerrainHeight(_) => {
                    VhSample::TerrainHeight(altitude.altitude_amsl - altitude.altitude_terrain)
                }
                _ => VhSample::HeightAboveGround(altitude.bottom_clearance),
            };
            prop_assert_eq!(*sample, expected);
        }
    }
}

#[test]
fn every_message_ends_with_the_checksum_of_its_definition() {
    for (message, extra) in [
        (SYSTEM_TIME_DATA::ID, 137),
        (ATTITUDE_DATA::ID, 39),
        (GLOBAL_POSITION_INT_DATA::ID, 104),
        (DISTANCE_SENSOR_DATA::ID, 85),
        (ALTITUDE_DATA::ID, 47),
    ] {
        assert_eq!(MavMessage::extra_crc(message), extra, "{message}");
        // 2026-01-01 where the message is one of time; elsewhere numbers that mean something.
        let payload: Vec<u8> = 1_767_225_600_000_000_u64.to_le_bytes().repeat(2);
        let read = MavlinkReceiver::new();
        let mut read = read;
        let answers = frame(Kind::Two, message, extra, &payload);
        let answers: Vec<_> = answers
            .iter()
            .filter_map(|byte| read.receive(*byte))
            .collect();
        let is_wrong = answers.contains(&Err(fmc_camera::io::mavlink::MavlinkError::Checksum));
        assert!(!is_wrong, "{message}");
        assert_eq!(read.take_unexplained(), 0, "{message}");
    }
}

#[test]
fn attitude_and_distance_are_those_of_the_crate() {
    let attitude = ATTITUDE_DATA {
        time_boot_ms: 1000,
        roll: 0.1,
        pitch: 0.2,
        yaw: 0.3,
        rollspeed: 0.4,
        pitchspeed: 0.5,
        yawspeed: 0.6,
    };
    let position = GLOBAL_POSITION_INT_DATA {
        time_boot_ms: 1000,
        lat: 1,
        vx: 1000,
        ..GLOBAL_POSITION_INT_DATA::default()
    };
    let mut receiver = MavlinkReceiver::new();
    let mut sent = |message: u32, extra, bytes: &[u8]| {
        messages(&mut receiver, &frame(Kind::Two, message, extra, bytes))
    };
    let mut bytes = [0; 64];
    let count = position.ser(MavlinkVersion::V2, &mut bytes);
    assert_eq!(sent(33, 104, &bytes[..count]).len(), 1);
    let count = attitude.ser(MavlinkVersion::V2, &mut bytes);
    let read = sent(30, 39, &bytes[..count])[0].attitude.unwrap();
    let found = [read.roll_deg, read.pitch_deg, -read.drift_deg];
    let rates = [
        read.rates_deg_s[1],
        read.rates_deg_s[0],
        -read.rates_deg_s[2],
    ];
    let expected = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6_f32].map(f32::to_degrees);
    for (found, expected) in found.into_iter().chain(rates).zip(expected) {
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    }
    let distance = DISTANCE_SENSOR_DATA {
        min_distance: 1,
        max_distance: 60_000,
        current_distance: 12_345,
        orientation: mavlink::dialects::common::MavSensorOrientation::MAV_SENSOR_ROTATION_PITCH_270,
        ..DISTANCE_SENSOR_DATA::default()
    };
    let count = distance.ser(MavlinkVersion::V2, &mut bytes);
    let read = sent(132, 85, &bytes[..count]);
    assert_eq!(read[0].samples, [VhSample::LaserHeight(0.01 * 12_345.0)]);
}
