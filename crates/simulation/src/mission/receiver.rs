//! Satellite receiver that reports speed and altitude in sentences (NMEA 0183), byte after byte on
//! the serial line.

use std::collections::VecDeque;

use fmc_camera::flight::vh::VhSample;
use fmc_camera::io::nmea::{M_PER_S_PER_KNOT, NmeaReceiver};

use super::fault::line::{SerialLine, Traffic};

/// Bits of a byte on the line: start, eight, stop.
const BITS: u64 = 10;

/// Counts of the receiver's sentences.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SentenceCounts {
    /// Sentences that the receiver sent.
    pub sent: u32,
    /// Sentences that the camera's decoder read.
    pub read: u32,
    /// Sentences that the decoder refused: truncated, with a wrong checksum or without a fix.
    pub refused: u32,
    /// Bytes that the line lost.
    pub lost_bytes: u32,
}

/// Receiver, line and the camera's decoder.
#[derive(Debug, Clone)]
pub(super) struct SentenceLine {
    traffic: Traffic,
    baud: u64,
    /// Bytes on the line with their times of arrival, µs.
    bytes: VecDeque<(u64, u8)>,
    free_at_us: u64,
    decoder: NmeaReceiver,
    counts: SentenceCounts,
}

impl SentenceLine {
    /// Creates an idle line.
    pub(super) fn new(traffic: Traffic, baud: u64) -> Self {
        Self {
            traffic,
            baud: baud.max(1),
            bytes: VecDeque::new(),
            free_at_us: 0,
            decoder: NmeaReceiver::new(),
            counts: SentenceCounts::default(),
        }
    }

    /// Sends a sample, after the bytes that were sent before. Returns `false` for a sample that
    /// receivers do not report.
    pub(super) fn send(&mut self, at_us: u64, sample: VhSample) -> bool {
        let Some(sentence) = sentence(sample) else {
            return false;
        };
        let mut at_us = at_us.max(self.free_at_us);
        for byte in sentence.bytes() {
            at_us += 1_000_000 * BITS / self.baud;
            self.bytes.push_back((at_us, byte));
        }
        self.free_at_us = at_us;
        self.counts.sent += 1;
        true
    }

    /// Decodes the bytes that have arrived by a time, µs.
    pub(super) fn read(&mut self, line: &SerialLine, to_us: u64) -> Vec<(u64, VhSample)> {
        let mut samples = Vec::new();
        while let Some((at_us, byte)) = self.bytes.pop_front_if(|(at_us, _)| *at_us <= to_us) {
            if line.loses(self.traffic, at_us) {
                self.counts.lost_bytes += 1;
                continue;
            }
            match self.decoder.receive(byte) {
                Some(Ok(reading)) => {
                    self.counts.read += 1;
                    samples.extend(reading.sample.map(|sample| (at_us, sample)));
                }
                Some(Err(_)) => self.counts.refused += 1,
                None => {}
            }
        }
        samples
    }

    /// Returns the time at which the next byte arrives, µs.
    pub(super) fn due_us(&self) -> Option<u64> {
        self.bytes.front().map(|(at_us, _)| *at_us)
    }

    pub(super) const fn counts(&self) -> SentenceCounts {
        self.counts
    }
}

/// Formats the sentence of a sample; position and time of day, which the camera does not read from
/// it, are 0.
fn sentence(sample: VhSample) -> Option<String> {
    let fields = match sample {
        VhSample::GroundSpeed(speed_m_s) => format!(
            "GPVTG,0.0,T,,M,{:.3},N,{:.3},K,A",
            speed_m_s / M_PER_S_PER_KNOT,
            3.6 * speed_m_s
        ),
        VhSample::Altitude(altitude_m) => format!(
            "GPGGA,000000.00,0000.00000,N,00000.00000,E,4,12,0.8,{altitude_m:.2},M,0.0,M,1.0,0000"
        ),
        _ => return None,
    };
    let checksum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
    Some(format!("${fields}*{checksum:02X}\r\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::fault::line::Carried;
    use crate::mission::fault::{InjectedFault, Injection};
    use crate::mission::file::VhSourceName;

    const SOURCE: Traffic = Traffic::Vh(VhSourceName::Altimeter);

    fn flown(cut_at_s: f64, lasting_s: f64) -> (Vec<(u64, VhSample)>, SentenceCounts) {
        let cut = Injection::new(InjectedFault::UartCut, cut_at_s).of_size(lasting_s);
        let line = SerialLine::new(Carried::everything(), &[cut]);
        let mut receiver = SentenceLine::new(SOURCE, 9600);
        for (at_us, speed_m_s) in [(0_u64, 90.0), (100_000, 91.0), (200_000, 92.0)] {
            assert!(receiver.send(at_us, VhSample::GroundSpeed(speed_m_s)));
        }
        (receiver.read(&line, 1_000_000), receiver.counts())
    }

    /// Speeds to the millimetre per second; one digit of the sentence is half of that.
    fn speeds_m_s(samples: &[(u64, VhSample)]) -> Vec<String> {
        samples
            .iter()
            .map(|(_, sample)| match sample {
                VhSample::GroundSpeed(speed_m_s) => format!("{speed_m_s:.3}"),
                other => format!("{other:?}"),
            })
            .collect()
    }

    #[test]
    fn speed_and_altitude_come_through_when_their_last_byte_is_there() {
        let line = SerialLine::new(Carried::everything(), &[]);
        let mut receiver = SentenceLine::new(SOURCE, 38_400);
        assert!(receiver.send(1000, VhSample::GroundSpeed(96.123)));
        assert!(receiver.send(1000, VhSample::Altitude(901.25)));
        assert!(!receiver.send(1000, VhSample::TerrainHeight(100.0)));
        let [(first_us, speed), (second_us, altitude)] = receiver.read(&line, 1_000_000)[..] else {
            panic!("two samples")
        };
        // A byte takes 260 µs: one sentence of 40 bytes and one of 77.
        assert!((10_000..15_000).contains(&first_us), "{first_us}");
        assert!((28_000..36_000).contains(&second_us), "{second_us}");
        let VhSample::GroundSpeed(speed_m_s) = speed else {
            panic!("{speed:?}")
        };
        // Half of the last digit, 0.0005 knots.
        assert!((speed_m_s - 96.123).abs() < 3e-4, "{speed_m_s}");
        assert_eq!(altitude, VhSample::Altitude(901.25));
    }

    #[test]
    fn sentence_that_is_cut_short_is_refused_and_the_next_whole_one_is_read() {
        // The cut begins 20 ms into the second sentence, which takes 40 ms, and ends in the pause
        // after it.
        let (samples, counts) = flown(0.12, 0.05);
        assert_eq!(speeds_m_s(&samples), ["90.000", "92.000"]);
        assert_eq!((counts.sent, counts.read, counts.refused), (3, 2, 1));
        assert!(counts.lost_bytes > 10);
    }

    #[test]
    fn end_of_one_sentence_behind_the_beginning_of_another_is_no_sentence() {
        // The cut lasts from the middle of the first sentence to the middle of the second.
        let (samples, counts) = flown(0.02, 0.1);
        assert_eq!(speeds_m_s(&samples), ["92.000"]);
        assert_eq!((counts.read, counts.refused), (1, 1));
    }
}
