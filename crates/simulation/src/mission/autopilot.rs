//! Autopilot: height, track and attitude in messages (`MAVLink` 2).

use crc::{CRC_16_MCRF4XX, Crc};
use fmc_camera::flight::event::AttitudeSample;

/// System and component number of the autopilot.
const SENDER: [u8; 2] = [1, 1];

const CRC: Crc<u16> = Crc::<u16>::new(&CRC_16_MCRF4XX);

/// A message of the common dialect: number, and the byte of its definition in the checksum.
type Message = (u8, u8);
const ATTITUDE: Message = (30, 39);
const GLOBAL_POSITION_INT: Message = (33, 104);
const ALTITUDE: Message = (141, 47);

/// Bytes of a message around its payload.
const AROUND_PAYLOAD_BYTES: u32 = 12;

/// Bytes of the messages at most: `ALTITUDE`, `GLOBAL_POSITION_INT`, and the latter with
/// `ATTITUDE`.
pub(super) const HEIGHT_BYTES: u32 = 32 + AROUND_PAYLOAD_BYTES;
pub(super) const POSITION_BYTES: u32 = 28 + AROUND_PAYLOAD_BYTES;
pub(super) const TRACK_AND_ATTITUDE_BYTES: u32 = POSITION_BYTES + 28 + AROUND_PAYLOAD_BYTES;

/// The autopilot with the number of its next message.
#[derive(Debug, Clone, Default)]
pub(super) struct Autopilot {
    sequence: u8,
}

/// Motion over the ground, m/s, as the autopilot's filter has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Track {
    pub(super) north_m_s: f64,
    pub(super) east_m_s: f64,
    /// Altitude above sea level, m.
    pub(super) altitude_m: f64,
}

impl Autopilot {
    /// Returns the message of a height above the ground; a NaN is a height that it does not know.
    pub(super) fn height(&mut self, at_us: u64, height_m: f32) -> Vec<u8> {
        let mut payload = at_us.to_le_bytes().to_vec();
        let unknown = f32::NAN;
        for number in [unknown, unknown, unknown, unknown, unknown, height_m] {
            payload.extend(number.to_le_bytes());
        }
        self.message(ALTITUDE, &payload)
    }

    /// Returns the messages of track and attitude. The heading is the track less the drift.
    pub(super) fn attitude(
        &mut self,
        at_us: u64,
        track: Track,
        sample: &AttitudeSample,
    ) -> Vec<u8> {
        let boot_ms = u32::try_from(at_us / 1000).unwrap_or(u32::MAX);
        let mut position = boot_ms.to_le_bytes().to_vec();
        // The camera does not use the position, but 0, 0 would mean that there is none.
        for number in [480_000_000, 110_000_000, millimetres(track.altitude_m), 0] {
            position.extend(number.to_le_bytes());
        }
        for number in [track.north_m_s, track.east_m_s, 0.0] {
            position.extend(centimetres(number).to_le_bytes());
        }
        position.extend(u16::MAX.to_le_bytes());
        let mut messages = self.message(GLOBAL_POSITION_INT, &position);
        let track_rad = f64::atan2(track.east_m_s, track.north_m_s);
        let drift_rad = f64::from(sample.drift_deg).to_radians();
        let [right, forward, up] = sample.rates_deg_s;
        let mut attitude = boot_ms.to_le_bytes().to_vec();
        for number in [
            f64::from(sample.roll_deg).to_radians(),
            f64::from(sample.pitch_deg).to_radians(),
            track_rad - drift_rad,
            f64::from(forward).to_radians(),
            f64::from(right).to_radians(),
            -f64::from(up).to_radians(),
        ] {
            attitude.extend(fmc_camera_file::number::single(number).to_le_bytes());
        }
        messages.extend(self.message(ATTITUDE, &attitude));
        messages
    }

    fn message(&mut self, (number, extra): Message, payload: &[u8]) -> Vec<u8> {
        // Zeros at the end are left out, down to one byte.
        let used = payload
            .iter()
            .rposition(|byte| *byte != 0)
            .map_or(1, |at| at + 1);
        let payload = payload.get(..used).unwrap_or(payload);
        let length = u8::try_from(payload.len()).unwrap_or(u8::MAX);
        let [system, component] = SENDER;
        let mut message = vec![
            0xfd,
            length,
            0,
            0,
            self.sequence,
            system,
            component,
            number,
            0,
            0,
        ];
        self.sequence = self.sequence.wrapping_add(1);
        message.extend(payload);
        let mut digest = CRC.digest();
        digest.update(message.get(1..).unwrap_or_default());
        digest.update(&[extra]);
        message.extend(digest.finalize().to_le_bytes());
        message
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the cast saturates")]
fn millimetres(m: f64) -> i32 {
    (1000.0 * m).round() as i32
}

#[expect(clippy::cast_possible_truncation, reason = "the cast saturates")]
fn centimetres(m: f64) -> i16 {
    (100.0 * m).round() as i16
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::vh::VhSample;
    use fmc_camera::io::mavlink::{MavlinkReading, MavlinkReceiver};

    use super::*;

    fn read(bytes: &[u8]) -> Vec<MavlinkReading> {
        let mut receiver = MavlinkReceiver::new();
        let answers = bytes.iter().filter_map(|byte| receiver.receive(*byte));
        answers.map(Result::unwrap).collect()
    }

    #[test]
    fn height_and_attitude_come_through() {
        let mut autopilot = Autopilot::default();
        let height = autopilot.height(1_000_000, 801.234);
        assert_eq!(height.len(), HEIGHT_BYTES as usize);
        assert_eq!(
            read(&height)[0].samples,
            [VhSample::HeightAboveGround(801.234)]
        );
        let sample = AttitudeSample {
            pitch_deg: 0.3,
            roll_deg: -0.2,
            drift_deg: 0.1,
            rates_deg_s: [0.01, -0.02, 0.03],
        };
        let track = Track {
            north_m_s: 96.0,
            east_m_s: -1.0,
            altitude_m: 900.0,
        };
        let messages = autopilot.attitude(1_000_000, track, &sample);
        assert_eq!(messages.len(), TRACK_AND_ATTITUDE_BYTES as usize);
        let [position, attitude] = &read(&messages)[..] else {
            panic!()
        };
        assert_eq!(position.samples[1], VhSample::Altitude(0.001 * 900_000.0));
        let found = attitude.attitude.unwrap();
        let numbers = |sample: &AttitudeSample| {
            let [right, forward, up] = sample.rates_deg_s;
            [
                sample.pitch_deg,
                sample.roll_deg,
                sample.drift_deg,
                right,
                forward,
                up,
            ]
        };
        for (found, expected) in numbers(&found).into_iter().zip(numbers(&sample)) {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
        // A height that is not known is none.
        assert_eq!(read(&autopilot.height(0, f32::NAN)), []);
    }
}
