//! Observed distortions.

/// One row of a file of observations.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservationRow {
    /// Line in the file.
    pub line: u64,
    /// Name of the point, if there is a column of names.
    pub id: Option<Box<str>>,
    /// Measured point in the sensor frame, mm.
    pub point_mm: [f64; 2],
    /// Observed distortion, measured - ideal, mm.
    pub distortion_mm: [f64; 2],
    /// V/H, 1/s.
    pub vh_per_s: f64,
    /// t, s.
    pub exposure_s: f64,
    /// Δδ, mm.
    pub opening_offset_mm: f64,
    /// Standard deviation of either component, mm.
    pub sigma_mm: f64,
}

/// Rows of a file of observations.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservationTable {
    /// Name that messages use for the file.
    pub file: String,
    /// Rows in the order of the file.
    pub rows: Vec<ObservationRow>,
    /// `true` if there is a column `sigma_um`; without it every σ is [`UNIT_SIGMA_MM`].
    pub has_sigma: bool,
}

/// σ of observations without one, so that σ0 is in µm.
pub const UNIT_SIGMA_MM: f64 = 1e-3;
