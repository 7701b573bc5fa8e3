//! Sentences of a satellite receiver.

use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcClock;
use fmc_camera::flight::vh::{VhMonitor, VhSample};
use fmc_camera::io::nmea::{LONGEST_SENTENCE, NmeaError, NmeaReading, NmeaReceiver};

use crate::aircraft::targets::{received, sentence};

fn answers(bytes: &[u8]) -> Vec<Result<NmeaReading, NmeaError>> {
    received(&mut NmeaReceiver::new(), bytes)
}

fn answer(name: &str, fields: &str) -> Result<NmeaReading, NmeaError> {
    let answers = answers(&sentence(name, fields.as_bytes()));
    assert_eq!(answers.len(), 1, "{fields}");
    answers[0]
}

/// Published examples, with their checksums as printed.
const RMC_OF_1994: &[u8] =
    b"$GPRMC,225446.33,A,4916.45,N,12311.12,W,000.5,054.7,191194,020.3,E,A*2B\r\n";
/// The same of 2026.
const RMC: &[u8] = b"$GPRMC,225446.33,A,4916.45,N,12311.12,W,000.5,054.7,191126,020.3,E,A*22\r\n";
const GGA: &[u8] = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";

#[test]
fn published_sentences_are_read() {
    let rmc = answers(RMC)[0].unwrap();
    let Some(VhSample::GroundSpeed(speed)) = rmc.sample else {
        panic!("{rmc:?}");
    };
    // 0.5 knots.
    assert!((speed - 0.257_222).abs() < 1e-6);
    // date -u -d 2026-11-19T22:54:46.33 +%s%6N
    assert_eq!(rmc.unix_us, Some(1_795_128_886_330_000));
    assert_eq!(rmc.talker, *b"GP");
    let position = rmc.position.unwrap();
    // 49° 16.45' north, 123° 11.12' west.
    assert_eq!(position.latitude, (49 * 60 + 16) * 10_000 + 4500);
    assert_eq!(position.longitude, -((123 * 60 + 11) * 10_000 + 1200));
    assert_eq!(answers(RMC_OF_1994), [Err(NmeaError::BeforeYear2000)]);
    let gga = answers(GGA)[0].unwrap();
    assert_eq!(gga.sample, Some(VhSample::Altitude(545.4)));
    assert_eq!(gga.unix_us, None);
    let vtg = answer("GPVTG", "054.7,T,034.4,M,100.0,N,185.2,K").unwrap();
    let Some(VhSample::GroundSpeed(speed)) = vtg.sample else {
        panic!("{vtg:?}");
    };
    assert!((speed - 51.4444).abs() < 1e-4);
}

#[test]
fn damaged_sentence_is_refused_and_the_next_is_read() {
    for damage in 1..RMC.len() - 2 {
        for bit in 0..8 {
            let mut bytes = RMC.to_vec();
            bytes[damage] ^= 1 << bit;
            bytes.extend(GGA);
            let answers = answers(&bytes);
            let readings: Vec<_> = answers.iter().flatten().collect();
            // Another name or an end in its middle may silence it; never is it read.
            assert_eq!(readings.len(), 1, "byte {damage} bit {bit}: {answers:?}");
            assert_eq!(readings[0].sample, Some(VhSample::Altitude(545.4)));
        }
    }
}

#[test]
fn truncated_and_mixed_streams_resynchronise_at_the_next_sentence() {
    for end in 1..RMC.len() - 2 {
        let answers = answers(&[&RMC[..end], GGA].concat());
        assert_eq!(answers[0], Err(NmeaError::Truncated));
        assert!(answers[1].is_ok());
        assert_eq!(answers.len(), 2);
    }
    let binary = [0xb5, 0x62, 1, 7, 92, 0, b'$', 3, 0xff];
    let mixed = [&binary[..], RMC, &binary, GGA, &RMC[..30], &binary, GGA].concat();
    assert_eq!(answers(&mixed).iter().flatten().count(), 3);
}

#[test]
fn sentence_too_long_or_without_checksum_is_refused() {
    let long = vec![b'x'; 10 * LONGEST_SENTENCE];
    let oversized = answers(&sentence("GPRMC", &long));
    assert_eq!(oversized, [Err(NmeaError::Oversized)]);
    for bad in [
        "$GPRMC,225446\r\n",
        "$\r\n",
        "$*\r\n",
        "$GPRMC*4\r\n",
        "$GPRMC,*GG\r\n",
    ] {
        assert_eq!(answers(bad.as_bytes()), [Err(NmeaError::Checksum)], "{bad}");
    }
    assert!(answers(&sentence("GPGSV", b"3,1,11,03,03,111,00")).is_empty());
}

