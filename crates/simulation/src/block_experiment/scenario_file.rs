//! Scenario file of a block, in TOML.

use std::path::PathBuf;

use fmc_camera_file::Strategy;
use serde::Deserialize;

use crate::strip_experiment::scenario_file::TerrainTable;

/// A scenario as written. Units are in the names of the fields, which are those of the file;
/// `scenarios/block/ixm-50.toml` documents each.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct ScenarioFile {
    pub name: String,
    pub camera: PathBuf,
    pub block: BlockTable,
    pub flight: FlightTable,
    #[serde(default)]
    pub terrain: TerrainTable,
    pub sigma: SigmaTable,
    #[serde(default)]
    pub control: ControlTable,
    pub wrong_record: Option<WrongRecordTable>,
    #[serde(default)]
    pub limits: LimitTable,
}

/// `[block]`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct BlockTable {
    pub strips: i64,
    pub frames: i64,
    #[serde(default)]
    pub cross_strips: i64,
    #[serde(default = "sixty")]
    pub forward_overlap_percent: i64,
    #[serde(default = "thirty")]
    pub side_overlap_percent: i64,
    #[serde(default = "eighty")]
    pub points_per_frame: i64,
}

const fn sixty() -> i64 {
    60
}

const fn thirty() -> i64 {
    30
}

const fn eighty() -> i64 {
    80
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
    #[serde(default)]
    pub wind_m_s: f64,
    pub exposure_s: [f64; 2],
    #[serde(default)]
    pub follows_terrain: bool,
    #[serde(default)]
    pub attitude_spread_deg: [f64; 3],
    #[serde(default)]
    pub focus_spread_um: f64,
    pub run_up: Option<Strategy>,
}

/// `[sigma]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct SigmaTable {
    pub image_um: f64,
    pub position_m: [f64; 3],
    pub attitude_deg: [f64; 3],
    pub record_um: f64,
}

/// `[control]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct ControlTable {
    pub points: i64,
    pub sigma_m: f64,
}

impl Default for ControlTable {
    fn default() -> Self {
        Self {
            points: 0,
            sigma_m: 0.02,
        }
    }
}

/// `[wrong_record]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct WrongRecordTable {
    pub frame: i64,
    pub by_um: f64,
}

/// `[limits]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct LimitTable {
    pub records_along_m: Option<f64>,
}
