//! Load of the two wires: bytes of the messages of a scenario, and the time that they take.

use fmc_camera::io::instruments::HEARD_WITHIN_US;
use fmc_camera_file::number::single;

use super::autopilot::{HEIGHT_BYTES, POSITION_BYTES, TRACK_AND_ATTITUDE_BYTES};
use super::clock::seconds;
use super::file::{AutopilotFormat, LineTable, MissionFile, ReceiverFormat, VhSourceName, VhTable};
use super::receiver;
use super::wire::BITS;
use crate::range::whole;

/// Time of day whose sentence is as long as any, s since 1970.
const LONG_TIME_S: u64 = 1_790_000_000;

/// Bytes per second of the messages on each wire; 0 for a wire that is not there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct WireLoad {
    pub(super) receiver: f64,
    pub(super) autopilot: f64,
}

impl WireLoad {
    /// Returns the load of a scenario's wires.
    pub(super) fn of(written: &MissionFile) -> Self {
        let sentences = Sentences::of(written);
        let line = &written.line;
        let per_s = |bytes: u32, rate_hz: f64| f64::from(bytes) * rate_hz;
        let mut load = Self {
            receiver: 0.0,
            autopilot: 0.0,
        };
        if line.receiver == ReceiverFormat::Nmea {
            let speed = receiver_table(written);
            load.receiver += speed.map_or(0.0, |table| per_s(sentences.speed, table.rate_hz));
            for table in &written.vh {
                if table.source == VhSourceName::Terrain {
                    load.receiver += per_s(sentences.altitude, table.rate_hz);
                }
            }
            if written.gnss.is_some() {
                load.receiver += per_s(sentences.time, 1.0);
            }
        }
        if line.autopilot == AutopilotFormat::Mavlink {
            load.autopilot += per_s(TRACK_AND_ATTITUDE_BYTES, written.attitude.reported_hz);
            for table in &written.vh {
                if table.source == VhSourceName::Altimeter {
                    load.autopilot += per_s(HEIGHT_BYTES, table.rate_hz);
                }
            }
        }
        load
    }
}

/// Returns the first table whose source has the receiver, which reports with it.
pub(super) fn receiver_table(written: &MissionFile) -> Option<&VhTable> {
    written.vh.iter().find(|table| table.source.has_receiver())
}

/// Bytes of a wire that carries so many per second.
pub(super) fn bytes_per_s(baud: i64) -> f64 {
    whole(baud) / BITS_OF_A_BYTE
}

/// Ages that the camera cannot see: time from the sending of a message to the stamp of its values,
/// s. The camera stamps them with the first byte, but not earlier than [`HEARD_WITHIN_US`] before
/// the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transport {
    /// Of a ground speed of the receiver.
    pub(super) ground_speed: f64,
    /// Of an altitude of the receiver.
    pub(super) altitude: f64,
    /// Of a height above ground of the autopilot.
    pub(super) height: f64,
    /// Of a speed of the autopilot.
    pub(super) autopilot_speed: f64,
}

impl Transport {
    /// Returns the ages of a scenario; 0 for messages that arrive whole.
    pub(super) fn of(written: &MissionFile) -> Self {
        let LineTable {
            receiver,
            baud,
            autopilot,
            autopilot_baud,
            ..
        } = written.line;
        let sentences = Sentences::of(written);
        let of_receiver = |before, bytes| match receiver {
            ReceiverFormat::Nmea => stamped_after_s(before, bytes, baud),
            ReceiverFormat::Whole => 0.0,
        };
        let of_autopilot = |bytes| match autopilot {
            AutopilotFormat::Mavlink => stamped_after_s(0, bytes, autopilot_baud),
            AutopilotFormat::Whole => 0.0,
        };
        let first = receiver_table(written).map(|table| table.source);
        // The altitude of a source that reports the speed, too, follows it.
        let before_altitude = match first {
            Some(VhSourceName::Terrain) => sentences.speed,
            _ => 0,
        };
        Self {
            ground_speed: of_receiver(0, sentences.speed),
            altitude: of_receiver(before_altitude, sentences.altitude),
            height: of_autopilot(HEIGHT_BYTES),
            autopilot_speed: of_autopilot(POSITION_BYTES),
        }
    }
}

/// Bits of a byte on a wire, as a number.
#[expect(clippy::cast_precision_loss, reason = "ten")]
const BITS_OF_A_BYTE: f64 = BITS as f64;

/// Returns the time from the sending of a message, behind other bytes, to its stamp, s.
fn stamped_after_s(before: u32, bytes: u32, baud: i64) -> f64 {
    let arrival_s = |bytes: u32| f64::from(bytes) / bytes_per_s(baud);
    let earliest_s = arrival_s(before + bytes) - seconds(HEARD_WITHIN_US);
    arrival_s(before + 1).max(earliest_s)
}

/// Bytes of the receiver's sentences at the speed and height of a flight.
struct Sentences {
    speed: u32,
    altitude: u32,
    time: u32,
}

impl Sentences {
    fn of(written: &MissionFile) -> Self {
        let bytes = |sentence: &str| u32::try_from(sentence.len()).unwrap_or(u32::MAX);
        let speed_m_s = single(written.flight.speed_m_s);
        Self {
            speed: bytes(&receiver::speed(speed_m_s)),
            altitude: bytes(&receiver::altitude(single(written.flight.height_m))),
            time: bytes(&receiver::time(LONG_TIME_S, Some(speed_m_s))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mission::scenario::MissionScenario;

    #[test]
    fn load_and_transport_of_the_nominal_mission_are_those_computed_by_hand() {
        let written = MissionScenario::nominal(Some(1)).unwrap().written;
        let load = WireLoad::of(&written);
        // VTG of 42 bytes ten times a second and RMC of 50 once; ALTITUDE of 44 bytes ten times,
        // GLOBAL_POSITION_INT and ATTITUDE of 40 bytes each fifty times.
        let expected = [10.0 * 42.0 + 50.0, 10.0 * 44.0 + 50.0 * 80.0];
        for (found, expected) in [load.receiver, load.autopilot].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        let transport = Transport::of(&written);
        // 42 bytes at 3840 per second less 5 ms; 44 bytes at 5760.
        assert!((transport.ground_speed - (42.0 / 3840.0 - 0.005)).abs() < 1e-9);
        assert!((transport.height - (44.0 / 5760.0 - 0.005)).abs() < 1e-9);
    }

    #[test]
    fn short_message_is_stamped_with_its_first_byte() {
        assert!((stamped_after_s(0, 10, 115_200) - 1.0 / 11_520.0).abs() < 1e-12);
        assert!((stamped_after_s(45, 50, 9600) - (95.0 / 960.0 - 0.005)).abs() < 1e-12);
    }
}
