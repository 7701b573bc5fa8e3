//! Two wires beside each other: what comes on them, and what must not disturb the other.

use fmc_camera::flight::control_loop::MAX_EVENTS;
use fmc_camera::flight::event::Event;
use fmc_camera::flight::rig::RigStep;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::vh::{VhFindingKind, VhMonitor, VhSample, WrongUnit};
use fmc_camera::io::instruments::{
    BYTES_PER_ROUND, HEARD_WITHIN_US, Instruments, WAITING_BYTES, Wire,
};
use fmc_camera::io::nmea::M_PER_S_PER_KNOT;

use crate::aircraft::targets::{Kind, frame, sentence};

/// Bytes of a wire in a round, at 38,400 baud.
pub(super) const BYTES_OF_A_ROUND: usize = 4;

/// Both wires in simulated time.
#[derive(Default)]
pub(super) struct Wires {
    pub(super) instruments: Instruments,
    pub(super) now_ms: u64,
    pub(super) events: Vec<(Time, Event)>,
}

impl Wires {
    pub(super) fn now(&self) -> Time {
        Time::from_us(1000 * self.now_ms)
    }

    pub(super) fn round(&mut self) {
        self.now_ms += 1;
        let events = self.instruments.round(self.now(), MAX_EVENTS);
        self.events.extend(events);
    }

    /// Sends bytes as fast as the line does, on both wires at once.
    pub(super) fn send(&mut self, receiver: &[u8], autopilot: &[u8]) {
        let mut receiver = receiver.chunks(BYTES_OF_A_ROUND);
        let mut autopilot = autopilot.chunks(BYTES_OF_A_ROUND);
        loop {
            let (one, other) = (receiver.next(), autopilot.next());
            if one.is_none() && other.is_none() {
                break;
            }
            for byte in one.into_iter().flatten() {
                self.instruments.push(Wire::Receiver, *byte);
            }
            for byte in other.into_iter().flatten() {
                self.instruments.push(Wire::Autopilot, *byte);
            }
            self.round();
        }
    }

    pub(super) fn wait_ms(&mut self, ms: u64) {
        for _ in 0..ms {
            self.round();
        }
    }

    pub(super) fn taken(&mut self) -> Vec<Event> {
        self.events.drain(..).map(|(_, event)| event).collect()
    }
}

pub(super) fn speed_of(talker: &str, knots: f32) -> Vec<u8> {
    sentence(
        &format!("{talker}VTG"),
        format!("054.7,T,,M,{knots:.1},N,,K,A").as_bytes(),
    )
}

/// Altitude at 48° north, so many minutes north of it.
pub(super) fn altitude_of(talker: &str, minutes: f32, altitude_m: f32) -> Vec<u8> {
    let fields = format!("120000,48{minutes:07.4},N,01131.0,E,1,08,0.9,{altitude_m:.1},M,46.9,M,,");
    sentence(&format!("{talker}GGA"), fields.as_bytes())
}

/// Height above ground, from a system.
pub(super) fn height(system: u8, height_m: f32) -> Vec<u8> {
    from([system, 1], 141, 47, &altitude(f32::NAN, -2000.0, height_m))
}

/// Payload of altitude, height above terrain and clearance.
pub(super) fn altitude(amsl: f32, above_terrain: f32, clearance: f32) -> Vec<u8> {
    let mut payload = 1000_u64.to_le_bytes().to_vec();
    for number in [f32::NAN, amsl, 0.0, 0.0, above_terrain, clearance] {
        payload.extend(number.to_le_bytes());
    }
    payload
}

/// A message of a system and component.
pub(super) fn from(sender: [u8; 2], message: u32, extra: u8, payload: &[u8]) -> Vec<u8> {
    let mut bytes = frame(Kind::Two, message, extra, payload);
    bytes[5..7].copy_from_slice(&sender);
    // Its checksum again.
    let crc = crc::Crc::<u16>::new(&crc::CRC_16_MCRF4XX);
    let mut digest = crc.digest();
    let end = bytes.len() - 2;
    digest.update(&bytes[1..end]);
    digest.update(&[extra]);
    bytes[end..].copy_from_slice(&digest.finalize().to_le_bytes());
    bytes
}

/// 36 m/s north and 48 m/s east, 1200.5 m above the sea.
pub(super) fn position() -> Vec<u8> {
    let mut payload = 1000_u32.to_le_bytes().to_vec();
    for number in [481_234_567, 115_678_901, 1_200_500, 1_000_000_i32] {
        payload.extend(number.to_le_bytes());
    }
    for number in [3600, 4800, 0, 9000_i16] {
        payload.extend(number.to_le_bytes());
    }
    frame(Kind::One, 33, 104, &payload)
}

pub(super) fn knots(knots: f32) -> Event {
    Event::Vh(VhSample::GroundSpeed(knots * M_PER_S_PER_KNOT))
}

