//! Statement of an import: the report, the same for the terminal, and the comments of the camera
//! file.

use fmc_camera_file::CameraFile;
use fmc_exchange::found::Formula;
use fmc_exchange::import::Imported;
use fmc_exchange::program::Program;
use fmc_exchange::residual::Residual;
use serde::Serialize;

use super::{NAMES, residual};
use crate::hash::{crc32, sha256};
use crate::length;
use crate::terminal;

/// Statement of an import: the file that was read, and the residual. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportSummary {
    /// Format, as the command line names it.
    pub format: &'static str,
    /// Name of the camera.
    pub camera: String,
    /// Direction of the file's formula: `ideal -> measured` or `measured -> ideal`.
    pub direction: &'static str,
    /// `true` if the coefficients were converted and not fitted.
    pub exact: bool,
    /// Meaning of the sign in the file.
    pub sign: &'static str,
    /// Largest residual along one axis over the sensor, µm.
    pub residual_max_um: f64,
    /// Root of the mean square over both axes, µm.
    pub residual_rms_um: f64,
    /// Largest residual, px.
    pub residual_max_px: f64,
    /// Place of the largest, mm in the sensor frame.
    pub at_mm: [f64; 2],
    /// Terms of the file that have no place of their own: their effect is in the residual.
    pub not_held: Vec<&'static str>,
    /// Residual grid beside the polynomial; the residual is that of both.
    pub grid: Option<ImportedGrid>,
    /// Numbers that the file does not have.
    pub assumed: Assumed,
    /// Remarks.
    pub notes: Vec<String>,
    /// SHA-256 of the file that was read.
    pub source_sha256: String,
    /// SHA-256 of the camera file.
    pub calibration_sha256: String,
    /// CRC-32 of the calibration, as the frame records will have it.
    pub calibration_crc32: String,
}

/// Numbers as they were stated, or those of the file where it has them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Assumed {
    /// Pixel pitch, µm.
    pub pixel_um: f64,
    /// Columns and rows, px.
    pub size_px: [u32; 2],
    /// Name of the camera in the file, if it was stated.
    pub id: Option<String>,
    /// Sign, if it was stated.
    pub sign: Option<&'static str>,
}

/// Residual grid that takes what the polynomial leaves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ImportedGrid {
    /// Name of its file, beside the camera file.
    pub file: String,
    /// CRC-32 with which the file ends, in hexadecimal digits.
    pub crc32: String,
    /// Distance of neighbouring nodes, mm.
    pub pitch_mm: f64,
    /// Nodes along x and y.
    pub nodes: [u16; 2],
    /// Largest residual of the polynomial alone, µm.
    pub polynomial_residual_max_um: f64,
    /// Root of the mean square of it, µm.
    pub polynomial_residual_rms_um: f64,
    /// Residual of polynomial and grid.
    #[serde(skip)]
    pub residual: Residual,
}

impl ImportedGrid {
    fn text(&self) -> String {
        let [columns, rows] = self.nodes;
        format!(
            "{}: {columns} x {rows} nodes, {:.2} mm apart; the polynomial alone leaves {}",
            self.file,
            self.pitch_mm,
            length::text(self.polynomial_residual_max_um / 1000.0)
        )
    }
}

impl ImportSummary {
    /// Returns the statement of an import: of the camera file with the bytes `written` from a file
    /// with the bytes `source`.
    #[must_use]
    pub fn of(
        camera: &CameraFile,
        written: &[u8],
        program: Program,
        source: &[u8],
        imported: &Imported,
        assumed: Assumed,
        grid: Option<ImportedGrid>,
    ) -> Self {
        let residual = left(imported, grid.as_ref());
        Self {
            format: program.name(),
            camera: camera.name.clone(),
            direction: imported.found.formula.direction(),
            exact: imported.is_exact,
            sign: program.conventions().sign,
            residual_max_um: residual.largest_um,
            residual_rms_um: residual.rms_um,
            residual_max_px: residual.largest_um / camera.sensor.pixel_um,
            at_mm: residual.at_mm,
            not_held: without_place(&imported.found.formula),
            grid,
            assumed,
            notes: imported.found.notes.clone(),
            source_sha256: sha256(source),
            calibration_sha256: sha256(written),
            calibration_crc32: crc32(camera),
        }
    }

