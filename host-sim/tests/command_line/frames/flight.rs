//! A flight of the test camera: its records as files, and the corrections that the camera computed.

use std::fmt::Write as _;
use std::fs::{self, File};

use fmc_camera::flight::calibration_id::{CalibrationId, SerialNumber, Storage};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::fault::Faults;
use fmc_camera::flight::frame_record::{ExposedFrame, Flags, FrameRecord, Outcome, Reason};
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera_file::CameraFile;
use fmc_frames::FrameCamera;
use fmc_report::records;

use crate::command_line::support::{Bench, CAMERA};

/// σ of every frame: 30 nm of its own and 40 nm of the flight.
pub(super) const SIGMA_UM: f64 = 0.05;

/// Start of the camera's clock in Unix time, µs.
pub(super) const UNIX_US: u64 = 1_790_000_000_000_000;

/// Number of the refused trigger.
pub(in crate::command_line) const REFUSED: u32 = 5;

/// A folder with `records.csv` and `records.json` of eight exposures, the fifth refused.
pub(in crate::command_line) struct Flight {
    pub(in crate::command_line) bench: Bench,
    /// Corrections by the numbers of the frames, from 1.
    pub(in crate::command_line) corrections: Vec<FrameCorrection>,
    /// c̄ of each, mm.
    pub(in crate::command_line) centroids_mm: Vec<f32>,
    /// κ of each.
    pub(in crate::command_line) enlargements: Vec<f32>,
}

pub(super) fn flight() -> Flight {
    flight_of(CAMERA)
}

/// Returns the flight of a camera with this file.
pub(in crate::command_line) fn flight_of(text: &str) -> Flight {
    flight_with(text, &[])
}

/// Returns the flight of a camera whose file names these residual grids; the corrections are those
/// of its polynomial.
pub(in crate::command_line) fn flight_with(text: &str, grids: &[(&str, &[u8])]) -> Flight {
    let bench = Bench::with(text, b"");
    for (name, bytes) in grids {
        fs::write(bench.path(name), bytes).unwrap();
    }
    let (file, _, grids) = CameraFile::read_with_grids(&bench.path("camera.toml")).unwrap();
    let camera = FrameCamera::with_grids("camera.toml", &file, grids).unwrap();
    let (crc, camera) = (camera.crc(), camera.camera());
    let (mut flown, mut corrections) = (Vec::new(), Vec::new());
    let (mut centroids_mm, mut enlargements) = (Vec::new(), Vec::new());
    for sequence in 1_u16..=8 {
        let number = f32::from(sequence);
        let exposure = Exposure {
            focus_shift_um: number - 4.0,
            opening_offset_mm: Some(0.03 * number),
            ..Exposure::new(0.06 + 0.01 * number, 0.004)
        };
        // As measured: the plan, with another centroid and another variance.
        let mut motion = camera.motion(&exposure).unwrap();
        motion.centroid_mm += 1e-4 * number;
        motion.moments.second *= 1.01;
        let frame = camera.frame_of(&exposure, &motion).unwrap();
        corrections.push(frame.correction);
        centroids_mm.push(motion.centroid_mm);
        enlargements.push(frame.interior.enlargement);
        let time = Time::from_us(1_000_000 * u64::from(sequence));
        let exposed = ExposedFrame {
            opened: time,
            closed: time,
            centroid: time,
            centroid_utc: Some(UtcTime {
                unix_us: UNIX_US + 1_000_000 * u64::from(sequence),
                sigma_s: 2e-6,
            }),
            vh: None,
            planned_opening_mm: 0.0,
            planned_travel_mm: 0.0,
            interior: frame.interior,
            principal_point_sigma: PrincipalPointSigma {
                frame_mm: 3e-5,
                common_mm: 4e-5,
            },
            smear_um: 0.1,
            smear_px: 0.1,
        };
        let is_refused = u32::from(sequence) == REFUSED;
        flown.push(FrameRecord {
            sequence: sequence.into(),
            trigger: time,
            outcome: if is_refused {
                Outcome::Refused(Reason::NotAtSpeed)
            } else {
                Outcome::Exposed(exposed)
            },
            faults: Faults::NONE,
            flags: Flags::NONE,
            calibration: Some(CalibrationId {
                serial: SerialNumber::EMPTY,
                version: 0,
                crc,
                storage: Storage::Volatile,
            }),
            boot: 1,
            flight: 1,
        });
    }
    let csv = File::create(bench.path("records.csv")).unwrap();
    records::write_csv(&flown, csv).unwrap();
    let json = File::create(bench.path("records.json")).unwrap();
    records::write_json(Some(&file.name), &flown, None, json).unwrap();
    let mut images = String::from("sequence,image\n");
    for sequence in 1..=8 {
        writeln!(images, "{sequence},\"IMG, {sequence:03}.tif\"").unwrap();
    }
    fs::write(bench.path("images.csv"), images).unwrap();
    Flight {
        bench,
        corrections,
        centroids_mm,
        enlargements,
    }
}

/// Arguments that name camera and records.
pub(super) const RECORDS: [&str; 4] = ["--camera", "camera.toml", "--records", "records.csv"];
