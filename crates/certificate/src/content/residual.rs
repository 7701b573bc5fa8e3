//! Residual grids of the camera: their files, sizes and the displacement that they add.

use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::grid::{GridCarrier, ResidualGrid};
use fmc_camera_file::{GridFiles, InputError};
use fmc_reference::residual_splines::ResidualSplines;
use fmc_report::hash;
use serde::Serialize;

use super::inputs::Inputs;
use crate::stated::Stated;

/// Points of the field along the longer and along the shorter side of the sensor.
const FIELD_POINTS: [u32; 2] = [15, 11];
/// Points along each side of the sensor for the largest displacement.
const SIDE_POINTS: u32 = 81;

/// Residual grids; empty for a camera without.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ResidualSection {
    /// Grids, that of the lens first.
    pub grids: Vec<ResidualGridLine>,
    /// Largest length of what they add together over the sensor, the stage at its calibrated
    /// position, µm.
    pub largest_um: Option<Stated>,
    /// Displacements that they add at points of the sensor.
    pub field: Vec<ResidualPoint>,
}

/// One grid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualGridLine {
    /// `lens` or `sensor`.
    pub part: &'static str,
    /// File, in the folder of the certificate.
    pub file: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// CRC-32 with which it ends, as the camera file states it.
    pub crc32: String,
    /// Nodes of a row and rows.
    pub nodes: [u16; 2],
    /// Distance of nodes, mm.
    pub pitch_mm: Option<Stated>,
    /// Largest length of what it adds over the sensor, µm.
    pub largest_um: Option<Stated>,
    /// Bound of its slope, µm per mm.
    pub slope_um_per_mm: Option<Stated>,
}

/// Displacement by the grids at a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResidualPoint {
    /// Place in the sensor frame, mm.
    pub at_mm: [Option<Stated>; 2],
    /// Measured - ideal, µm.
    pub added_um: [Option<Stated>; 2],
}

impl ResidualSection {
    /// Describes the grids of a camera.
    ///
    /// # Errors
    /// [`InputError`] for a grid whose file does not lie beside the camera file: the certificate
    /// holds all files in one folder.
    pub(super) fn new(inputs: &Inputs<'_>, fitting: &CameraGrids<'_>) -> Result<Self, InputError> {
        if inputs.grids.is_empty() {
            return Ok(Self::default());
        }
        let splines = ResidualSplines::of(fitting);
        let half_mm = inputs.camera.half_format_mm();
        let parts = [
            (GridCarrier::Lens, fitting.lens()),
            (GridCarrier::Sensor, fitting.sensor()),
        ];
        let mut grids = Vec::new();
        for (carrier, grid) in parts {
            if let Some(grid) = grid {
                grids.push(line(inputs, carrier, grid, half_mm)?);
            }
        }
        let [width, height] = half_mm;
        let counts = if width >= height {
            FIELD_POINTS
        } else {
            let [more, fewer] = FIELD_POINTS;
            [fewer, more]
        };
        let field = points(half_mm, counts).map(|point| ResidualPoint {
            at_mm: point.map(|mm| Stated::decimals(mm, 3)),
            added_um: splines
                .calibrated(point)
                .map(|mm| Stated::decimals(1e3 * mm, 4)),
        });
        Ok(Self {
            grids,
            largest_um: largest_um(half_mm, |point| splines.calibrated(point)),
            field: field.collect(),
        })
    }
}

fn line(
    inputs: &Inputs<'_>,
    carrier: GridCarrier,
    grid: &ResidualGrid<'_>,
    half_mm: [f64; 2],
) -> Result<ResidualGridLine, InputError> {
    let spline = fmc_reference::residual_spline::ResidualSpline::of(grid);
    let header = grid.header();
    let part = part(carrier);
    let file = inputs.camera.grid_name(carrier).unwrap_or_default();
    if !is_plain(file) {
        return Err(InputError::invalid(format!(
            "{}: [grid] {part} = {file:?} is in another folder, and a certificate holds all files in one",
            inputs.file_name
        ))
        .with_help("move the grid beside the camera file"));
    }
    Ok(ResidualGridLine {
        part,
        file: file.to_owned(),
        sha256: hash::sha256(inputs.grids.bytes(carrier).unwrap_or_default()),
        crc32: format!("{:08x}", grid.crc32()),
        nodes: [header.columns, header.rows],
        pitch_mm: Stated::digits(header.pitch_mm.into(), 6),
        largest_um: largest_um(half_mm, |point| spline.displacement(point)),
        slope_um_per_mm: Stated::digits(1e3 * f64::from(grid.bounds().slope()), 3),
    })
}

/// Returns the files of a camera's grids by the names that its file has for them.
pub(crate) fn files(certificate: &ResidualSection, grids: &GridFiles) -> Vec<(String, Vec<u8>)> {
    let bytes = |line: &ResidualGridLine| {
        let carrier = match line.part {
            "lens" => GridCarrier::Lens,
            _ => GridCarrier::Sensor,
        };
        grids.bytes(carrier).unwrap_or_default().to_vec()
    };
    let lines = certificate.grids.iter();
    lines.map(|line| (line.file.clone(), bytes(line))).collect()
}

/// Returns true for the name of a file without folders.
pub(crate) fn is_plain(name: &str) -> bool {
    !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\', ':'])
}

const fn part(carrier: GridCarrier) -> &'static str {
    match carrier {
        GridCarrier::Lens => "lens",
        GridCarrier::Sensor => "sensor",
    }
}

fn largest_um(half_mm: [f64; 2], at: impl Fn([f64; 2]) -> [f64; 2]) -> Option<Stated> {
    let lengths = points(half_mm, [SIDE_POINTS; 2]).map(|point| {
        let [dx, dy] = at(point);
        dx.hypot(dy)
    });
    Stated::decimals(1e3 * lengths.fold(0.0, f64::max), 4)
}

/// Returns points over the sensor, edges included, mm.
fn points(
    [half_width, half_height]: [f64; 2],
    [columns, rows]: [u32; 2],
) -> impl Iterator<Item = [f64; 2]> {
    let part = |index: u32, count: u32| 2.0 * f64::from(index) / f64::from(count - 1) - 1.0;
    (0..rows).flat_map(move |row| {
        (0..columns).map(move |column| {
            [
                half_width * part(column, columns),
                half_height * part(row, rows),
            ]
        })
    })
}
