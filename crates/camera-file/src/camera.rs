//! Camera file: calibration, mechanism, shutter and limits of one camera, in TOML.

use std::path::Path;

use fmc_camera::flight::calibration_id::SerialNumber;
use fmc_camera::flight::camera::{Camera, CameraParameters, Mechanism};
use fmc_camera::flight::controller::Controller;
use fmc_camera::flight::exposure::Limits;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{CalibrationError, CalibrationParameters, Polynomial};
use fmc_camera::geometry::five_coefficient::FiveCoefficients;
use fmc_camera::geometry::focus_table;
use fmc_camera::geometry::grid::{GridCarrier, GridChecksums};
use fmc_camera::geometry::principal_distance::{FLATNESS_TERMS, Flatness};
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::geometry::shutter::ShutterProfile;
use serde::Deserialize;

use crate::calibration_error::invalid_calibration;
use crate::grid_files::{self, GridFiles};
use crate::input_error::InputError;
use crate::limits_table::LimitsTable;
use crate::number::single;
use crate::tables::{
    DistortionTable, FittedTable, FmcTable, FocusTable, GridTable, MechanismName, Profile,
    SensorTable, ShutterTable, pair,
};
use crate::text_file;
use crate::toml_text::TomlText;

/// A camera file as written. Units are in the names of the fields, which are those of the file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the camera file"
)]
pub struct CameraFile {
    pub name: String,
    #[serde(default)]
    pub serial: String,
    #[serde(default)]
    pub version: i64,
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
    pub focus: Option<FocusTable>,
    pub grid: Option<GridTable>,
}

impl CameraFile {
    /// Reads and validates a camera file without residual grids.
    ///
    /// # Errors
    /// [`InputError`] naming file, line, field, value and allowed range; also for a file with
    /// `[grid]`, without which its camera would correct otherwise.
    pub fn read(path: &Path) -> Result<(Self, Camera), InputError> {
        Self::parse(&path.display().to_string(), &text_file::read(path)?)
    }

