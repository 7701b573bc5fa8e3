//! Fuzz targets of files that people write or that come from other programs, and their properties.
//! Tests of host-sim run the same functions over damaged files.
//!
//! Each target returns whether the input was accepted.

use std::collections::BTreeSet;
use std::path::Path;

use fmc_camera::flight::camera::Camera;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::number::single;
use fmc_camera_file::{CameraFile, InputError};
use fmc_exchange::found::Stated;
use fmc_exchange::import::import;
use fmc_exchange::program::Program;
use fmc_exchange::source::Source;
use fmc_frames::{FlightFrame, FrameCamera, records};
use fmc_simulation::mission::aircraft::Aircraft;
use fmc_simulation::mission::scenario::MissionScenario;
use host_sim::formats::npy_header::NpyHeader;

/// Camera of scenarios, records and imports.
const CAMERA: &str = include_str!("../host-sim/scenarios/cameras/mission.toml");

/// Checks that an error begins with the name of the file.
fn refused(file: &str, error: &InputError) -> bool {
    let message = error.to_string();
    assert!(message.starts_with(file), "{message}");
    false
}

/// Reads a camera file: one that is accepted makes a camera whose exposures have finite points.
pub(crate) fn camera_file(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    let (file, camera) = match CameraFile::parse("camera.toml", text) {
        Ok(read) => read,
        Err(error) => return refused("camera.toml", &error),
    };
    assert!(Camera::new(file.parameters()).is_ok());
    let [vh_per_s, exposure_s] = [file.limits.vh_per_s, file.limits.exposure_s];
    let half_mm = file.half_format_mm();
    for [vh_per_s, exposure_s] in [
        [vh_per_s[0], exposure_s[0]],
        [vh_per_s[1], exposure_s[0]],
        [vh_per_s[0], exposure_s[1]],
    ] {
        // A mechanism may be too short for it.
        let Ok(frame) = camera.frame(&Exposure::new(single(vh_per_s), single(exposure_s))) else {
            continue;
        };
        for [right, up] in [
            [0.0, 0.0],
            [1.0, 1.0],
            [-1.0, 1.0],
            [-1.0, -1.0],
            [1.0, -1.0],
        ] {
            let [x_mm, y_mm] = [right * half_mm[0], up * half_mm[1]].map(single);
            let ideal = frame.correction.correct(SensorPoint { x_mm, y_mm }).point;
            assert!(
                ideal.x_mm.is_finite() && ideal.y_mm.is_finite(),
                "{ideal:?}"
            );
        }
    }
    true
}

/// Reads a scenario of a mission: the aircraft of one that is accepted has a V/H.
pub(crate) fn scenario(bytes: &[u8]) -> bool {
    let Ok(text) = str::from_utf8(bytes) else {
        return false;
    };
    let read = MissionScenario::parse_of_texts("mission.toml", text, |_: &Path| {
        CameraFile::parse("camera.toml", CAMERA)
    });
    let scenario = match read {
        Ok(scenario) => scenario,
        Err(error) => return refused("mission.toml", &error),
    };
    assert!(scenario.interval_s.is_finite() && scenario.interval_s > 0.0);
    let aircraft = Aircraft::of(&scenario, scenario.seed());
    for exposure in 0..3 {
        let flight = aircraft.speed_and_height(f64::from(exposure) * scenario.interval_s);
        assert!(flight.vh_per_s().is_finite());
    }
    true
}

/// Reads a file as that of every program: what is accepted has finite numbers.
pub(crate) fn imports(bytes: &[u8]) -> bool {
    let source = Source {
        file: "a.file",
        bytes,
    };
    let stated = Stated {
        size_px: Some([14204, 10652]),
        is_correction: Some(true),
        pixel_mm: Some(0.003_76),
        ..Stated::default()
    };
    let mut is_read = false;
    for program in Program::READ {
        is_read |= match import(program, &source, &stated) {
            Ok(imported) => {
                assert!(imported.camera.principal_distance_mm.is_finite());
                assert!(imported.residual.rms_um.is_finite());
                true
            }
            Err(error) => refused("a.file", &error),
        };
    }
    is_read
}

/// Reads records: exposures that are accepted have numbers that a block can take, and no sequence
/// comes twice.
pub(crate) fn records(bytes: &[u8]) -> bool {
    let (file, _) = CameraFile::parse("camera.toml", CAMERA).unwrap();
    let camera = FrameCamera::new("camera.toml", &file).unwrap();
    let mut sequences = BTreeSet::new();
    let read = records::read_from("records", bytes, &camera, |frame: FlightFrame| {
        assert!(sequences.insert(frame.sequence));
        if let Some(exposed) = frame.exposed() {
            let interior = &exposed.interior;
            assert!(interior.principal_distance_mm.is_finite());
            assert!(interior.principal_point.x_mm.is_finite());
            assert!(interior.principal_point.y_mm.is_finite());
        }
        Ok::<(), InputError>(())
    });
    match read {
        Ok(()) => true,
        Err(error) => refused("records", &error),
    }
}

/// Reads the header of an array: one in C order is written and read again.
pub(crate) fn npy(mut bytes: &[u8]) -> bool {
    let Ok(header) = NpyHeader::read(&mut bytes) else {
        return false;
    };
    if header.is_fortran_order {
        return true;
    }
    let mut written = Vec::new();
    if NpyHeader::write_described(&header.description, &header.shape, &mut written).is_ok() {
        assert_eq!(written.len() % 64, 0, "place of the first number");
        let again = NpyHeader::read(&mut written.as_slice()).unwrap();
        assert_eq!(again, header);
    }
    true
}