pub(super) fn above_ground(height_m: f32) -> Event {
    Event::Vh(VhSample::HeightAboveGround(height_m))
}

#[test]
fn bytes_of_both_wires_become_events_in_order_of_time() {
    let mut wires = Wires::default();
    wires.wait_ms(100);
    let began = wires.now_ms + 1;
    let time = sentence(
        "GPRMC",
        b"120000,A,4800.0,N,01131.0,E,100.0,054.7,010126,,,A",
    );
    wires.send(&time, &height(1, 800.0));
    let times: Vec<Time> = wires.events.iter().map(|(time, _)| *time).collect();
    assert!(times.is_sorted());
    let unix_us = 1_767_268_800_000_000;
    assert_eq!(
        wires
            .events
            .iter()
            .map(|(_, event)| *event)
            .collect::<Vec<_>>(),
        [above_ground(800.0), knots(100.0), Event::GnssTime(unix_us)]
    );
    // The message of 44 bytes takes 11 rounds and the sentence 17: both ages count from the first
    // byte as far as the controller lets them, the time from the last.
    assert_eq!(times[0].us(), 1000 * (began + 10) - HEARD_WITHIN_US);
    assert_eq!(times[1].us(), 1000 * wires.now_ms - HEARD_WITHIN_US);
    assert_eq!(times[2].us(), 1000 * wires.now_ms);
    let counters = wires.instruments.counters();
    assert_eq!((counters.receiver.read, counters.autopilot.read), (1, 1));
    assert_eq!(counters.receiver.bytes as usize, time.len());
    assert_eq!(
        (
            counters.receiver.unexplained_bytes,
            counters.autopilot.unexplained_bytes
        ),
        (0, 0)
    );
    // Time of a short message is that of its first byte.
    let speed = speed_of("GP", 90.0);
    let (all_but_the_end, end) = speed.split_at(speed.len() - 4);
    for byte in all_but_the_end {
        wires.instruments.push(Wire::Receiver, *byte);
    }
    wires.wait_ms(3);
    wires.events.clear();
    let begun_ms = wires.now_ms - 2;
    wires.send(end, &[]);
    assert_eq!(
        wires.events,
        [(Time::from_us(1000 * begun_ms), knots(90.0))]
    );
}

#[test]
fn flood_is_dropped_and_counted_and_costs_the_other_wire_nothing() {
    for (flooded, other) in [
        (Wire::Receiver, Wire::Autopilot),
        (Wire::Autopilot, Wire::Receiver),
    ] {
        let mut wires = Wires::default();
        let messages = [speed_of("GP", 100.0), height(1, 800.0)];
        let [flood, quiet] = match flooded {
            Wire::Receiver => messages,
            Wire::Autopilot => [messages[1].clone(), messages[0].clone()],
        };
        let mut sent = 0;
        for piece in quiet
            .chunks(BYTES_OF_A_ROUND)
            .cycle()
            .take(200 * quiet.len().div_ceil(4))
        {
            for byte in flood.iter().cycle().take(1000) {
                wires.instruments.push(flooded, *byte);
            }
            sent += 1000;
            for byte in piece {
                wires.instruments.push(other, *byte);
            }
            wires.round();
        }
        let events = wires.taken();
        let expected = if flooded == Wire::Receiver {
            above_ground(800.0)
        } else {
            knots(100.0)
        };
        let quiet_ones = events.iter().filter(|event| **event == expected).count();
        assert_eq!(quiet_ones, 200, "{flooded:?}");
        let counters = wires.instruments.counters();
        let (bytes, dropped) = match flooded {
            Wire::Receiver => (counters.receiver.bytes, counters.receiver.flooded_bytes),
            Wire::Autopilot => (counters.autopilot.bytes, counters.autopilot.flooded_bytes),
        };
        let rounds = sent / 1000;
        assert_eq!(bytes, sent);
        let taken = usize::try_from(bytes - dropped).unwrap();
        let most = BYTES_PER_ROUND * rounds as usize + WAITING_BYTES;
        assert!(taken <= most && taken > most / 2, "{taken} of {most}");
    }
}

