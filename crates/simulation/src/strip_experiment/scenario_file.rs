//! Scenario file of a strip over ground control, in TOML.

use std::path::PathBuf;

use fmc_camera_file::Strategy;
use serde::Deserialize;

/// A scenario as written. Units are in the names of the fields, which are those of the file;
/// `scenarios/yuan-2012.toml` documents each.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct ScenarioFile {
    pub name: String,
    pub camera: PathBuf,
    pub flight: FlightTable,
    #[serde(default)]
    pub terrain: TerrainTable,
    #[serde(default)]
    pub truth: TruthTable,
    #[serde(default)]
    pub correction: CorrectionTable,
    pub image: ImageTable,
    pub pos: PosTable,
    pub control: ControlTable,
    #[serde(default)]
    pub check: CheckPointTable,
}

/// `[flight]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct FlightTable {
    pub height_m: f64,
    pub speed_m_s: f64,
    pub exposure_s: f64,
    #[serde(default)]
    pub heading_deg: f64,
    #[serde(default)]
    pub start_m: [f64; 2],
    #[serde(default = "one")]
    pub frames: i64,
    #[serde(default)]
    pub base_m: f64,
    #[serde(default)]
    pub attitude_spread_deg: [f64; 3],
    pub run_up: Option<Strategy>,
}

const fn one() -> i64 {
    1
}

/// `[terrain]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct TerrainTable {
    pub height_m: f64,
    pub relief_m: f64,
    pub wavelength_m: f64,
}

impl Default for TerrainTable {
    fn default() -> Self {
        Self {
            height_m: 0.0,
            relief_m: 0.0,
            wavelength_m: 1000.0,
        }
    }
}

/// `[truth]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct TruthTable {
    pub focus_shift_um: f64,
}

/// `[correction]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct CorrectionTable {
    pub focus_shift_um: Option<f64>,
}

/// `[image]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct ImageTable {
    pub sigma_um: f64,
}

/// `[pos]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct PosTable {
    pub position_sigma_m: Sigma,
    pub attitude_sigma_deg: Sigma,
    #[serde(default)]
    pub position_bias_m: [f64; 3],
    #[serde(default)]
    pub attitude_bias_deg: [f64; 3],
}

/// Standard deviations of three observations, or the word "free".
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "three numbers, or the word \"free\"")]
pub enum Sigma {
    /// Standard deviation of each observation.
    Each([f64; 3]),
    /// Not observed: the value is only an initial one.
    Word(Free),
}

/// The word "free".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Free {
    /// Not observed.
    Free,
}

impl Sigma {
    /// Returns the standard deviations; `None` where the observation is free.
    #[must_use]
    pub fn each(&self) -> [Option<f64>; 3] {
        match self {
            Self::Each(sigmas) => sigmas.map(Some),
            Self::Word(Free::Free) => [None; 3],
        }
    }
}

/// `[control]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct ControlTable {
    pub sigma_m: f64,
    pub points: Vec<GroundPoint>,
}

/// A control point.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct GroundPoint {
    pub id: String,
    pub x_m: f64,
    pub y_m: f64,
    pub z_m: f64,
}

/// `[check]`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct CheckPointTable {
    pub points_per_side: i64,
}

impl Default for CheckPointTable {
    fn default() -> Self {
        Self { points_per_side: 7 }
    }
}

/// Smallest number of control points of a resection.
pub const FEWEST_CONTROL_POINTS: usize = 3;
