//! Frame records as files for the block adjustment: `records.csv` and `records.json`.

use std::borrow::Cow;
use std::io::{self, Write};

use crc::{CRC_32_ISO_HDLC, Crc};
use fmc_camera::flight::frame_record::FrameRecord;
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_frames::record_files::RecordDocument;
use fmc_frames::row::Row;
pub use fmc_frames::row::{write_csv, write_row};

/// Meaning of a record's numbers, for readers of the file without this program.
const CONVENTIONS: [&str; 6] = [
    "sensor frame: upright image, origin at the centre of the pixel array, x right, y up, mm",
    "principal_point and centroid time are means over the exposure and belong together: use them as a pair",
    "principal_distance_mm goes with coordinates that were corrected for this frame; it does not contain the focus shift",
    "offsets and travel are along the FMC axis, from the calibrated position",
    "times in us are the camera's own clock since it started; centroid_unix_us is UTC without leap seconds, where a time pulse has set it",
    "refused triggers have a reason and no exposure; no trigger is left out",
];

/// Writes `records.json`; `in_doubt` are exposures that the records hold as such already.
///
/// # Errors
/// Those of the sink.
pub fn write_json(
    camera: Option<&str>,
    records: &[FrameRecord],
    in_doubt: Option<InDoubt>,
    sink: impl Write,
) -> io::Result<()> {
    let document = RecordDocument {
        camera: camera.map(str::to_owned),
        conventions: CONVENTIONS.map(Cow::Borrowed).to_vec(),
        records_crc32: format!("{:08x}", crc32(records)),
        in_doubt,
        records: records.iter().map(Row::of).collect(),
    };
    document.write(sink)
}