#[test]
fn what_is_no_number_or_beyond_its_range_is_refused() {
    for speed in ["nan", "NaN", "inf", "-inf", "-60.0", "5000", "1e38"] {
        let fields = format!("225446,A,4916.45,N,12311.12,W,{speed},054.7,191194,,");
        let answer = answer("GPRMC", &fields);
        assert!(answer.is_err(), "{speed}: {answer:?}");
    }
    for altitude in ["-5000", "200000"] {
        let fields = format!("123519,4807.038,N,01131.0,E,1,08,0.9,{altitude},M,46.9,M,,");
        let answer = answer("GPGGA", &fields);
        assert!(
            matches!(answer, Err(NmeaError::OutOfRange(_))),
            "{altitude}: {answer:?}"
        );
    }
    for altitude in ["nan", "inf", "2e5", "-", "1.2.3", "0x1"] {
        let fields = format!("123519,4807.038,N,01131.0,E,1,08,0.9,{altitude},M,46.9,M,,");
        assert_eq!(answer("GPGGA", &fields), Err(NmeaError::Malformed));
    }
    // Altitude in feet, were it said so.
    let feet = answer(
        "GPGGA",
        "123519,4807.038,N,01131.0,E,1,08,0.9,1789.4,F,46.9,M,,",
    );
    assert_eq!(feet, Err(NmeaError::Malformed));
}

#[test]
fn receiver_without_fix_or_in_simulation_gives_nothing() {
    assert_eq!(answer("GPRMC", ",V,,,,,,,,,,N"), Err(NmeaError::NoFix));
    let of_mode = |mode| format!("225446,A,4916.45,N,12311.12,W,100.0,054.7,191126,020.3,E,{mode}");
    let of_quality =
        |quality| format!("123519,4807.038,N,01131.0,E,{quality},08,0.9,545.4,M,46.9,M,,");
    for (modes, error) in [
        (["E", "N"], NmeaError::NoFix),
        (["M", "S"], NmeaError::SimulatedFix),
    ] {
        for mode in modes {
            assert_eq!(answer("GPRMC", &of_mode(mode)), Err(error), "{mode}");
            let vtg = format!("054.7,T,034.4,M,100.0,N,185.2,K,{mode}");
            assert_eq!(answer("GPVTG", &vtg), Err(error), "{mode}");
        }
    }
    for (qualities, error) in [
        ([0, 6], NmeaError::NoFix),
        ([7, 8], NmeaError::SimulatedFix),
    ] {
        for quality in qualities {
            assert_eq!(answer("GPGGA", &of_quality(quality)), Err(error));
        }
    }
    assert_eq!(answer("GPVTG", ",T,,M,,N,,K"), Err(NmeaError::NoFix));
}

#[test]
fn date_or_time_that_does_not_exist_is_refused_by_name() {
    let of = |time: &str, date: &str| {
        answer(
            "GPRMC",
            &format!("{time},A,4916.45,N,12311.12,W,100.0,054.7,{date},,"),
        )
    };
    assert_eq!(of("120000", "300226"), Err(NmeaError::InvalidDate));
    assert_eq!(of("120000", "290226"), Err(NmeaError::InvalidDate));
    assert_eq!(of("000000", "010170"), Err(NmeaError::BeforeYear2000));
    assert_eq!(of("120000", "010180"), Err(NmeaError::BeforeYear2000));
    assert_eq!(of("120000", "220899"), Err(NmeaError::BeforeYear2000));
    assert_eq!(of("240000", "010126"), Err(NmeaError::InvalidTime));
    assert_eq!(of("235960", "311216"), Err(NmeaError::InvalidTime));
    assert_eq!(of("12:00:00", "010126"), Err(NmeaError::Malformed));
    // date -u -d 2024-02-29T23:59:59.999999 +%s%6N
    let leap_day = of("235959.999999", "290224").unwrap();
    assert_eq!(leap_day.unix_us, Some(1_709_251_199_999_999));
    // A receiver that does not know the time yet gives its speed.
    assert_eq!(of("", "").unwrap().unix_us, None);
}

#[test]
fn position_beyond_the_poles_or_half_a_turn_is_refused() {
    let of = |latitude: &str, longitude: &str| {
        let fields = format!("120000,A,{latitude},N,{longitude},W,100.0,054.7,010126,,");
        answer("GPRMC", &fields)
    };
    assert!(of("9000.0000", "18000.0000").is_ok());
    for (latitude, longitude) in [
        ("9000.0001", "01131.0"),
        ("9059.0000", "01131.0"),
        ("4800.0000", "18000.0001"),
        ("4800.0000", "18059.0000"),
        ("4860.0000", "01131.0"),
    ] {
        let found = of(latitude, longitude);
        assert_eq!(found, Err(NmeaError::Malformed), "{latitude} {longitude}");
    }
}

