//! Observations of a distortion table.

/// One row of a distortion table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TableObservation {
    /// Measured point in the sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// Distortion there, measured - ideal, mm.
    pub distortion_mm: [f64; 2],
    /// Offset c of the principal point along the FMC axis, mm.
    pub stage_offset_mm: f64,
}
