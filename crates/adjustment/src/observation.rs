//! Observed distortions.

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservationRow {
    /// Its line in the file.
    pub line: u64,
    /// Its name, where there is a column of names.
    pub id: Option<Box<str>>,
    /// The measured point in the sensor frame, mm.
    pub point_mm: [f64; 2],
    /// Measured - ideal, mm.
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

/// The rows of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservationTable {
    /// What messages call the file.
    pub file: String,
    /// In the order of the file.
    pub rows: Vec<ObservationRow>,
    /// Whether there is a column `sigma_um`; without it every σ is [`UNIT_SIGMA_MM`].
    pub has_sigma: bool,
}

/// σ of observations that come without, so that σ0 is in µm.
pub const UNIT_SIGMA_MM: f64 = 1e-3;
