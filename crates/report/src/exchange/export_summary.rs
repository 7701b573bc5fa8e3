//! Statement of an export: `export.json`, and the same for the terminal.

use fmc_camera_file::CameraFile;
use fmc_exchange::export::Exported;
use fmc_exchange::program::Program;
use serde::Serialize;

use super::{ExportedFlight, NAMES, residual};
use crate::hash::{crc32, sha256};
use crate::{length, terminal};

/// Statement of an export: files, conventions, residual. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExportSummary {
    /// Format, as the command line names it.
    pub format: &'static str,
    /// Model of the program.
    pub model: &'static str,
    /// Name of the camera.
    pub camera: String,
    /// Columns and rows, px.
    pub size_px: [i64; 2],
    /// Pixel pitch, µm.
    pub pixel_um: f64,
    /// Names of the files.
    pub files: Vec<String>,
    /// Direction of the formula: `ideal -> measured` or `measured -> ideal`.
    pub direction: &'static str,
    /// Meaning of the coefficients' sign.
    pub sign: &'static str,
    /// Unit of lengths and coefficients.
    pub unit: &'static str,
    /// Place that is (0, 0).
    pub origin: &'static str,
    /// Largest residual along one axis over the sensor, µm.
    pub residual_max_um: f64,
    /// Root of the mean square over both axes, µm.
    pub residual_rms_um: f64,
    /// Largest residual, px.
    pub residual_max_px: f64,
    /// Root of the mean square, px.
    pub residual_rms_px: f64,
    /// Place of the largest, mm in the sensor frame.
    pub at_mm: [f64; 2],
    /// Terms of the calibration without a place.
    pub not_held: Vec<NotHeldSummary>,
    /// Advice to the user of the program.
    pub advice: &'static str,
    /// SHA-256 of the camera file.
    pub calibration_sha256: String,
    /// CRC-32 of the calibration, as the frame records have it.
    pub calibration_crc32: String,
    /// Frames of a flight, if they were exported.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<ExportedFlight>,
}

/// A term without a place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotHeldSummary {
    /// Symbols.
    pub term: &'static str,
    /// Largest effect over the sensor, µm.
    pub size_um: f64,
}

impl ExportSummary {
    /// Name of its file, in the folder of the others.
    pub const FILE: &str = "export.json";

    /// Returns the statement of an export of a camera file with these bytes.
    #[must_use]
    pub fn of(camera: &CameraFile, bytes: &[u8], program: Program, exported: &Exported) -> Self {
        let conventions = program.conventions();
        let pixel_um = camera.sensor.pixel_um;
        let residual = exported.residual;
        Self {
            format: program.name(),
            model: exported.model,
            camera: camera.name.clone(),
            size_px: [camera.sensor.width_px, camera.sensor.height_px],
            pixel_um,
            files: exported
                .files
                .iter()
                .map(|(name, _)| name.clone())
                .collect(),
            direction: exported.formula.direction(),
            sign: conventions.sign,
            unit: conventions.unit,
            origin: conventions.origin,
            residual_max_um: residual.largest_um,
            residual_rms_um: residual.rms_um,
            residual_max_px: residual.largest_um / pixel_um,
            residual_rms_px: residual.rms_um / pixel_um,
            at_mm: residual.at_mm,
            not_held: exported
                .not_held
                .iter()
                .map(|one| NotHeldSummary {
                    term: one.term,
                    size_um: one.size_um,
                })
                .collect(),
            advice: conventions.advice,
            calibration_sha256: sha256(bytes),
            calibration_crc32: crc32(camera),
            frames: None,
        }
    }

    /// Adds the frames of a flight and the names of their files.
    #[must_use]
    pub fn with_frames(mut self, program: Program, files: &[&str], frames: ExportedFlight) -> Self {
        self.advice = program.advice_on_frames();
        self.files = files.iter().map(|name| (*name).to_owned()).collect();
        self.frames = Some(frames);
        self
    }

    /// Returns the statement for a terminal, without a line feed at the end.
    #[must_use]
    pub fn text(&self) -> String {
        let mut pairs = vec![
            ("camera", self.camera.clone()),
            ("format, model", format!("{}, {}", self.format, self.model)),
            ("files", self.files.join(", ")),
            ("direction", self.direction.to_owned()),
            ("origin", self.origin.to_owned()),
            ("unit", self.unit.to_owned()),
            ("sign", self.sign.to_owned()),
            (
                "residual",
                residual(
                    self.residual_max_um,
                    self.residual_rms_um,
                    self.pixel_um,
                    self.at_mm,
                ),
            ),
        ];
        for one in &self.not_held {
            let size = length::text(one.size_um / 1000.0);
            let px = one.size_um / self.pixel_um;
            pairs.push(("no place for", format!("{}: {size} ({px:.4} px)", one.term)));
        }
        pairs.extend(self.frames.iter().flat_map(ExportedFlight::pairs));
        pairs.push(("advice", self.advice.to_owned()));
        pairs.push(("calibration", format!("CRC-32 {}", self.calibration_crc32)));
        pairs.push(("SHA-256", self.calibration_sha256.clone()));
        terminal::pairs(NAMES, pairs)
    }
}
