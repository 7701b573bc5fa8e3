//! Residual grid of a calibration, as a camera reads it.

use fmc_camera::geometry::grid::{GridCarrier, ResidualGrid};
use fmc_camera_file::{InputError, grid_block};
use fmc_reference::residual_spline::ResidualSpline;

use super::fit::FittedGrid;
use super::grid_file;
use super::lattice::Lattice;

/// A residual grid with its file.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibratedGrid {
    /// Part that carries the structure.
    pub carrier: GridCarrier,
    /// Nodes.
    pub lattice: Lattice,
    /// File as a camera reads it, with coefficients of 16 bits.
    pub bytes: Vec<u8>,
    /// The grid of that file in double precision.
    pub spline: ResidualSpline,
    /// Bound of either component of the displacement: the largest coefficient, mm.
    pub largest_mm: f64,
    /// Bound of the slope, mm per mm.
    pub slope: f64,
}

impl CalibratedGrid {
    /// Rounds a grid to the coefficients of its file.
    ///
    /// # Errors
    /// [`InputError`] for a grid that no camera accepts.
    pub(super) fn new(grid: &FittedGrid) -> Result<Self, InputError> {
        let refused = |error| InputError::invalid(format!("{}: {error}", name(grid.carrier)));
        let bytes = grid_file::bytes(grid).map_err(refused)?;
        let stored = ResidualGrid::parse(&bytes).map_err(refused)?;
        let (spline, slope) = (ResidualSpline::of(&stored), stored.bounds().slope());
        let coefficients = grid.coefficients_mm.iter().flatten();
        Ok(Self {
            carrier: grid.carrier,
            lattice: grid.lattice,
            bytes,
            spline,
            largest_mm: coefficients.fold(0.0, |largest, value| value.abs().max(largest)),
            slope: f64::from(slope),
        })
    }

    /// CRC-32 with which the file ends.
    #[must_use]
    pub fn crc32(&self) -> u32 {
        let last = self.bytes.last_chunk();
        last.map_or(0, |crc| u32::from_le_bytes(*crc))
    }

    /// Key of the part in `[grid]` of the camera file.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self.carrier {
            GridCarrier::Lens => "lens",
            GridCarrier::Sensor => "sensor",
        }
    }

    /// Name of the file beside the camera file.
    #[must_use]
    pub const fn file_name(&self) -> &'static str {
        Self::file_name_of(self.carrier)
    }

    /// Name of the file of a part.
    #[must_use]
    pub const fn file_name_of(carrier: GridCarrier) -> &'static str {
        grid_block::file_name(carrier)
    }
}

const fn name(carrier: GridCarrier) -> &'static str {
    match carrier {
        GridCarrier::Lens => "grid of the lens",
        GridCarrier::Sensor => "grid of the sensor",
    }
}
