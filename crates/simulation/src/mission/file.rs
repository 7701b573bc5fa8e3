//! Scenario file of a simulated mission, in TOML.

use std::path::PathBuf;

use serde::Deserialize;

use crate::mechanics::MechanicsSettings;

/// A mission as written. Units are in the names of the fields, which are those of the file;
/// `scenarios/mission.toml` documents each.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct MissionFile {
    pub name: String,
    pub camera: PathBuf,
    pub seed: Option<i64>,
    pub settings: Option<toml::Table>,
    pub flight: MissionFlightTable,
    #[serde(default)]
    pub air: AirTable,
    #[serde(default)]
    pub attitude: AttitudeTable,
    #[serde(default)]
    pub terrain: MissionTerrainTable,
    pub vh: Vec<VhTable>,
    pub gnss: Option<GnssTable>,
    #[serde(default)]
    pub line: LineTable,
    #[serde(default)]
    pub clock: ClockTable,
    #[serde(default)]
    pub shutter: MissionShutterTable,
    #[serde(default)]
    pub mechanics: MechanicsSettings,
    #[serde(default)]
    pub detector: DetectorTable,
    pub temperature: Option<TemperatureTable>,
    #[serde(default)]
    pub limits: MissionLimitsTable,
    #[serde(default)]
    pub fault: Vec<FaultTable>,
}

impl MissionFile {
    /// η: ground speed over the height above the mean terrain, 1/s.
    #[must_use]
    pub fn vh_per_s(&self) -> f64 {
        self.flight.speed_m_s / (self.flight.height_m - self.terrain.height_m)
    }
}

/// `[flight]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct MissionFlightTable {
    pub height_m: f64,
    pub speed_m_s: f64,
    pub exposure_s: f64,
    pub exposures: i64,
    pub forward_overlap_percent: Option<f64>,
    pub interval_s: Option<f64>,
    #[serde(default = "two")]
    pub first_trigger_s: f64,
    pub clear_faults_after_s: Option<f64>,
    pub direction: Option<DirectionName>,
}

/// Direction of flight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum DirectionName {
    /// Along the FMC axis.
    Forward,
    /// Against the FMC axis; the camera is not turned.
    Reverse,
}

const fn two() -> f64 {
    2.0
}

/// `[air]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct AirTable {
    pub gust_rms_m_s: [f64; 3],
    pub gust_corner_hz: f64,
}

impl Default for AirTable {
    fn default() -> Self {
        Self {
            gust_rms_m_s: [0.0; 3],
            gust_corner_hz: 0.1,
        }
    }
}

/// `[attitude]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct AttitudeTable {
    pub pitch_deg: f64,
    pub roll_deg: f64,
    pub drift_deg: f64,
    pub rate_rms_deg_s: [f64; 3],
    pub rate_corner_hz: f64,
    pub reported_hz: f64,
}

impl Default for AttitudeTable {
    fn default() -> Self {
        Self {
            pitch_deg: 0.0,
            roll_deg: 0.0,
            drift_deg: 0.0,
            rate_rms_deg_s: [0.0; 3],
            rate_corner_hz: 1.0,
            reported_hz: 0.0,
        }
    }
}

/// `[terrain]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct MissionTerrainTable {
    pub height_m: f64,
    pub relief_m: f64,
    pub wavelength_m: f64,
}

impl Default for MissionTerrainTable {
    fn default() -> Self {
        Self {
            height_m: 0.0,
            relief_m: 0.0,
            wavelength_m: 4000.0,
        }
    }
}

/// `[[vh]]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct VhTable {
    pub source: VhSourceName,
    pub rate_hz: f64,
    #[serde(default)]
    pub sigma_percent: f64,
    #[serde(default)]
    pub latency_ms: f64,
}

/// `[gnss]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct GnssTable {
    pub first_pulse_unix_s: i64,
    #[serde(default)]
    pub pulse_jitter_us: f64,
}

/// `[clock]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct ClockTable {
    pub drift_ppm: f64,
    pub wander_ppm: f64,
    pub wander_corner_hz: f64,
}