/// Returns the CRC-32 of all records as the link carries them: two flights with the same one have
/// the same records, bit for bit.
#[must_use]
pub fn crc32(records: &[FrameRecord]) -> u32 {
    let crc = Crc::<u32>::new(&CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    for record in records {
        if let Ok(bytes) = postcard::to_allocvec(record) {
            digest.update(&bytes);
        }
    }
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::calibration_id::{CalibrationId, SerialNumber, Storage};
    use fmc_camera::flight::camera::{Camera, CameraParameters};
    use fmc_camera::flight::exposure::Exposure;
    use fmc_camera::flight::fault::{Fault, Faults};
    use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Flags, Outcome, Reason};
    use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
    use fmc_camera::flight::time::Time;
    use fmc_camera_file::CameraFile;

    use fmc_frames::row;

    use super::*;

    fn camera() -> (CameraParameters, Camera) {
        let text = "name = \"bare\"\nprincipal_distance_mm = 100.0\n\
                    [sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n";
        let (file, camera) = CameraFile::parse("bare.toml", text).unwrap();
        (file.parameters(), camera)
    }

    fn calibration() -> CalibrationId {
        CalibrationId {
            serial: SerialNumber::new("5282").unwrap(),
            version: 3,
            crc: 0xdead_beef,
            storage: Storage::Stored,
        }
    }

    fn records() -> Vec<FrameRecord> {
        let (_, camera) = camera();
        let frame = camera.frame(&Exposure::new(0.1, 0.004)).unwrap();
        let mut flags = Flags::NONE;
        flags.insert(Flag::OffCentre);
        flags.insert(Flag::LastGoodVh);
        let exposed = FrameRecord {
            sequence: 1,
            trigger: Time::from_us(2_000_000),
            outcome: Outcome::Exposed(ExposedFrame {
                opened: Time::from_us(2_030_000),
                closed: Time::from_us(2_034_000),
                centroid: Time::from_us(2_032_000),
                centroid_utc: None,
                vh: None,
                planned_opening_mm: -0.02,
                planned_travel_mm: 0.04,
                interior: frame.interior,
                principal_point_sigma: PrincipalPointSigma {
                    frame_mm: 6e-5,
                    common_mm: 8e-5,
                },
                smear_um: 0.5,
                smear_px: 0.06,
            }),
            faults: Faults::NONE,
            flags,
            calibration: Some(calibration()),
            boot: 1,
            flight: 1,
        };
        let mut faults = Faults::NONE;
        faults.insert(Fault::Stall);
        let refused = FrameRecord {
            sequence: 2,
            trigger: Time::from_us(3_000_000),
            outcome: Outcome::Refused(Reason::Fault(Fault::Stall)),
            faults,
            flags: Flags::NONE,
            calibration: Some(calibration()),
            boot: 1,
            flight: 1,
        };
        vec![exposed, refused]
    }

    #[test]
    fn every_column_has_its_name_and_refused_triggers_leave_the_exposure_empty() {
        let mut csv = Vec::new();
        write_csv(&records(), &mut csv).unwrap();
        let mut reader = csv::Reader::from_reader(csv.as_slice());
        let names: Vec<String> = reader.headers().unwrap().iter().map(Into::into).collect();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let field = |row: usize, name: &str| {
            let column = names.iter().position(|one| one == name).unwrap();
            rows[row].get(column).unwrap().to_owned()
        };
        assert_eq!(field(0, "outcome"), "exposed");
        assert_eq!(field(0, "flags"), "last good V/H; off centre");
        assert_eq!(field(0, "calibration_crc32"), "deadbeef");
        assert_eq!(field(0, "calibration_serial"), "5282");
        assert_eq!(field(0, "calibration_version"), "3");
        assert_eq!(field(1, "calibration_storage"), "stored");
        assert_eq!(
            names[40..41],
            ["calibration_crc32"],
            "columns are added at the end"
        );
        // With a centred run-up the principal point is the calibrated one, to a rounding of 20 µm
        // in single precision.
        let y: f64 = field(0, "principal_point_y_mm").parse().unwrap();
        assert!(y.abs() < 1e-8);
        assert_eq!(field(1, "outcome"), "refused");
        assert_eq!(field(1, "reason"), "stall");
        assert_eq!(field(1, "faults"), "stall");
        assert_eq!(field(1, "principal_point_x_mm"), "");
    }

    #[test]
    fn names_of_the_columns_are_the_keys_of_the_json_file_in_their_order() {
        let mut json = Vec::new();
        write_json(Some("bare"), &records(), None, &mut json).unwrap();
        let text = String::from_utf8(json).unwrap();
        let mut from = text.find("\"records\"").unwrap();
        for name in row::NAMES {
            let key = format!("\"{name}\":");
            from += text[from..].find(&key).unwrap_or_else(|| panic!("{name}"));
        }
        let value: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["records"][1]["faults"][0], "stall");
        assert_eq!(value["records"][0]["flags"][1], "off centre");
        assert!(value["records"][1]["opened_us"].is_null());
    }

    #[test]
    fn what_is_not_known_of_a_calibration_is_left_empty() {
        let mut records = records();
        records[0].calibration = Some(CalibrationId {
            serial: SerialNumber::EMPTY,
            version: 0,
            ..calibration()
        });
        records[1].calibration = None;
        let mut csv = Vec::new();
        write_csv(&records, &mut csv).unwrap();
        let text = String::from_utf8(csv).unwrap();
        let rows: Vec<&str> = text.lines().collect();
        assert!(
            rows[1].contains(",deadbeef,") && rows[1].ends_with(",,,stored,1,1"),
            "{}",
            rows[1]
        );
        assert!(
            rows[2].contains(",00000000,") && rows[2].ends_with(",,,,,,1,1"),
            "{}",
            rows[2]
        );
    }

    #[test]
    fn one_bit_of_a_record_changes_the_checksum() {
        let mut other = records();
        other[1].trigger = Time::from_us(3_000_001);
        assert_ne!(crc32(&records()), crc32(&other));
        assert_eq!(crc32(&records()), crc32(&records()));
    }
}
