//! Tables of a network as its files have them.

use std::collections::HashMap;

use fmc_reference::residual_splines::ResidualSplines;

use super::stage::StageSetting;

/// Row of a file of image points.
#[derive(Debug, Clone, PartialEq)]
pub struct ImagePointRow {
    /// Line in the file.
    pub line: u64,
    /// Name of the image.
    pub image: Box<str>,
    /// Name of the object point.
    pub point: Box<str>,
    /// Measured point, sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// Distortion that the residual grids of the camera add at it, measured - ideal, mm; zero for a
    /// camera without.
    pub by_grids_mm: [f64; 2],
    /// σ of either coordinate, mm; `None` without a column of σ.
    pub sigma_mm: Option<f64>,
}

/// Part that a point plays, as the file names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowRole {
    /// Observed or held.
    Control,
    /// Compared only.
    Check,
    /// Initial value.
    Approximate,
}

/// Row of a file of object points.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectPointRow {
    /// Line in the file.
    pub line: u64,
    /// Name.
    pub point: Box<str>,
    /// Coordinates, ground frame, m.
    pub position_m: [f64; 3],
    /// σ of the coordinates, m; 0: held.
    pub sigmas_m: [f64; 3],
    /// Part that it plays.
    pub role: RowRole,
}

/// Row of a file of images.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageRow {
    /// Line in the file.
    pub line: u64,
    /// Name.
    pub image: Box<str>,
    /// Position, m.
    pub position_m: [f64; 3],
    /// Pitch, roll, yaw, degrees.
    pub attitude_deg: [f64; 3],
    /// σ of position, m, and attitude, degrees; `None`: an initial value.
    pub sigmas: [Option<f64>; 6],
    /// Velocity over ground, m/s.
    pub velocity_m_s: Option<[f64; 3]>,
    /// Name of the strip.
    pub strip: Option<Box<str>>,
}

/// Row of a file of scale bars.
#[derive(Debug, Clone, PartialEq)]
pub struct ScaleBarRow {
    /// Line in the file.
    pub line: u64,
    /// Names of the ends.
    pub ends: [Box<str>; 2],
    /// Length, m.
    pub length_m: f64,
    /// σ, m.
    pub sigma_m: f64,
}

/// A table with the name that messages use for its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Table<Row> {
    /// Name of the file.
    pub file: String,
    /// Rows in the order of the file.
    pub rows: Vec<Row>,
}

/// All tables of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct NetworkTables {
    /// Image points.
    pub image_points: Table<ImagePointRow>,
    /// Object points.
    pub object_points: Table<ObjectPointRow>,
    /// Images, where positions or attitudes are known.
    pub images: Option<Table<ImageRow>>,
    /// Scale bars.
    pub scale_bars: Option<Table<ScaleBarRow>>,
    /// Stage of each image by its name; empty without records.
    pub stages: HashMap<Box<str>, StageSetting>,
}

impl NetworkTables {
    /// Returns the tables with what the residual grids of the camera add at every image point, the
    /// stage at its calibrated place.
    #[must_use]
    pub fn with_grids(mut self, grids: &ResidualSplines) -> Self {
        for row in &mut self.image_points.rows {
            row.by_grids_mm = grids.calibrated(row.measured_mm);
        }
        self
    }
}
