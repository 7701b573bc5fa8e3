//! The description beside a rectified frame.

use std::fs;
use std::io;
use std::path::Path;
use std::time::SystemTime;

use serde::{Deserialize, Serialize};

use super::exposure::RecordedExposure;
use super::options::Options;

/// Content of the JSON file beside a rectified frame.
///
/// It depends on frame, record, camera, options and version alone. The time of its file's last
/// change is that of the frame's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Sidecar {
    /// Version of the program.
    pub(super) version: String,
    pub(super) input: Input,
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
    pub(super) file: String,
    pub(super) bytes: u64,
    /// CRC-32 of layout and tags.
    pub(super) description_crc32: String,
    /// CRC-32 of the samples, in the order of rows, pixels and bands, low byte first.
    pub(super) pixels_crc32: String,
}

/// Length of a file and the time of its last change, by which a change is noticed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FileState {
    pub(super) bytes: u64,
    changed: Option<SystemTime>,
}

impl FileState {
    pub(super) fn of(path: &Path) -> io::Result<Self> {
        let metadata = fs::metadata(path)?;
        Ok(Self {
            bytes: metadata.len(),
            changed: metadata.modified().ok(),
        })
    }

    /// Gives a file the time of the last change. It stays as it is where the file system refuses.
    pub(super) fn mark(&self, path: &Path) {
        if let Some(changed) = self.changed
            && let Ok(file) = fs::File::options().write(true).open(path)
        {
            let _ = file.set_modified(changed);
        }
    }

    /// Returns true if a file has the time of the last change.
    pub(super) fn has_marked(&self, path: &Path) -> bool {
        let marked = fs::metadata(path).and_then(|metadata| metadata.modified());
        self.changed.is_some() && marked.ok() == self.changed
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
