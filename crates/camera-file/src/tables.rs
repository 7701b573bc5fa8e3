//! Tables of the camera file.

use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera::geometry::focus_table::{self, FOCUS_ROWS, FocusRow};
use fmc_camera::geometry::grid::GridChecksums;
use fmc_camera::geometry::sensor::FmcAxis;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use crate::input_error::InputError;
use crate::number::{clipped, single};
use crate::toml_text::TomlText;

/// `[sensor]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct SensorTable {
    pub width_px: i64,
    pub height_px: i64,
    pub pixel_um: f64,
}

/// `[distortion]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct DistortionTable {
    pub sign: Sign,
    pub k0: f64,
    pub k1: f64,
    pub k2: f64,
    pub k3: f64,
    pub p1: f64,
    pub p2: f64,
    pub b1: f64,
    pub b2: f64,
}

impl DistortionTable {
    /// Returns the same distortion with the sign of measured - ideal, whichever sign the file has.
    #[must_use]
    pub fn measured_minus_ideal(&self) -> Self {
        let sign = match self.sign {
            Sign::Distortion => 1.0,
            Sign::Correction => -1.0,
        };
        Self {
            sign: Sign::Distortion,
            k0: sign * self.k0,
            k1: sign * self.k1,
            k2: sign * self.k2,
            k3: sign * self.k3,
            p1: sign * self.p1,
            p2: sign * self.p2,
            b1: sign * self.b1,
            b2: sign * self.b2,
        }
    }
}

/// Sign of the coefficients of `[distortion]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sign {
    /// Measured - ideal.
    #[default]
    Distortion,
    /// To be added to the measured point.
    Correction,
}

/// `[fmc]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct FmcTable {
    pub axis: Axis,
    pub mechanism: MechanismName,
    pub first_transfer: f64,
    /// Run-up strategy; `None` if it is not written, which means centred for a stage.
    pub strategy: Option<Strategy>,
    pub acceleration_mm_s2: f64,
    pub settling_ms: f64,
    pub stroke_mm: f64,
    pub flatness_um: Vec<f64>,
    /// Largest jerk, mm/s³; 0: unlimited.
    pub jerk_mm_s3: f64,
    /// Largest speed, mm/s; 0: unlimited.
    pub max_speed_mm_s: f64,
}

impl Default for FmcTable {
    fn default() -> Self {
        Self {
            axis: Axis::PlusY,
            mechanism: MechanismName::Stage,
            first_transfer: 0.5,
            strategy: None,
            acceleration_mm_s2: 1000.0,
            settling_ms: 5.0,
            stroke_mm: 4.0,
            flatness_um: vec![0.0],
            jerk_mm_s3: 0.0,
            max_speed_mm_s: 0.0,
        }
    }
}

/// Direction in which the principal point moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[expect(missing_docs, reason = "each variant is spelt in the camera file")]
pub enum Axis {
    #[serde(rename = "+x")]
    PlusX,
    #[serde(rename = "-x")]
    MinusX,
    #[serde(rename = "+y")]
    PlusY,
    #[serde(rename = "-y")]
    MinusY,
}

impl Axis {
    /// Returns the name in the camera file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PlusX => "+x",
            Self::MinusX => "-x",
            Self::PlusY => "+y",
            Self::MinusY => "-y",
        }
    }

    /// Returns the unit vector e.
    #[must_use]
    pub const fn unit(self) -> [f64; 2] {
        match self {
            Self::PlusX => [1.0, 0.0],
            Self::MinusX => [-1.0, 0.0],
            Self::PlusY => [0.0, 1.0],
            Self::MinusY => [0.0, -1.0],
        }
    }
}

impl From<Axis> for FmcAxis {
    fn from(axis: Axis) -> Self {
        match axis {
            Axis::PlusX => Self::PlusX,
            Axis::MinusX => Self::MinusX,
            Axis::PlusY => Self::PlusY,
            Axis::MinusY => Self::MinusY,
        }
    }
}

/// Mechanism that holds the image still.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "each variant is spelt in the camera file")]
pub enum MechanismName {
    Stage,
    Tdi,
}

/// Run-up strategy, which determines where the exposure lies on the travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "each variant is spelt in the camera file")]
pub enum Strategy {
    #[default]
    Centred,
    FromRest,
}

impl Strategy {
    /// Both strategies.
    pub const ALL: [Self; 2] = [Self::Centred, Self::FromRest];

    /// Returns the name in the camera file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Centred => "centred",
            Self::FromRest => "from-rest",
        }
    }
}

impl From<Strategy> for RunUp {
    fn from(strategy: Strategy) -> Self {
        match strategy {
            Strategy::Centred => Self::Centred,
            Strategy::FromRest => Self::FromRest,
        }
    }
}

