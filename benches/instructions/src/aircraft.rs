//! Data of aircraft, byte by byte: whole sentences and messages, and the most expensive byte.

use core::hint::black_box;

use fmc_camera::flight::control_loop::MAX_EVENTS;
use fmc_camera::flight::time::Time;
use fmc_camera::io::instruments::{BYTES_PER_ROUND, Instruments, Wire};
use fmc_camera::io::mavlink::{LONGEST_PACKET, MavlinkReceiver};
use fmc_camera::io::nmea::NmeaReceiver;

use crate::counter::Counter;

const SENTENCES: [(&str, &[u8]); 3] = [
    (
        "nmea_rmc",
        b"$GPRMC,225446.33,A,4916.45,N,12311.12,W,000.5,054.7,191126,020.3,E,A*22\r",
    ),
    (
        "nmea_gga",
        b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r",
    ),
    ("nmea_vtg", b"$GPVTG,054.7,T,034.4,M,100.0,N,185.2,K*44\r"),
];

const MESSAGES: [(&str, &[u8]); 3] = [
    (
        "mavlink_global_position_int",
        b"\xfd\x1c\0\0\0\x01\x01\x21\0\0\xe8\x03\0\0\x87\x0e\xaf\x1c\xb5\x1e\xe5\x06\x74\x51\x12\0\x40\x42\x0f\0\
          \x10\x0e\xc0\x12\0\0\x28\x23\xe3\xb7",
    ),
    (
        "mavlink_distance_sensor",
        b"\xfd\x0e\0\0\0\x01\x01\x84\0\0\xe8\x03\0\0\x64\0\x60\xea\x50\xc3\0\x01\x19\xff\x38\x90",
    ),
    (
        "mavlink_altitude",
        b"\xfd\x20\0\0\0\x01\x01\x8d\0\0\xe8\x03\0\0\0\0\0\0\0\0\0\0\0\0\x96\x44\0\0\0\0\0\0\0\0\0\0\x7a\x44\0\x80\
          \x77\x44\xb2\x24",
    ),
];

/// Bytes of MAVLink that are nested as deep as possible: eleven false beginnings of
/// `GLOBAL_POSITION_INT`, whose frames all end with the same byte.
const NESTED: [u8; 68] = {
    let mut bytes = [0; 68];
    let mut at = 0;
    let mut payload_bytes = 60;
    loop {
        bytes[at] = 0xfe;
        bytes[at + 1] = payload_bytes;
        bytes[at + 5] = 33;
        if payload_bytes == 0 {
            break bytes;
        }
        at += 6;
        payload_bytes -= 6;
    }
};

/// Bytes of MAVLink that begin as often as possible: a frame of the greatest length with a wrong
/// checksum, each byte of which begins a frame that is not read.
const BEGINNINGS: [u8; LONGEST_PACKET] = {
    let mut bytes = [0xfe; LONGEST_PACKET];
    let header = [0xfd, 64, 1, 0, 0, 1, 1, 33, 0, 0];
    let mut at = 0;
    while at < header.len() {
        bytes[at] = header[at];
        at += 1;
    }
    bytes
};

/// Rounds among which the most expensive is looked for: every phase of sentences and messages to
/// one another comes up.
const ROUNDS: u16 = 400;

pub(crate) fn count(counter: &mut Counter) -> Option<()> {
    for (name, sentence) in SENTENCES {
        let mut receiver = NmeaReceiver::new();
        counter.count(name, (1, "sentence"), || {
            let answers = black_box(sentence)
                .iter()
                .map(|byte| receiver.receive(*byte));
            answers.flatten().last()?.ok()
        })?;
    }
    for (name, message) in MESSAGES {
        let mut receiver = MavlinkReceiver::new();
        counter.count(name, (1, "message"), || {
            let answers = black_box(message)
                .iter()
                .map(|byte| receiver.receive(*byte));
            answers.flatten().last()?.ok()
        })?;
    }
    let (_, rmc) = SENTENCES.first()?;
    let mut receiver = NmeaReceiver::new();
    let worst = dearest(counter, rmc, |byte| {
        black_box(receiver.receive(byte));
    })?;
    Counter::print("nmea_byte_worst", (1, "byte"), worst);
    let mut worst = 0;
    for bytes in [&NESTED[..], &BEGINNINGS] {
        let mut receiver = MavlinkReceiver::new();
        // The byte after a wrong frame passes over the beginnings in it.
        for _ in 0..2 {
            let most = dearest(counter, bytes, |byte| {
                black_box(receiver.receive(byte));
            })?;
            worst = most.max(worst);
        }
    }
    Counter::print("mavlink_byte_worst", (1, "byte"), worst);
    let [silent, nested] = rounds(counter, &NESTED)?;
    let [_, beginnings] = rounds(counter, &BEGINNINGS)?;
    Counter::print("instruments_round_silent", (1, "round"), silent);
    let worst = nested.max(beginnings);
    Counter::print("instruments_round_worst", (1, "round"), worst);
    Some(())
}

/// Returns the cost of a round without bytes, and of the most expensive round with as many bytes on
/// both wires as it may take: whole sentences on one, false beginnings on the other.
fn rounds(counter: &mut Counter, messages: &[u8]) -> Option<[u32; 2]> {
    let mut instruments = Instruments::new();
    let (_, rmc) = SENTENCES.first()?;
    let mut sentences = rmc.iter().cycle();
    let mut messages = messages.iter().cycle();
    let mut most = 0;
    let mut now = Time::START;
    for _ in 0..ROUNDS {
        now = now.plus_s(1e-3);
        for _ in 0..BYTES_PER_ROUND {
            instruments.push(Wire::Receiver, *sentences.next()?);
            instruments.push(Wire::Autopilot, *messages.next()?);
        }
        let (instructions, _) = counter.measure(|| instruments.round(now, MAX_EVENTS))?;
        most = instructions.max(most);
    }
    let (least, _) = counter.measure(|| instruments.round(now, MAX_EVENTS))?;
    Some([least, most])
}

/// Returns the cost of the most expensive of these bytes.
fn dearest(counter: &mut Counter, bytes: &[u8], mut receive: impl FnMut(u8)) -> Option<u32> {
    let mut most = 0;
    for byte in bytes {
        let (instructions, ()) = counter.measure(|| receive(black_box(*byte)))?;
        most = instructions.max(most);
    }
    Some(most)
}