    /// Reads and validates a camera file for a use that has no place for residual grids; `why` says
    /// so in the error of a file with `[grid]`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn read_polynomial(path: &Path, why: &str) -> Result<(Self, Camera), InputError> {
        Self::parse_polynomial(&path.display().to_string(), &text_file::read(path)?, why)
    }

    /// Parses and validates a text as [`read_polynomial`](Self::read_polynomial) does a file;
    /// `file` is the name that messages use.
    ///
    /// # Errors
    /// As [`Self::read_polynomial`].
    pub fn parse_polynomial(
        file: &str,
        text: &str,
        why: &str,
    ) -> Result<(Self, Camera), InputError> {
        Self::without_grids(&TomlText::new(file, text), why)
    }

    /// Reads and validates a camera file with the residual grids that it names; they are empty for
    /// a camera without.
    ///
    /// # Errors
    /// As [`Self::read`], also for the files of `[grid]`; a camera with grids is accepted.
    pub fn read_with_grids(path: &Path) -> Result<(Self, Camera, GridFiles), InputError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let (file, text) = (path.display().to_string(), text_file::read(path)?);
        Self::parse_with_grids(&file, &text, &|name| grid_files::read_from(folder, name))
    }

    /// Parses and validates the text of a camera file whose residual grids `read` returns by their
    /// names; `file` is the name that messages use.
    ///
    /// # Errors
    /// As [`Self::read_with_grids`], and those of `read`.
    pub fn parse_with_grids(
        file: &str,
        text: &str,
        read: &dyn Fn(&str) -> Result<Vec<u8>, InputError>,
    ) -> Result<(Self, Camera, GridFiles), InputError> {
        let text = TomlText::new(file, text);
        let (camera_file, camera) = Self::validated(&text)?;
        let grids = match &camera_file.grid {
            Some(table) => GridFiles::read(&text, table, read, camera.calibration())?,
            None => GridFiles::default(),
        };
        Ok((camera_file, camera, grids))
    }

    /// Parses and validates the text of a camera file without residual grids; `file` is the name
    /// that messages use.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &str, text: &str) -> Result<(Self, Camera), InputError> {
        Self::parse_polynomial(file, text, "without them the camera corrects otherwise")
    }

    fn without_grids(text: &TomlText, why: &str) -> Result<(Self, Camera), InputError> {
        let (camera_file, camera) = Self::validated(text)?;
        if camera_file.grid.is_some() {
            let fault = format!("residual grids are not used here: {why}");
            return Err(text
                .invalid_table("grid", &fault)
                .with_help("for the polynomial alone, take [grid] out of a copy of the file"));
        }
        Ok((camera_file, camera))
    }

    fn validated(text: &TomlText) -> Result<(Self, Camera), InputError> {
        let camera_file: Self = text.deserialize()?;
        camera_file.check_what_only_the_file_knows(text)?;
        let camera = Camera::new(camera_file.parameters())
            .map_err(|error| camera_file.refused(text, &error))?;
        Ok((camera_file, camera))
    }

    /// Returns the error of a camera that is not valid, with advice where there is some.
    fn refused(&self, text: &TomlText, error: &CalibrationError) -> InputError {
        let refusal = invalid_calibration(text, error);
        match error {
            CalibrationError::Folds {
                polynomial: Polynomial::Static,
                ..
            } => match self.folding_advice() {
                Some(advice) => refusal.with_help(advice),
                None => refusal,
            },
            _ => refusal,
        }
    }

    fn check_what_only_the_file_knows(&self, text: &TomlText) -> Result<(), InputError> {
        if self.name.trim().is_empty() {
            return Err(text.invalid(&["name"], "is empty; a camera needs a name"));
        }
        if self.name.contains(char::is_control) {
            return Err(text.invalid(&["name"], "holds a control character"));
        }
        if let Err(error) = SerialNumber::new(&self.serial) {
            return Err(text.invalid(&["serial"], &error.to_string()));
        }
        if u32::try_from(self.version).is_err() {
            let fault = format!("is outside 0 to {}", u32::MAX);
            return Err(text.invalid(&["version"], &fault));
        }
        // The numbers of stage and TDI are both checked, although only one of the two is in use.
        for (quantity, value) in [
            (Quantity::FirstTransfer, self.fmc.first_transfer),
            (Quantity::AccelerationMmS2, self.fmc.acceleration_mm_s2),
            (Quantity::SettlingMs, self.fmc.settling_ms),
        ] {
            quantity
                .check(single(value))
                .map_err(|error| invalid_calibration(text, &error.into()))?;
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
        if let Some(focus) = &self.focus {
            focus.check(text)?;
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

    /// Name of the file of a part's residual grid, as `[grid]` has it.
    #[must_use]
    pub fn grid_name(&self, carrier: GridCarrier) -> Option<&str> {
        let table = self.grid.as_ref()?;
        match carrier {
            GridCarrier::Lens => table.lens.as_deref(),
            GridCarrier::Sensor => table.sensor.as_deref(),
        }
    }

    /// Distance L from the exit pupil to the image, mm.
    #[must_use]
    pub fn exit_pupil_mm(&self) -> f64 {
        self.exit_pupil_mm.unwrap_or(self.principal_distance_mm)
    }

    /// Format: half of width and height, mm.
    #[must_use]
    pub fn half_format_mm(&self) -> [f64; 2] {
        [self.sensor.width_px, self.sensor.height_px]
            .map(|side| count(side) * self.sensor.pixel_um / 2000.0)
    }

    /// Converts a pixel coordinate (column, row) into a point of the sensor frame, mm.
    #[must_use]
    #[inline]
    pub fn sensor_from_pixel(&self, [col, row]: [f64; 2]) -> [f64; 2] {
        let [centre_col, centre_row] = self.centre_px();
        let pixel_mm = self.sensor.pixel_um / 1000.0;
        [(col - centre_col) * pixel_mm, (centre_row - row) * pixel_mm]
    }

    /// Converts a point of the sensor frame, mm, into a pixel coordinate (column, row).
    #[must_use]
    #[inline]
    pub fn pixel_from_sensor(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [centre_col, centre_row] = self.centre_px();
        let pixel_mm = self.sensor.pixel_um / 1000.0;
        [centre_col + x / pixel_mm, centre_row - y / pixel_mm]
    }

    #[inline]
    fn centre_px(&self) -> [f64; 2] {
        [self.sensor.width_px, self.sensor.height_px].map(|side| (count(side) - 1.0) / 2.0)
    }

    /// Returns the record that the camera is given for a flight: limits that the file states as
    /// they are, a default largest V/H as far as the mechanism can fly it with these settings.
    #[must_use]
    pub fn flown(&self, settings: &FlightSettings) -> CameraParameters {
        let parameters = self.parameters();
        if self.limits.is_vh_default() {
            Controller::flyable(&parameters, settings)
        } else {
            parameters
        }
    }

    /// Returns the record that the camera is given: the numbers of the file in single precision.
    #[must_use]
    pub fn parameters(&self) -> CameraParameters {
        let distortion = self.distortion.measured_minus_ideal();
        let [x_mm, y_mm] = self.principal_point_mm.map(single);
        let mut coefficients_um = [0.0; FLATNESS_TERMS];
        for (coefficient, value) in coefficients_um.iter_mut().zip(&self.fmc.flatness_um) {
            *coefficient = single(*value);
        }
        CameraParameters {
            calibration: CalibrationParameters {
                principal_distance_mm: single(self.principal_distance_mm),
                exit_pupil_mm: single(self.exit_pupil_mm()),
                principal_point: SensorPoint::new(x_mm, y_mm),
                // A number that is not a pixel count becomes 0, which validation refuses.
                width_px: u32::try_from(self.sensor.width_px).unwrap_or(0),
                height_px: u32::try_from(self.sensor.height_px).unwrap_or(0),
                pixel_um: single(self.sensor.pixel_um),
                distortion: Brown {
                    k0: single(distortion.k0),
                    k1: single(distortion.k1),
                    k2: single(distortion.k2),
                    k3: single(distortion.k3),
                    p1: single(distortion.p1),
                    p2: single(distortion.p2),
                    b1: single(distortion.b1),
                    b2: single(distortion.b2),
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
            // Both are checked when the file is read.
            serial: SerialNumber::new(&self.serial).unwrap_or_default(),
            version: u32::try_from(self.version).unwrap_or_default(),
            grids: self
                .grid
                .as_ref()
                .map_or(GridChecksums::NONE, GridTable::checksums),
            focus: self
                .focus
                .as_ref()
                .map_or(focus_table::FocusTable::NONE, FocusTable::table),
        }
    }
}

/// Returns a limit of the mechanism; 0 in the file means none.
fn limit(value: f64) -> Option<f64> {
    (value != 0.0).then_some(value)
}

/// Converts a pixel count into a number.
#[expect(clippy::cast_precision_loss, reason = "validated to be at most 100000")]
const fn count(pixels: i64) -> f64 {
    pixels as f64
}