/// `[shutter]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct ShutterTable {
    pub profile: Profile,
    pub opening_fraction: f64,
    pub closing_fraction: f64,
}

/// Shape of the transmission, of a leaf shutter or of a detector with a global shutter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(try_from = "String")]
#[expect(missing_docs, reason = "each variant is spelt in the camera file")]
pub enum Profile {
    #[default]
    Uniform,
    Trapezoid,
}

impl TryFrom<String> for Profile {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        const ALLOWED: &str = "expected `uniform` or `trapezoid`";
        let named = |words: &[&str]| words.iter().any(|word| name.to_lowercase().contains(word));
        match name.as_str() {
            "uniform" => Ok(Self::Uniform),
            "trapezoid" => Ok(Self::Trapezoid),
            _ if named(&["focal", "rolling", "curtain", "slit"]) => Err(format!(
                "`{}` exposes row after row, and every row has a principal point of its own, which \
                 is not modelled; {ALLOWED}, for a leaf or global shutter (docs/conventions.md, \
                 section 5, has the reason)",
                clipped(&name)
            )),
            _ => Err(format!("unknown variant `{}`, {ALLOWED}", clipped(&name))),
        }
    }
}

/// `[fitted]`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct FittedTable {
    pub km0: f64,
    pub km1: f64,
    pub km2: f64,
    pub kd1: f64,
    pub pm1: f64,
    pub per: Per,
}

/// Factor by which `kd1` and `pm1` are multiplied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Per {
    /// δ, the travel while the shutter is open.
    #[default]
    Travel,
    /// c̄, the offset of the exposure centroid.
    Centroid,
}

impl Per {
    /// Returns the name in the camera file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Travel => "travel",
            Self::Centroid => "centroid",
        }
    }
}

impl From<Per> for Regressor {
    fn from(per: Per) -> Self {
        match per {
            Per::Travel => Self::Travel,
            Per::Centroid => Self::Centroid,
        }
    }
}

/// `[focus]`: focus shift over temperature, row by row.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct FocusTable {
    pub temperature_c: Vec<f64>,
    pub focus_shift_um: Vec<f64>,
}

impl FocusTable {
    /// Refuses lists of different lengths, or of another number of rows than a table may have.
    pub(crate) fn check(&self, text: &TomlText) -> Result<(), InputError> {
        let path = &["focus", "temperature_c"];
        let (rows, shifts) = (self.temperature_c.len(), self.focus_shift_um.len());
        if rows != shifts {
            let fault = format!("has {rows} numbers, focus.focus_shift_um {shifts}");
            return Err(text.invalid(path, &fault));
        }
        if !(2..=FOCUS_ROWS).contains(&rows) {
            let fault = format!("has {rows} rows; a focus table has 2 to {FOCUS_ROWS}");
            return Err(text.invalid(path, &fault));
        }
        Ok(())
    }

    /// The table as the camera is given it; empty for lists that [`Self::check`] refuses.
    pub(crate) fn table(&self) -> focus_table::FocusTable {
        let lists = self.temperature_c.iter().zip(&self.focus_shift_um);
        let rows: Vec<FocusRow> = lists
            .map(|(temperature_c, focus_shift_um)| FocusRow {
                temperature_c: single(*temperature_c),
                focus_shift_um: single(*focus_shift_um),
            })
            .collect();
        focus_table::FocusTable::new(&rows).unwrap_or(focus_table::FocusTable::NONE)
    }
}

/// `[grid]`: files of the residual grids, relative to the camera file, and the CRC-32 with which
/// they end.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct GridTable {
    pub lens: Option<String>,
    pub lens_crc32: Option<String>,
    pub sensor: Option<String>,
    pub sensor_crc32: Option<String>,
}

impl GridTable {
    /// CRC-32 of both grids; `None` also for one that is not eight hexadecimal digits, which is
    /// refused when the grids are read.
    pub(crate) fn checksums(&self) -> GridChecksums {
        let stated = |text: &Option<String>| text.as_deref().and_then(crc32);
        GridChecksums {
            lens: stated(&self.lens_crc32),
            sensor: stated(&self.sensor_crc32),
        }
    }
}

/// Reads a CRC-32 of eight hexadecimal digits.
pub(crate) fn crc32(text: &str) -> Option<u32> {
    let is_one = text.len() == 8 && text.bytes().all(|digit| digit.is_ascii_hexdigit());
    is_one.then(|| u32::from_str_radix(text, 16).ok()).flatten()
}

/// Reads exactly two numbers.
pub(crate) fn pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
    let numbers = Vec::<f64>::deserialize(deserializer)?;
    let count = numbers.len();
    numbers
        .try_into()
        .map_err(|_| D::Error::custom(format!("{count} numbers where 2 are expected")))
}
