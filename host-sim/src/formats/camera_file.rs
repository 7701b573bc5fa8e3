//! The camera file: calibration, mechanism, shutter and limits of one camera, in TOML.

use std::path::Path;

use fmc_camera::flight::camera::{Camera, CameraRecord, Mechanism};
use fmc_camera::flight::exposure::Limits;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::CalibrationRecord;
use fmc_camera::geometry::five_coefficient::{FiveCoefficients, Regressor};
use fmc_camera::geometry::principal_distance::{FLATNESS_TERMS, Flatness};
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::geometry::shutter::ShutterProfile;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use super::camera_error::CameraText;
use super::number::single;
use crate::failure::Failure;
use crate::reference::lens::Lens;

/// A camera file as written. Units are in the names of the fields, which are those of the file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct CameraFile {
    pub name: String,
    pub principal_distance_mm: f64,
    pub exit_pupil_mm: Option<f64>,
    #[serde(default, deserialize_with = "pair")]
    pub principal_point_mm: [f64; 2],
    pub sensor: SensorTable,
    #[serde(default)]
    pub distortion: DistortionTable,
    #[serde(default)]
    pub fmc: FmcTable,
    #[serde(default)]
    pub shutter: ShutterTable,
    #[serde(default)]
    pub limits: LimitsTable,
    pub fitted: Option<FittedTable>,
}

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

/// Which sign the coefficients of `[distortion]` have.
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
    /// `None`: not written, centred where there is a stage.
    pub strategy: Option<Strategy>,
    pub acceleration_mm_s2: f64,
    pub settling_ms: f64,
    pub stroke_mm: f64,
    pub flatness_um: Vec<f64>,
    /// 0: unlimited.
    pub jerk_mm_s3: f64,
    /// 0: unlimited.
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

/// A limit of the mechanism; 0 in the file is none.
fn limit(value: f64) -> Option<f64> {
    (value != 0.0).then_some(value)
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
    /// As in the camera file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::PlusX => "+x",
            Self::MinusX => "-x",
            Self::PlusY => "+y",
            Self::MinusY => "-y",
        }
    }

    /// The unit vector e.
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

/// How the image is held still.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "each variant is spelt in the camera file")]
pub enum MechanismName {
    Stage,
    Tdi,
}

/// Where the run-up puts the exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(missing_docs, reason = "each variant is spelt in the camera file")]
pub enum Strategy {
    #[default]
    Centred,
    FromRest,
}

impl Strategy {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Centred, Self::FromRest];

    /// As in the camera file.
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

/// Shape of the transmission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
#[expect(missing_docs, reason = "each variant is spelt in the camera file")]
pub enum Profile {
    #[default]
    Uniform,
    Trapezoid,
}

/// `[limits]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct LimitsTable {
    #[serde(deserialize_with = "pair")]
    pub vh_per_s: [f64; 2],
    #[serde(deserialize_with = "pair")]
    pub exposure_s: [f64; 2],
}

