//! A flight, and its records as files.

use std::borrow::Cow;
use std::cell::RefCell;

use fmc_camera::flight::calibration_id::{CalibrationId, SerialNumber, Storage};
use fmc_camera::flight::camera::{Camera, Frame as CameraFrame};
use fmc_camera::flight::exposure::{CorrectionModel, Exposure};
use fmc_camera::flight::fault::{Fault, Faults};
use fmc_camera::flight::frame_record::{ExposedFrame, Flag, Flags, FrameRecord, Outcome, Reason};
use fmc_camera::flight::principal_point_sigma::PrincipalPointSigma;
use fmc_camera::flight::time::Time;
use fmc_camera::flight::utc::UtcTime;
use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_camera_file::{CameraFile, InputError};
use fmc_frames::row::{Row, write_csv};
use fmc_frames::{FlightFrame, FrameCamera, records};

pub(crate) const IXM: &str =
    include_str!("../../../../host-sim/cameras/phase-one-ixm-rs150f-50.toml");

/// A camera with a run-out and five coefficients.
pub(crate) fn camera() -> (CameraFile, FrameCamera) {
    let text = format!(
        "{IXM}\n[fmc]\nflatness_um = [2.0, 3.0]\n[fitted]\nkm0 = 1e-4\nkm1 = 2e-8\nkm2 = 1e-11\n\
         kd1 = 3e-8\npm1 = 1e-7\n"
    );
    let (file, _) = CameraFile::parse("camera.toml", &text).unwrap();
    let camera = FrameCamera::new("camera.toml", &file).unwrap();
    (file, camera)
}

/// A flight of exposures of all models, each with the frame that the camera computed, and a
/// refused trigger at the end.
pub(crate) fn flight(camera: &Camera, crc: u32) -> (Vec<FrameRecord>, Vec<CameraFrame>) {
    let mut random = fastrand::Rng::with_seed(6);
    let mut frames = Vec::new();
    let mut flown = Vec::new();
    for sequence in 1..=200 {
        let exposure = Exposure {
            focus_shift_um: 20.0 * (random.f32() - 0.5),
            focus_sign: [FocusSign::Physical, FocusSign::Printed][random.usize(..2)],
            model: [
                CorrectionModel::Exact,
                CorrectionModel::Exact,
                CorrectionModel::Fitted,
                CorrectionModel::Static,
            ][random.usize(..4)],
            opening_offset_mm: Some(0.1 * (random.f32() - 0.5)),
            ..Exposure::new(0.05 + 0.1 * random.f32(), 0.001 + 0.004 * random.f32())
        };
        // As measured: the plan, with another centroid and other moments.
        let mut motion = camera.motion(&exposure).unwrap();
        motion.centroid_mm += 1e-3 * (random.f32() - 0.5);
        motion.moments.second *= 1.0 + 0.1 * random.f32();
        motion.moments.third = 1e-9 * (random.f32() - 0.5);
        let frame = camera.frame_of(&exposure, &motion).unwrap();
        flown.push(frame);
        let mut flags = Flags::NONE;
        flags.insert(Flag::OffCentre);
        flags.insert(Flag::LastGoodVh);
        frames.push(FrameRecord {
            sequence,
            trigger: Time::from_us(2_000_000 * u64::from(sequence)),
            outcome: Outcome::Exposed(ExposedFrame {
                opened: Time::from_us(2_000_000 * u64::from(sequence) + 30_000),
                closed: Time::from_us(2_000_000 * u64::from(sequence) + 34_000),
                centroid: Time::from_us(2_000_000 * u64::from(sequence) + 32_000),
                centroid_utc: (sequence > 1).then(|| UtcTime {
                    unix_us: 1_790_000_000_000_000 + u64::from(sequence),
                    sigma_s: 2e-6,
                }),
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
            calibration: Some(calibration(crc)),
            boot: 1,
            flight: 1,
        });
    }
    let mut faults = Faults::NONE;
    faults.insert(Fault::Stall);
    frames.push(FrameRecord {
        sequence: 201,
        trigger: Time::from_us(500_000_000),
        outcome: Outcome::Refused(Reason::Fault(Fault::Stall)),
        faults,
        flags: Flags::NONE,
        calibration: Some(calibration(crc)),
        boot: 1,
        flight: 1,
    });
    (frames, flown)
}

fn calibration(crc: u32) -> CalibrationId {
    CalibrationId {
        serial: SerialNumber::new("5282").unwrap(),
        version: 3,
        crc,
        storage: Storage::Stored,
    }
}

/// The records as `records.csv`.
pub(crate) fn csv(records: &[FrameRecord]) -> String {
    let mut text = Vec::new();
    write_csv(records, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

/// The records as `records.json`.
pub(crate) fn json(records: &[FrameRecord]) -> String {
    let rows: Vec<_> = records
        .iter()
        .map(Row::<Vec<Cow<'static, str>>>::of)
        .collect();
    serde_json::to_string_pretty(&serde_json::json!({
        "camera": "iXM \"50\"",
        "conventions": ["records", {"records": [1]}],
        "records": rows,
        "behind": null,
    }))
    .unwrap()
}

/// Reads records from a text.
pub(crate) fn read(text: &str, camera: &FrameCamera) -> Result<Vec<FlightFrame>, InputError> {
    let frames = RefCell::new(Vec::new());
    records::read_from("records", text.as_bytes(), camera, |frame| {
        frames.borrow_mut().push(frame);
        Ok::<(), InputError>(())
    })?;
    Ok(frames.into_inner())
}
