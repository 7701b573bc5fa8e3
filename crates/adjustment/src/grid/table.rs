//! Observations of a distortion table.

/// One row of a distortion table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableObservation {
    /// Line in the file.
    pub line: u64,
    /// Measured point in the sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// Distortion there, measured - ideal about the principal distance of the camera file, mm.
    pub distortion_mm: [f64; 2],
    /// Offset c of the principal point along the FMC axis, mm.
    pub stage_offset_mm: f64,
}