    /// Returns the statement for a terminal, without a line feed at the end.
    #[must_use]
    pub fn text(&self) -> String {
        let [width, height] = self.assumed.size_px;
        let mut pairs = vec![
            ("camera", self.camera.clone()),
            ("format", self.format.to_owned()),
            ("direction", self.direction.to_owned()),
            ("coefficients", method(self.exact).to_owned()),
            (
                "sensor",
                format!("{width} x {height} px of {} µm", self.assumed.pixel_um),
            ),
            (
                "residual",
                residual(
                    self.residual_max_um,
                    self.residual_rms_um,
                    self.assumed.pixel_um,
                    self.at_mm,
                ),
            ),
        ];
        if let Some(grid) = &self.grid {
            pairs.push(("residual grid", grid.text()));
        }
        if !self.not_held.is_empty() {
            pairs.push(("fitted away", self.not_held.join(", ")));
        }
        pairs.extend(self.notes.iter().map(|note| ("note", note.clone())));
        pairs.push(("calibration", format!("CRC-32 {}", self.calibration_crc32)));
        pairs.push(("SHA-256", self.calibration_sha256.clone()));
        terminal::pairs(NAMES, pairs)
    }
}

/// Returns the residual that the camera file leaves.
fn left(imported: &Imported, grid: Option<&ImportedGrid>) -> Residual {
    grid.map_or(imported.residual, |grid| grid.residual)
}

const fn method(exact: bool) -> &'static str {
    if exact {
        "converted exactly"
    } else {
        "K0..K3, P1, P2, B1, B2 fitted over the whole sensor"
    }
}

/// Returns the terms of a formula that a camera file does not have.
fn without_place(formula: &Formula) -> Vec<&'static str> {
    let some = |numbers: &[f64]| numbers.iter().any(|number| number.abs() > 0.0);
    let terms: &[(&'static str, bool)] = match formula {
        Formula::Pinhole(pinhole) => &[
            ("denominator", some(&pinhole.divisor)),
            ("thin prism", some(&pinhole.prism)),
            ("tilt", some(&pinhole.tilt)),
            ("centre of distortion", some(&pinhole.offset)),
        ],
        Formula::Correction(correction) => &[
            ("K4", some(&[correction.k4])),
            ("denominator", some(&correction.divisor)),
            ("centre of distortion", some(&correction.offset_mm)),
        ],
    };
    terms
        .iter()
        .filter(|(_, is_there)| *is_there)
        .map(|(term, _)| *term)
        .collect()
}

/// Returns the comments with which the camera file begins: source, hash, direction, what was fitted
/// and what it leaves.
#[must_use]
pub fn comments(
    program: Program,
    file: &str,
    source: &[u8],
    imported: &Imported,
    grid: Option<&ImportedGrid>,
) -> Vec<String> {
    let conventions = program.conventions();
    let left = left(imported, grid);
    let pixel_um = 1e3 * imported.camera.pixel_mm;
    let fitted = without_place(&imported.found.formula);
    let mut lines = vec![
        format!(
            "From {file} ({}), camera \"{}\"",
            program.name(),
            imported.found.name.replace(char::is_control, " ")
        ),
        format!("SHA-256 {}", sha256(source)),
        format!(
            "Direction there: {}; {}",
            imported.found.formula.direction(),
            conventions.sign
        ),
        format!("Coefficients: {}", method(imported.is_exact)),
        format!(
            "Residual: {}",
            residual(left.largest_um, left.rms_um, pixel_um, left.at_mm)
        ),
    ];
    if let Some(grid) = grid {
        lines.push(format!("Residual grid: {}", grid.text()));
    }
    if !fitted.is_empty() {
        lines.push(format!("Without a place here: {}", fitted.join(", ")));
    }
    lines.extend(imported.found.notes.iter().cloned());
    lines
}