#[test]
fn side_of_a_position_that_is_none_of_its_two_is_refused() {
    for (north, east) in [("E", "W"), ("N", "S"), ("", "W"), ("n", "E"), ("NS", "E")] {
        let fields = format!("120000,A,4800.0,{north},01131.0,{east},100.0,054.7,010126,,");
        let found = answer("GPRMC", &fields);
        assert_eq!(found, Err(NmeaError::Malformed), "{north} {east}");
    }
    let south = answer("GPRMC", "120000,A,4800.0,S,01131.0,E,100.0,,010126,,").unwrap();
    assert_eq!(south.position.unwrap().latitude, -48 * 600_000);
}

#[test]
fn sentence_without_a_whole_name_is_ignored_and_one_without_fields_refused() {
    // The checksum is right in all of them.
    for short in ["$*00\r\n", "$G*47\r\n", "$GP*17\r\n", "$GPGG*17\r\n"] {
        assert_eq!(answers(short.as_bytes()), [], "{short}");
    }
    let bare = answers(b"$GPGGA*56\r\n");
    assert_eq!(bare, [Err(NmeaError::NoFix)]);
    // Behind a name that goes on there are no fields.
    let longer = answers(b"$GPVTGX,,,,,5.0,N*6F\r\n");
    assert_eq!(longer, [Err(NmeaError::NoFix)]);
}

#[test]
fn sentence_is_under_way_from_its_first_byte_to_its_last() {
    let mut receiver = NmeaReceiver::new();
    assert!(!receiver.is_under_way());
    let (end, text) = GGA[..GGA.len() - 1].split_last().unwrap();
    for byte in text {
        assert_eq!(receiver.receive(*byte), None);
        assert!(receiver.is_under_way());
    }
    assert!(receiver.receive(*end).unwrap().is_ok());
    assert!(!receiver.is_under_way());
}

#[test]
fn bytes_of_another_baud_rate_are_counted_as_unexplained() {
    let mut receiver = NmeaReceiver::new();
    let read = received(&mut receiver, &[RMC, GGA].concat());
    assert_eq!((read.len(), receiver.take_unexplained()), (2, 0));
    // Bits of half a byte each, taken for bytes.
    let noise: Vec<u8> = RMC
        .iter()
        .flat_map(|byte| [byte | 0x80, byte ^ 0xf0])
        .collect();
    let read = received(&mut receiver, &noise);
    assert!(read.iter().all(Result::is_err), "{read:?}");
    let unexplained = usize::try_from(receiver.take_unexplained()).unwrap();
    assert!(unexplained > noise.len() / 2, "{unexplained}");
}

#[test]
fn sentences_and_pulses_set_the_clock_and_give_vh() {
    let mut receiver = NmeaReceiver::new();
    let mut monitor = VhMonitor::default();
    let mut clock = UtcClock::new(1e-6);
    for second in 0..5_u64 {
        let pulse = Time::from_us(2_000_000 + second * 1_000_000);
        clock.pulse(pulse);
        let arrival = pulse.plus_s(0.2);
        let rmc = format!("12000{second},A,4916.45,N,12311.12,W,116.{second},054.7,010126,,");
        let gga = format!("12000{second},4807.038,N,01131.0,E,4,08,0.9,1200.{second},M,46.9,M,,");
        for (name, fields) in [("GNRMC", rmc), ("GNGGA", gga)] {
            for reading in received(&mut receiver, &sentence(name, fields.as_bytes())) {
                let reading = reading.unwrap();
                let found = reading
                    .sample
                    .and_then(|sample| monitor.observe(arrival, sample));
                assert_eq!(found, None);
                let found = reading
                    .unix_us
                    .and_then(|time| clock.receiver_time(arrival, time));
                assert_eq!(found, None);
            }
        }
        monitor.observe(arrival, VhSample::TerrainHeight(200.0));
    }
    let now = Time::from_us(6_500_000);
    // 2026-01-01T12:00:04.5.
    assert_eq!(clock.utc(now).unwrap().unix_us, 1_767_268_804_500_000);
    let estimate = monitor.estimate(now).unwrap();
    assert!((estimate.vh_per_s - 116.4 * 0.514_444 / 1000.4).abs() < 1e-6);
}
