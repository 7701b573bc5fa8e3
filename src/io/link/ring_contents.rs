//! Contents of an entry in the ring of records.

use serde::{Deserialize, Serialize};

use crate::flight::calibration_id::{CalibrationId, Storage};
use crate::flight::flown_calibrations::{EARLIER_CALIBRATIONS, Earlier};
use crate::flight::frame_record::Outcome;
use crate::flight::in_doubt::InDoubt;
use crate::flight::record_log::{Entry, Range};
use crate::flight::time::Time;

/// An entry: a record, or what has changed beside the records.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct RingContents {
    /// Number of the camera's start: of a record, that in which its trigger came.
    pub(super) boot: u32,
    pub(super) flight: FlightNow,
    pub(super) kind: Kind,
}

/// State of a flight when an entry is written.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct FlightNow {
    /// Its number.
    pub(super) number: u32,
    /// The camera is armed, or a frame is in flight.
    pub(super) is_busy: bool,
    /// Number of records with an exposure.
    pub(super) exposed: u32,
    /// Number of the last record that is acknowledged; 0 before the first.
    pub(super) acknowledged: u32,
    /// Exposures that nobody has confirmed.
    pub(super) unconfirmed: Option<Unconfirmed>,
}

/// Exposures up to the last that a crossing of the index mark was still to confirm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Unconfirmed {
    /// Number of exposures before the last.
    before: u32,
    /// [`InDoubt::off_mm`].
    off_mm: f32,
}

/// Kind of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) enum Kind {
    /// The flight has begun, goes on in another sector, or its state has changed.
    Flight {
        calibration: CalibrationId,
        /// Calibrations before it in the flight.
        earlier: [Option<EarlierNumbers>; EARLIER_CALIBRATIONS],
        last_sequence: u32,
        /// Triggers refused for want of room.
        refused: Option<Range>,
    },
    /// A record whose times are [relative](relative).
    Record(Entry),
}

/// A calibration that another has taken the place of, without the serial number, which is that of
/// the present one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct EarlierNumbers {
    /// Number of the last trigger before the exchange.
    last_sequence: u32,
    /// Version, CRC and place; `None` of a calibration without identity, or of another camera's:
    /// the record says then that its calibration is not known.
    numbers: Option<(u32, u32, Storage)>,
}

impl EarlierNumbers {
    /// Returns the numbers of a calibration that was in use before another.
    pub(super) fn of(earlier: Earlier, present: CalibrationId) -> Self {
        let id = earlier.id.filter(|id| id.serial == present.serial);
        Self {
            last_sequence: earlier.last_sequence,
            numbers: id.map(|id| (id.version, id.crc, id.storage)),
        }
    }

    /// Returns the calibration that was in use before another.
    pub(super) fn earlier(self, present: CalibrationId) -> Earlier {
        Earlier {
            last_sequence: self.last_sequence,
            id: self.numbers.map(|(version, crc, storage)| CalibrationId {
                serial: present.serial,
                version,
                crc,
                storage,
            }),
        }
    }
}

impl Unconfirmed {
    /// Returns those of a controller whose last record has this number.
    pub(super) fn of(in_doubt: Option<InDoubt>, last_sequence: u32) -> Option<Self> {
        let in_doubt = in_doubt?;
        Some(Self {
            before: last_sequence.saturating_sub(in_doubt.from_sequence),
            off_mm: in_doubt.off_mm,
        })
    }

    /// The exposures, up to the last record.
    pub(super) fn in_doubt(self, last_sequence: u32) -> InDoubt {
        let from = last_sequence.saturating_sub(self.before);
        InDoubt::between([from, last_sequence], self.off_mm, false)
    }
}

/// Returns an entry with the times of its exposure counted from the trigger, which takes fewer
/// bytes; forwards and backwards in turn, so that any time stays exact.
pub(super) fn relative(mut entry: Entry) -> Entry {
    if let Outcome::Exposed(frame) = &mut entry.outcome {
        for time in [&mut frame.opened, &mut frame.closed, &mut frame.centroid] {
            let since = time.us().wrapping_sub(entry.trigger.us()).cast_signed();
            *time = Time::from_us((since << 1 ^ since >> 63).cast_unsigned());
        }
    }
    entry
}

