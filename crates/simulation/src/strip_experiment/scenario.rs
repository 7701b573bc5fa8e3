//! Validated scenario of a strip over ground control, with its camera.

use std::collections::BTreeSet;
use std::path::Path;

use fmc_camera_file::toml_text::TomlText;
use fmc_camera_file::{CameraFile, InputError};

use super::scenario_file::{FEWEST_CONTROL_POINTS, ScenarioFile};
use super::scenario_range;
use crate::range::Range;
use crate::scenario_kind::ScenarioKind;
use crate::scenario_text;

/// A validated scenario with its camera.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// File name that messages use.
    pub file: String,
    /// The scenario as written.
    pub written: ScenarioFile,
    /// The camera, with the scenario's run-up.
    pub camera: CameraFile,
}

impl Scenario {
    /// Reads and validates a scenario and the camera file it names.
    ///
    /// # Errors
    /// [`InputError`] naming file, line, field, value and allowed range.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let text = scenario_text::read(path)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(&path.display().to_string(), &text, folder)
    }

    /// Parses and validates a scenario. `file` is the name that messages use for the text, `folder`
    /// the one in which a relative camera file is looked for.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &str, text: &str, folder: &Path) -> Result<Self, InputError> {
        let text = TomlText::new(file, text);
        let written: ScenarioFile = text
            .deserialize()
            .map_err(|error| ScenarioKind::Strip.expected(file, &text, error))?;
        written.check(&text)?;
        let camera_path = scenario_text::camera_path(&text, folder, &written.camera)?;
        let camera = scenario_text::camera_with(&camera_path, written.flight.run_up)?;
        Ok(Self {
            file: file.to_owned(),
            written,
            camera,
        })
    }

    /// Creates the error of a field: file, field and fault.
    #[must_use]
    pub fn fault(&self, field: &str, fault: impl std::fmt::Display) -> InputError {
        InputError::invalid(format!("{}: {field}: {fault}", self.file))
    }

    /// η: ground speed over the height above the mean terrain, 1/s.
    #[must_use]
    pub fn vh_per_s(&self) -> f64 {
        let flight = &self.written.flight;
        flight.speed_m_s / (flight.height_m - self.written.terrain.height_m)
    }

    /// Returns the same flight with the detector in its calibrated plane, which the camera knows;
    /// `None` if it is there already, and the camera is told so.
    #[must_use]
    pub fn without_focus_shift(&self) -> Option<Self> {
        let is_there = self.written.truth.focus_shift_um.abs() > 0.0
            || self.known_focus_shift_um().abs() > 0.0;
        is_there.then(|| {
            let mut other = self.clone();
            other.written.truth.focus_shift_um = 0.0;
            other.written.correction.focus_shift_um = None;
            other
        })
    }

    /// Returns the planimetric RMS, X and Y together, that the errors of survey and image
    /// coordinates cause by themselves at nadir, however well a frame is corrected and oriented, m.
    ///
    /// # Model
    /// √2·√(σs² + (σi·(H - h)/f)²), with σs of a surveyed and σi of an image coordinate.
    #[must_use]
    pub fn noise_floor_m(&self) -> f64 {
        let flight = &self.written.flight;
        let scale =
            (flight.height_m - self.written.terrain.height_m) / self.camera.principal_distance_mm;
        let image_m = 1e-3 * self.written.image.sigma_um * scale;
        std::f64::consts::SQRT_2 * self.written.control.sigma_m.hypot(image_m)
    }

    /// Returns the Δz that the camera is told, µm: the true one unless the scenario says otherwise.
    #[must_use]
    pub fn known_focus_shift_um(&self) -> f64 {
        let ScenarioFile {
            correction, truth, ..
        } = &self.written;
        correction.focus_shift_um.unwrap_or(truth.focus_shift_um)
    }
}

impl ScenarioFile {
    fn check(&self, text: &TomlText) -> Result<(), InputError> {
        if self.name.trim().is_empty() || self.name.contains(char::is_control) {
            return Err(text.invalid(&["name"], "is empty or holds a control character"));
        }
        scenario_range::check_numbers(self, text)?;
        self.check_control(text)?;
        let flight = &self.flight;
        if flight.frames > 1 && flight.base_m <= 0.0 {
            return Err(text.invalid(
                &["flight", "frames"],
                "needs base_m, the distance between exposures: 1 to 20000 m",
            ));
        }
        Ok(())
    }

    fn check_control(&self, text: &TomlText) -> Result<(), InputError> {
        let points = &self.control.points;
        if points.len() < FEWEST_CONTROL_POINTS {
            return Err(text.invalid(
                &["control", "points"],
                &format!(
                    "holds {} points; a resection needs at least {FEWEST_CONTROL_POINTS}",
                    points.len()
                ),
            ));
        }
        let terrain = &self.terrain;
        // Surveyed heights follow the terrain, within its relief and the height of a house.
        let margin_m = 2.0 * terrain.relief_m + 20.0;
        let heights = Range {
            least: terrain.height_m - margin_m,
            most: terrain.height_m + margin_m,
            unit: "m",
        };
        let mut ids = BTreeSet::new();
        for (index, point) in points.iter().enumerate() {
            let index = index.to_string();
            let at = |key| ["control", "points", index.as_str(), key];
            if point.id.trim().is_empty() || point.id.contains(char::is_control) {
                return Err(text.invalid(&at("id"), "is empty or holds a control character"));
            }
            if !ids.insert(point.id.as_str()) {
                return Err(text.invalid(&at("id"), "is the id of an earlier point, too"));
            }
            scenario_range::PLACE.check(point.x_m, text, &at("x_m"))?;
            scenario_range::PLACE.check(point.y_m, text, &at("y_m"))?;
            if point.z_m >= self.flight.height_m {
                return Err(text.invalid(
                    &at("z_m"),
                    &format!(
                        "is not below the aircraft, which flies at {} m (point {}); allowed {heights}",
                        self.flight.height_m, point.id
                    ),
                ));
            }
            if !heights.holds(point.z_m) {
                let is_scaled = heights.holds(1000.0 * point.z_m);
                let hint = if is_scaled { "; in kilometres?" } else { "" };
                return Err(text.invalid(
                    &at("z_m"),
                    &format!(
                        "is {} from the terrain (point {}); allowed {heights}, the terrain with twice its relief{hint}",
                        if point.z_m > heights.most { "too far up" } else { "too far down" },
                        point.id
                    ),
                ));
            }
        }
        Ok(())
    }
}