#[test]
fn cut_and_wrong_baud_rate_of_a_wire_leave_the_other_as_it_is() {
    let mut wires = Wires::default();
    let speed = speed_of("GP", 100.0);
    wires.send(&speed[..20], &height(1, 800.0));
    wires.wait_ms(500);
    wires.send(&speed, &height(1, 801.0));
    assert_eq!(
        wires.taken(),
        [above_ground(800.0), knots(100.0), above_ground(801.0)]
    );
    let counters = wires.instruments.counters();
    assert_eq!(
        (counters.receiver.truncated, counters.autopilot.read),
        (1, 2)
    );
    // The receiver's bits, two for one.
    let noise: Vec<u8> = speed
        .iter()
        .flat_map(|byte| [byte | 0x80, byte ^ 0xf0])
        .collect();
    for _ in 0..20 {
        wires.send(&noise, &height(1, 802.0));
    }
    assert_eq!(wires.taken(), [above_ground(802.0); 20]);
    let counters = wires.instruments.counters();
    assert!(counters.receiver.unexplained_bytes > 10 * u32::try_from(noise.len()).unwrap());
    assert_eq!(
        (
            counters.autopilot.unexplained_bytes,
            counters.autopilot.checksum
        ),
        (0, 0)
    );
    // And the other way round.
    let noise: Vec<u8> = height(1, 800.0)
        .iter()
        .flat_map(|byte| [byte | 0x80, byte ^ 0xf0])
        .collect();
    wires.send(&speed[..10], &[]);
    wires.wait_ms(10);
    for _ in 0..20 {
        wires.send(&speed, &noise);
    }
    assert_eq!(wires.taken(), [knots(100.0); 20]);
    assert!(wires.instruments.counters().autopilot.unexplained_bytes > 300);
}

/// A receiver that has been set to metres per second puts them where knots belong.
#[test]
fn knots_for_metres_per_second_are_found_from_bytes_on() {
    let mut wires = Wires::default();
    let mut monitor = VhMonitor::default();
    let mut found = Vec::new();
    let speed_m_s = 96.0;
    let right = speed_m_s / M_PER_S_PER_KNOT;
    for number in [
        right, right, right, right, speed_m_s, speed_m_s, right, right,
    ] {
        wires.send(&speed_of("GP", number), &height(1, 800.0));
        wires.wait_ms(100);
        for (time, event) in wires.events.drain(..) {
            if let Event::Vh(sample) = event {
                found.extend(monitor.observe(time, sample).map(|finding| finding.kind));
            }
        }
    }
    let wrong = VhFindingKind::WrongUnit(WrongUnit::Knots);
    assert_eq!(found, [wrong, wrong, VhFindingKind::Recovered]);
    let estimate = monitor.estimate(wires.now()).unwrap();
    assert!((estimate.vh_per_s - 0.12).abs() < 1e-4, "{estimate:?}");
}

#[test]
fn events_of_the_wires_find_their_place_among_those_of_a_rig_and_wait_where_there_is_none() {
    let mut instruments = Instruments::new();
    let speed = speed_of("GP", 100.0);
    let own = [
        Event::Trigger,
        Event::TimePulse,
        Event::Trigger,
        Event::Trigger,
    ];
    let mut step = RigStep::default();
    for (event, time_us) in own.into_iter().zip([100, 200, 300, 900]) {
        step.events.push((Time::from_us(time_us), event)).unwrap();
    }
    step.time = Time::from_us(1000);
    for byte in &speed {
        instruments.push(Wire::Receiver, *byte);
    }
    assert_eq!(instruments.wired(&step), step, "too little room");
    step.events.clear();
    let mut arrived = Vec::new();
    for round in 2..6 {
        step.time = Time::from_us(1000 * round);
        arrived.extend(instruments.wired(&step).events);
    }
    assert_eq!(arrived.len(), 1);
    assert_eq!(instruments.received().receiver as usize, speed.len());
}

#[test]
fn sample_stands_before_events_of_a_rig_that_came_after_the_first_byte_of_its_sentence() {
    let mut instruments = Instruments::new();
    for byte in &speed_of("GP", 100.0) {
        instruments.push(Wire::Receiver, *byte);
    }
    // The sentence begins in the round at 1 ms.
    let began = Time::from_us(1000);
    let mut found = Vec::new();
    for round in 1..=4 {
        let mut step = RigStep {
            time: Time::from_us(1000 * round),
            ..RigStep::default()
        };
        for before_us in [950, 50] {
            let time = Time::from_us(step.time.us() - before_us);
            step.events.push((time, Event::Trigger)).unwrap();
        }
        let own = step.events.to_vec();
        let wired = instruments.wired(&step).events;
        if wired.len() > own.len() {
            let sample = (began, knots(100.0));
            assert_eq!(wired[..], [&[sample][..], &own].concat());
            found.push(round);
        } else {
            assert_eq!(wired[..], own);
        }
    }
    assert_eq!(found, [3]);
}

#[test]
fn lost_bytes_are_counted_with_those_that_have_come() {
    let mut instruments = Instruments::new();
    instruments.count_lost(Wire::Autopilot, 3);
    instruments.count_lost(Wire::Receiver, u32::MAX);
    instruments.push(Wire::Receiver, b'$');
    let counters = instruments.counters();
    assert_eq!(
        (counters.autopilot.bytes, counters.autopilot.lost_bytes),
        (3, 3)
    );
    assert_eq!(
        (counters.receiver.bytes, counters.receiver.lost_bytes),
        (u32::MAX, u32::MAX)
    );
}