impl Default for ClockTable {
    fn default() -> Self {
        Self {
            drift_ppm: 0.0,
            wander_ppm: 0.0,
            wander_corner_hz: 0.001,
        }
    }
}

/// `[line]`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct LineTable {
    pub carries: Option<Vec<String>>,
    pub receiver: ReceiverFormat,
    pub baud: i64,
    pub autopilot: AutopilotFormat,
    pub autopilot_baud: i64,
}

impl Default for LineTable {
    fn default() -> Self {
        Self {
            carries: None,
            receiver: ReceiverFormat::Whole,
            baud: 38_400,
            autopilot: AutopilotFormat::Whole,
            autopilot_baud: 57_600,
        }
    }
}

/// Form in which the satellite receiver reports speed and altitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ReceiverFormat {
    /// Messages that arrive whole or not at all.
    Whole,
    /// Sentences of NMEA 0183, byte after byte.
    Nmea,
}

/// Form in which the autopilot reports attitude and the height of the radar altimeter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AutopilotFormat {
    /// Messages that arrive whole or not at all.
    Whole,
    /// Messages of `MAVLink`, byte after byte.
    Mavlink,
}

/// Source of V/H.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VhSourceName {
    /// V/H itself.
    Direct,
    /// Ground speed of a satellite receiver and height over the ground of a radar altimeter.
    Altimeter,
    /// Ground speed of an inertial unit and height over the ground of a laser altimeter.
    Laser,
    /// Ground speed and altitude of a satellite receiver, and height of the terrain from an
    /// elevation model.
    Terrain,
}

impl VhSourceName {
    /// All sources.
    pub const ALL: [Self; 4] = [Self::Direct, Self::Altimeter, Self::Laser, Self::Terrain];

    /// Returns the source of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|source| source.name() == name)
    }

    /// Returns true if the source takes its speed from the satellite receiver.
    #[must_use]
    pub const fn has_receiver(self) -> bool {
        matches!(self, Self::Altimeter | Self::Terrain)
    }

    /// Returns the name used in a scenario.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Altimeter => "altimeter",
            Self::Laser => "laser",
            Self::Terrain => "terrain",
        }
    }
}

/// One of the values that a source of V/H gives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum VhQuantity {
    /// Ground speed, or V/H itself.
    Speed,
    /// Height over the ground, or altitude.
    Height,
}

/// `[shutter]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct MissionShutterTable {
    pub latency_ms: f64,
    pub jitter_us: f64,
    pub stamp_jitter_us: f64,
}

impl Default for MissionShutterTable {
    fn default() -> Self {
        Self {
            latency_ms: 2.0,
            jitter_us: 20.0,
            stamp_jitter_us: 0.0,
        }
    }
}

/// `[detector]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct DetectorTable {
    pub run_out_um: [f64; 4],
}

/// `[temperature]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct TemperatureTable {
    pub start_c: f64,
    #[serde(default)]
    pub rate_c_per_s: f64,
    #[serde(default)]
    pub told_every_s: f64,
    pub focus_shift_um: [f64; 4],
    #[serde(default = "one")]
    pub limit_um: f64,
}

const fn one() -> f64 {
    1.0
}

/// `[limits]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct MissionLimitsTable {
    pub pp_error_px: f64,
    pub smear_px: f64,
}

impl Default for MissionLimitsTable {
    fn default() -> Self {
        Self {
            pp_error_px: 0.1,
            smear_px: 0.25,
        }
    }
}

/// `[[fault]]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct FaultTable {
    pub name: String,
    pub source: Option<VhSourceName>,
    pub of: Option<VhQuantity>,
    pub at_frame: Option<i64>,
    pub onset_s: Option<f64>,
    pub size: Option<f64>,
    pub duration_s: Option<f64>,
    #[serde(default)]
    pub expect: ExpectTable,
}

/// `expect` of a `[[fault]]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the scenario"
)]
pub struct ExpectTable {
    pub fault: Option<String>,
    pub within_ms: Option<f64>,
    pub state: Option<String>,
    pub refused: Option<String>,
    pub flag: Option<String>,
    pub refused_at_most: Option<i64>,
    pub vh_from: Option<String>,
    pub smear_px: Option<f64>,
    pub armed_within_s: Option<f64>,
}
