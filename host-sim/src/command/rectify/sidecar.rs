//! The description beside a rectified frame.

use std::fs;
use std::io;
use std::path::Path;
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};

use super::exposure::RecordedExposure;
use super::options::Options;

/// Content of the JSON file beside a rectified frame.
///
/// It depends on frame, record, camera, options and version alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Sidecar {
    /// Version of the program.
    pub(super) version: String,
    pub(super) input: Input,
    /// CRC-32 of the samples, in the order of rows, pixels and bands, low byte first.
    pub(super) input_pixels_crc32: String,
    pub(super) camera: CameraName,
    pub(super) record: RecordedExposure,
    pub(super) options: Options,
    pub(super) output: Output,
    pub(super) interior_orientation: Interior,
    pub(super) accuracy: Accuracy,
}

/// The frame as the camera recorded it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Input {
    file: String,
    bytes: u64,
    /// Time of the last change, ns since 1970.
    modified_unix_ns: Option<u64>,
}

impl Input {
    /// Describes a file; its name is that in its folder.
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        let metadata = fs::metadata(path)?;
        let modified = metadata.modified().ok();
        let since_1970 = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let name = path.file_name().unwrap_or_default();
        Ok(Self {
            file: name.to_string_lossy().into_owned(),
            bytes: metadata.len(),
            modified_unix_ns: since_1970.and_then(|time| u64::try_from(time.as_nanos()).ok()),
        })
    }
}

/// The camera of the frame.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct CameraName {
    pub(super) name: String,
    /// CRC-32 of the calibration, as records have it.
    pub(super) calibration_crc32: String,
}

/// The rectified image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Output {
    pub(super) file: String,
    pub(super) bytes: u64,
    pub(super) width_px: u32,
    pub(super) height_px: u32,
    pub(super) bands: u16,
    pub(super) bits: u16,
    pub(super) pixels_crc32: String,
    /// Pixels without a source on the sensor, which are 0.
    pub(super) border_pixels: u64,
    pub(super) border_percent: f64,
}

/// Interior orientation of the rectified image: that of a camera without distortion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Interior {
    pub(super) principal_distance_mm: f64,
    pub(super) pixel_um: f64,
    /// From the centre of the rectified image, x to the right, y up.
    pub(super) principal_point_mm: [f64; 2],
    /// Column and row, the centre of the first pixel being (0, 0).
    pub(super) principal_point_px: [f64; 2],
    /// Column and row, the corner of the first pixel being (0, 0).
    pub(super) principal_point_from_corner_px: [f64; 2],
    /// That of the recorded frame, sensor frame.
    pub(super) recorded_principal_point_mm: [f64; 2],
}

/// Accuracy of the places of the pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Accuracy {
    pub(super) mesh_spacing_px: u32,
    /// Upper bound of the error of linear interpolation in the mesh.
    pub(super) mesh_bound_px: f64,
}

impl Sidecar {
    /// Reads the description of a rectified frame; `None` if there is none, or one that is not
    /// whole.
    pub(super) fn read(path: &Path) -> Option<Self> {
        serde_json::from_slice(&fs::read(path).ok()?).ok()
    }
}