impl Default for LimitsTable {
    fn default() -> Self {
        Self {
            vh_per_s: [0.05, 0.17],
            exposure_s: [0.001, 0.02],
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

/// What `kd1` and `pm1` are multiplied by.
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
    /// As in the camera file.
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

impl CameraFile {
    /// Reads and validates a camera file.
    ///
    /// # Errors
    /// [`Failure`] naming file, line, field, value and allowed range.
    pub fn read(path: &Path) -> Result<(Self, Camera), Failure> {
        let text = std::fs::read_to_string(path).map_err(|error| match error.kind() {
            std::io::ErrorKind::InvalidData => {
                Failure::bad_input(format!("{}: not a text file (UTF-8)", path.display()))
            }
            _ => Failure::reading(path, &error),
        })?;
        Self::parse(&path.display().to_string(), &text)
    }

    /// Parses and validates the text of a camera file; `file` is what messages call it.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &str, text: &str) -> Result<(Self, Camera), Failure> {
        let text = CameraText::new(file, text.strip_prefix('\u{feff}').unwrap_or(text));
        let camera_file: Self = text.deserialize()?;
        camera_file.check_what_only_the_file_knows(&text)?;
        let camera =
            Camera::new(camera_file.record()).map_err(|error| text.invalid_calibration(&error))?;
        Ok((camera_file, camera))
    }

    fn check_what_only_the_file_knows(&self, text: &CameraText) -> Result<(), Failure> {
        if self.name.trim().is_empty() {
            return Err(text.invalid(&["name"], "is empty; a camera needs a name"));
        }
        if self.name.contains(char::is_control) {
            return Err(text.invalid(&["name"], "holds a control character"));
        }
        // Of stage and TDI one is not in use; its numbers are looked at all the same.
        for (quantity, value) in [
            (Quantity::FirstTransfer, self.fmc.first_transfer),
            (Quantity::AccelerationMmS2, self.fmc.acceleration_mm_s2),
            (Quantity::SettlingMs, self.fmc.settling_ms),
        ] {
            quantity
                .check(single(value))
                .map_err(|error| text.invalid_calibration(&error.into()))?;
        }
        for (quantity, value) in [
            (Quantity::JerkMmS3, limit(self.fmc.jerk_mm_s3)),
            (Quantity::MaxSpeedMmS, limit(self.fmc.max_speed_mm_s)),
        ] {
            if let Some(Err(error)) = value.map(|value| quantity.check(single(value))) {
                return Err(text.invalid(
                    &["fmc", quantity.name()],
                    &format!("({error}; 0 or absent: unlimited)"),
                ));
            }
        }
        if self.fmc.flatness_um.len() > FLATNESS_TERMS {
            return Err(text.invalid(
                &["fmc", "flatness_um"],
                &format!("has more than {FLATNESS_TERMS} coefficients"),
            ));
        }
        if self.shutter.profile == Profile::Uniform {
            for (key, ramp) in [
                ("opening_fraction", self.shutter.opening_fraction),
                ("closing_fraction", self.shutter.closing_fraction),
            ] {
                if ramp != 0.0 {
                    return Err(text.invalid(
                        &["shutter", key],
                        "is a ramp, but profile = \"uniform\" has none: write profile = \"trapezoid\" or 0",
                    ));
                }
            }
        }
        Ok(())
    }

    /// L, the distance from the exit pupil to the image, mm.
    #[must_use]
    pub fn exit_pupil_mm(&self) -> f64 {
        self.exit_pupil_mm.unwrap_or(self.principal_distance_mm)
    }

    /// The static distortion, measured - ideal.
    #[must_use]
    pub fn lens(&self) -> Lens {
        let table = &self.distortion;
        let sign = match table.sign {
            Sign::Distortion => 1.0,
            Sign::Correction => -1.0,
        };
        Lens {
            k: [table.k0, table.k1, table.k2, table.k3].map(|k| sign * k),
            p: [table.p1, table.p2].map(|p| sign * p),
            b: [table.b1, table.b2].map(|b| sign * b),
        }
    }

    /// Format: half of width and height, mm.
    #[must_use]
    pub fn half_format_mm(&self) -> [f64; 2] {
        [self.sensor.width_px, self.sensor.height_px]
            .map(|side| count(side) * self.sensor.pixel_um / 2000.0)
    }

    /// Sensor-frame point of a pixel coordinate (column, row), mm.
    #[must_use]
    pub fn sensor_from_pixel(&self, [col, row]: [f64; 2]) -> [f64; 2] {
        let [centre_col, centre_row] = self.centre_px();
        let pixel_mm = self.sensor.pixel_um / 1000.0;
        [(col - centre_col) * pixel_mm, (centre_row - row) * pixel_mm]
    }

    /// Pixel coordinate (column, row) of a sensor-frame point in mm.
    #[must_use]
    pub fn pixel_from_sensor(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [centre_col, centre_row] = self.centre_px();
        let pixel_mm = self.sensor.pixel_um / 1000.0;
        [centre_col + x / pixel_mm, centre_row - y / pixel_mm]
    }

    fn centre_px(&self) -> [f64; 2] {
        [self.sensor.width_px, self.sensor.height_px].map(|side| (count(side) - 1.0) / 2.0)
    }

    /// What the camera is given: the numbers of the file in single precision.
    #[must_use]
    pub fn record(&self) -> CameraRecord {
        let lens = self.lens();
        let [k0, k1, k2, k3] = lens.k.map(single);
        let [p1, p2] = lens.p.map(single);
        let [b1, b2] = lens.b.map(single);
        let [x_mm, y_mm] = self.principal_point_mm.map(single);
        let mut coefficients_um = [0.0; FLATNESS_TERMS];
        for (coefficient, value) in coefficients_um.iter_mut().zip(&self.fmc.flatness_um) {
            *coefficient = single(*value);
        }
        CameraRecord {
            calibration: CalibrationRecord {
                principal_distance_mm: single(self.principal_distance_mm),
                exit_pupil_mm: single(self.exit_pupil_mm()),
                principal_point: SensorPoint::new(x_mm, y_mm),
                // What is no pixel count becomes 0, which validation refuses.
                width_px: u32::try_from(self.sensor.width_px).unwrap_or(0),
                height_px: u32::try_from(self.sensor.height_px).unwrap_or(0),
                pixel_um: single(self.sensor.pixel_um),
                distortion: Brown {
                    k0,
                    k1,
                    k2,
                    k3,
                    p1,
                    p2,
                    b1,
                    b2,
                },
                fitted: self.fitted.as_ref().map(|fitted| FiveCoefficients {
                    km0: single(fitted.km0),
                    km1: single(fitted.km1),
                    km2: single(fitted.km2),
                    kd1: single(fitted.kd1),
                    pm1: single(fitted.pm1),
                    regressor: fitted.per.into(),
                }),
                axis: self.fmc.axis.into(),
                stroke_mm: single(self.fmc.stroke_mm),
                flatness: Flatness { coefficients_um },
            },
            mechanism: match self.fmc.mechanism {
                MechanismName::Stage => Mechanism::Stage {
                    acceleration_mm_s2: single(self.fmc.acceleration_mm_s2),
                    settling_ms: single(self.fmc.settling_ms),
                    run_up: self.fmc.strategy.unwrap_or_default().into(),
                    jerk_mm_s3: limit(self.fmc.jerk_mm_s3).map(single),
                    max_speed_mm_s: limit(self.fmc.max_speed_mm_s).map(single),
                },
                MechanismName::Tdi => Mechanism::Tdi {
                    first_transfer: single(self.fmc.first_transfer),
                },
            },
            shutter: match self.shutter.profile {
                Profile::Uniform => ShutterProfile::Uniform,
                Profile::Trapezoid => ShutterProfile::Trapezoid {
                    opening_fraction: single(self.shutter.opening_fraction),
                    closing_fraction: single(self.shutter.closing_fraction),
                },
            },
            limits: Limits {
                vh_per_s: self.limits.vh_per_s.map(single),
                exposure_s: self.limits.exposure_s.map(single),
            },
        }
    }
}

/// Two numbers, no more and no fewer.
fn pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
    let numbers = Vec::<f64>::deserialize(deserializer)?;
    let count = numbers.len();
    numbers
        .try_into()
        .map_err(|_| D::Error::custom(format!("{count} numbers where 2 are expected")))
}

/// A pixel count as a number.
#[expect(clippy::cast_precision_loss, reason = "validated to be at most 100000")]
const fn count(pixels: i64) -> f64 {
    pixels as f64
}
