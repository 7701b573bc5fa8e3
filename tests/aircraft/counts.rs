//! Counts of sentences and messages that are not used, each by its reason.

use fmc_camera::flight::event::Event;
use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::instruments::Instruments;
use fmc_camera::io::instruments::counters::{AutopilotCounters, ReceiverCounters};

use super::instruments::*;
use crate::aircraft::targets::{Kind, frame, sentence};

/// Place of a count.
type Count<Counters> = fn(&mut Counters) -> &mut u32;

fn of_receiver(bytes: &[u8]) -> ReceiverCounters {
    let mut wires = Wires::default();
    wires.send(bytes, &[]);
    assert_eq!(wires.taken(), []);
    wires.instruments.counters().receiver
}

fn of_autopilot(bytes: &[u8]) -> AutopilotCounters {
    let mut wires = Wires::default();
    wires.send(&[], bytes);
    assert_eq!(wires.taken(), []);
    wires.instruments.counters().autopilot
}

#[test]
fn every_reason_against_a_sentence_has_its_own_count() {
    let rmc = |time: &str, knots: &str, date: &str, mode: &str| {
        let fields = format!("{time},A,4800.0,N,01131.0,E,{knots},054.7,{date},,,{mode}");
        sentence("GPRMC", fields.as_bytes())
    };
    let mut wrong_sum = rmc("120000", "100.0", "010126", "A");
    wrong_sum[10] ^= 1;
    let cases: [(Vec<u8>, Count<ReceiverCounters>); 10] = [
        (sentence("GPRMC", &[b'x'; 200]), |it| &mut it.oversized),
        (wrong_sum, |it| &mut it.checksum),
        (rmc("120000", "1e3", "010126", "A"), |it| &mut it.malformed),
        (rmc("120000", "9.0", "010126", "E"), |it| &mut it.no_fix),
        (rmc("120000", "9.0", "010126", "S"), |it| {
            &mut it.simulated_fix
        }),
        (rmc("120000", "9.0", "300226", "A"), |it| {
            &mut it.invalid_time
        }),
        (rmc("250000", "9.0", "010126", "A"), |it| {
            &mut it.invalid_time
        }),
        (rmc("120000", "9.0", "010199", "A"), |it| {
            &mut it.before_year_2000
        }),
        (rmc("120000", "5000", "010126", "A"), |it| {
            &mut it.out_of_range
        }),
        (b"$GPRMC,12$".to_vec(), |it| &mut it.truncated),
    ];
    for (bytes, count) in cases {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let mut counters = of_receiver(&bytes);
        assert_eq!(counters.bytes as usize, bytes.len());
        assert_eq!(core::mem::take(count(&mut counters)), 1, "{text}");
        // No other count but that of bytes.
        counters.bytes = 0;
        counters.unexplained_bytes = 0;
        assert_eq!(counters, ReceiverCounters::NONE, "{text}");
    }
}

#[test]
fn every_reason_against_a_message_has_its_own_count() {
    const DOWN: u8 = 25;
    let distance = |distance_cm: u16, kind: u8| {
        let mut payload = 1000_u32.to_le_bytes().to_vec();
        for number in [100, 60_000, distance_cm] {
            payload.extend(number.to_le_bytes());
        }
        payload.extend([kind, 1, DOWN, 255]);
        frame(Kind::Two, 132, 85, &payload)
    };
    let mut wrong_sum = height(1, 800.0);
    wrong_sum[12] ^= 1;
    let beyond = from([1, 1], 141, 47, &altitude(f32::INFINITY, 0.0, -1.0));
    let nowhere = frame(Kind::Two, 33, 104, &[1, 0, 0, 0, 0, 0, 0, 0]);
    let cases: [(Vec<u8>, Count<AutopilotCounters>); 5] = [
        (wrong_sum, |it| &mut it.checksum),
        (distance(50_000, 99), |it| &mut it.malformed),
        (nowhere, |it| &mut it.no_fix),
        (distance(99, 0), |it| &mut it.no_distance),
        (beyond, |it| &mut it.out_of_range),
    ];
    for (bytes, count) in cases {
        let mut counters = of_autopilot(&bytes);
        assert_eq!(counters.bytes as usize, bytes.len());
        assert_eq!(core::mem::take(count(&mut counters)), 1, "{bytes:x?}");
        counters.bytes = 0;
        counters.unexplained_bytes = 0;
        assert_eq!(counters, AutopilotCounters::NONE, "{bytes:x?}");
    }
}

#[test]
fn event_without_a_place_among_those_that_wait_is_counted() {
    let mut instruments = Instruments::new();
    instruments.count_crowded_out();
    instruments.count_crowded_out();
    assert_eq!(instruments.counters().crowded_out, 2);
    instruments.clear();
    assert_eq!(instruments.counters().crowded_out, 0);
}

#[test]
fn receiver_that_knows_no_speed_gives_its_time_alone() {
    let mut wires = Wires::default();
    let fields = b"120000,A,4800.0,N,01131.0,E,,,010126,,,A";
    wires.send(&sentence("GPRMC", fields), &[]);
    let time = Event::GnssTime(1_767_268_800_000_000);
    assert_eq!(wires.taken(), [time]);
    assert_eq!(wires.instruments.counters().receiver.read, 1);
    // Its speed is not alive: the autopilot's counts as ground speed.
    wires.send(&[], &position());
    assert_eq!(wires.taken()[0], Event::Vh(VhSample::GroundSpeed(60.0)));
}