/// Returns the entry whose times are [`relative`].
pub(super) fn absolute(mut entry: Entry) -> Entry {
    if let Outcome::Exposed(frame) = &mut entry.outcome {
        for time in [&mut frame.opened, &mut frame.closed, &mut frame.centroid] {
            let coded = time.us();
            let since = coded >> 1 ^ (coded & 1).wrapping_neg();
            *time = Time::from_us(entry.trigger.us().wrapping_add(since));
        }
    }
    entry
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flight::camera::{Camera, CameraParameters};
    use crate::flight::exposure::Exposure;
    use crate::flight::fault::{Fault, Faults};
    use crate::flight::flag::{Flag, Flags};
    use crate::flight::frame_record::ExposedFrame;
    use crate::flight::principal_point_sigma::PrincipalPointSigma;
    use crate::flight::utc::UtcTime;
    use crate::flight::vh::{VhEstimate, VhSource};
    use crate::geometry::calibration::CalibrationParameters;
    use crate::io::store::record_ring::CONTENTS_BYTES;

    /// Number that no count reaches before the flash is worn: 10,000 erasures of 4,086 places.
    const MOST: u32 = 1 << 28;
    /// A time after 17 years, µs, and one of the year 2255 since 1970.
    const LATE_US: u64 = (1 << 49) - 1;
    const LATE_UNIX_US: u64 = (1 << 53) - 1;

    /// An exposure in which nothing is left out, its last light so long after the trigger.
    fn longest(lasting_us: u64) -> Entry {
        let lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
        let camera = Camera::new(CameraParameters::new(lens)).unwrap();
        let interior = camera.frame(&Exposure::new(0.1, 0.005)).unwrap().interior;
        let (mut faults, mut flags) = (Faults::NONE, Flags::NONE);
        for fault in Fault::ALL {
            faults.insert(fault);
        }
        for flag in Flag::ALL {
            flags.insert(flag);
        }
        let trigger = LATE_US - lasting_us;
        Entry {
            sequence: MOST - 1,
            trigger: Time::from_us(trigger),
            outcome: Outcome::Exposed(ExposedFrame {
                opened: Time::from_us(trigger + lasting_us / 4),
                closed: Time::from_us(trigger + lasting_us),
                centroid: Time::from_us(trigger + lasting_us / 2),
                centroid_utc: Some(UtcTime {
                    unix_us: LATE_UNIX_US,
                    sigma_s: f32::MAX,
                }),
                vh: Some(VhEstimate {
                    vh_per_s: f32::MAX,
                    sigma_per_s: f32::MAX,
                    age_s: f32::MAX,
                    source: VhSource::Terrain,
                    extrapolated: true,
                }),
                planned_opening_mm: f32::MIN,
                planned_travel_mm: f32::MIN,
                interior,
                principal_point_sigma: PrincipalPointSigma {
                    frame_mm: f32::MAX,
                    common_mm: f32::MAX,
                },
                smear_um: f32::MAX,
                smear_px: f32::MAX,
            }),
            faults,
            flags,
        }
    }

    fn now() -> FlightNow {
        FlightNow {
            number: MOST - 1,
            is_busy: true,
            exposed: MOST - 1,
            acknowledged: MOST - 1,
            unconfirmed: Unconfirmed::of(
                Some(InDoubt::between([MOST - 100, MOST - 1], 0.1, false)),
                MOST - 1,
            ),
        }
    }

    fn bytes(contents: &RingContents) -> usize {
        let mut buffer = [0; 2 * CONTENTS_BYTES];
        let bytes = postcard::to_slice(contents, &mut buffer).unwrap();
        assert_eq!(
            postcard::from_bytes::<RingContents>(bytes).as_ref(),
            Ok(contents)
        );
        bytes.len()
    }

    #[test]
    fn longest_record_of_a_long_flight_fits_an_entry() {
        // A minute from the trigger to the last light.
        let entry = longest(60_000_000);
        let contents = RingContents {
            boot: MOST - 1,
            flight: now(),
            kind: Kind::Record(relative(entry)),
        };
        let length = bytes(&contents);
        // Another field has to find room first.
        assert!((160..=CONTENTS_BYTES).contains(&length), "{length}");
    }

    #[test]
    fn state_of_a_flight_fits_an_entry() {
        use crate::flight::calibration_id::SerialNumber;
        let earlier = EarlierNumbers {
            last_sequence: u32::MAX,
            numbers: Some((u32::MAX, u32::MAX, Storage::Stored)),
        };
        let contents = RingContents {
            boot: u32::MAX,
            flight: now(),
            kind: Kind::Flight {
                calibration: CalibrationId {
                    serial: SerialNumber::new("0123456789abcdef").unwrap(),
                    version: u32::MAX,
                    crc: u32::MAX,
                    storage: Storage::Stored,
                },
                earlier: [Some(earlier); EARLIER_CALIBRATIONS],
                last_sequence: u32::MAX,
                refused: None,
            },
        };
        // A range of refused triggers takes 35 bytes more at most.
        assert!(bytes(&contents) + 35 <= CONTENTS_BYTES);
    }

    #[test]
    fn times_are_exact_whatever_they_are() {
        for lasting_us in [0, 1, 33_000, LATE_US] {
            let entry = longest(lasting_us);
            assert_eq!(absolute(relative(entry)), entry);
        }
        let mut backwards = longest(0);
        backwards.trigger = Time::from_us(u64::MAX);
        assert_eq!(absolute(relative(backwards)), backwards);
        let Outcome::Exposed(frame) = relative(longest(100)).outcome else {
            panic!("exposed");
        };
        let coded = [frame.opened, frame.closed, frame.centroid].map(Time::us);
        assert_eq!(coded, [50, 200, 100]);
    }
}
