//! Validated scenario of a block, with its camera.

use std::path::Path;

use fmc_camera::Camera;
use fmc_camera_file::toml_text::TomlText;
use fmc_camera_file::{CameraFile, InputError};

use super::flight_plan::{FlightPlan, Station, ground_speeds_m_s};
use super::planned_exposure::planned;
use super::scenario_file::ScenarioFile;
use super::scenario_range;
use crate::range::{Range, SPEED, whole};
use crate::scenario_kind::ScenarioKind;
use crate::scenario_text;
use crate::strip_experiment::terrain::Terrain;

/// Least number of control points with which shifts of the strips are determined.
const FEWEST_CONTROL_POINTS: i64 = 3;

/// A validated scenario with its camera.
#[derive(Debug, Clone)]
pub struct Scenario {
    /// File name that messages use.
    pub file: String,
    /// The scenario as written.
    pub written: ScenarioFile,
    /// The camera file, with the scenario's run-up.
    pub camera: CameraFile,
    /// The camera itself, which plans the exposures.
    pub(super) planner: Camera,
    /// Stations of the exposures.
    pub plan: FlightPlan,
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
            .map_err(|error| ScenarioKind::Block.expected(file, &text, error))?;
        written.check(&text)?;
        let camera_path = scenario_text::camera_path(&text, folder, &written.camera)?;
        let camera = scenario_text::camera_with(&camera_path, written.flight.run_up)?;
        let planner = Camera::new(camera.parameters())
            .map_err(|error| InputError::invalid(format!("{}: {error}", camera_path.display())))?;
        let plan = FlightPlan::new(&written, &camera);
        let scenario = Self {
            file: file.to_owned(),
            written,
            camera,
            planner,
            plan,
        };
        scenario.check_wrong_record(&text)?;
        scenario.check_exposures(&text)?;
        Ok(scenario)
    }

    /// The ground.
    #[must_use]
    pub const fn terrain(&self) -> Terrain {
        let table = &self.written.terrain;
        Terrain {
            height_m: table.height_m,
            relief_m: table.relief_m,
            wavelength_m: table.wavelength_m,
        }
    }

    fn check_wrong_record(&self, text: &TomlText) -> Result<(), InputError> {
        let Some(wrong) = &self.written.wrong_record else {
            return Ok(());
        };
        let frames = u32::try_from(self.plan.stations.len()).unwrap_or(u32::MAX);
        let allowed = Range {
            least: 1.0,
            most: f64::from(frames),
            unit: "of the block's frames",
        };
        allowed.check(whole(wrong.frame), text, &["wrong_record", "frame"])
    }

    /// Refuses exposures that the camera refuses, at the least and the largest V/H and time.
    fn check_exposures(&self, text: &TomlText) -> Result<(), InputError> {
        let ScenarioFile {
            flight, terrain, ..
        } = &self.written;
        let relief_m = if flight.follows_terrain {
            terrain.relief_m
        } else {
            0.0
        };
        for speed_m_s in self.plan.stations.iter().map(Station::speed_m_s) {
            for relief_m in [-relief_m, relief_m] {
                let height_m = flight.height_m - terrain.height_m - relief_m;
                let vh_per_s = speed_m_s / height_m;
                for exposure_s in flight.exposure_s {
                    planned(&self.planner, vh_per_s, exposure_s, 0.0).map_err(
                        |error| {
                            text.invalid(
                                &["flight", "height_m"],
                                &format!(
                                    "with {speed_m_s:.1} m/s over ground is V/H {vh_per_s:.4} 1/s; with exposure_s = {exposure_s} \
                                     the camera refuses the exposure: {error}"
                                ),
                            )
                        },
                    )?;
                }
            }
        }
        Ok(())
    }
}

impl ScenarioFile {
    fn check(&self, text: &TomlText) -> Result<(), InputError> {
        if self.name.trim().is_empty() || self.name.contains(char::is_control) {
            return Err(text.invalid(&["name"], "is empty or holds a control character"));
        }
        scenario_range::check_numbers(self, text)?;
        let [least_s, most_s] = self.flight.exposure_s;
        if least_s > most_s {
            return Err(text.invalid(
                &["flight", "exposure_s"],
                "is not in order: allowed the shortest, then the longest time",
            ));
        }
        if let Some(speed) = ground_speeds_m_s(&self.flight)
            .into_iter()
            .find(|speed| !SPEED.holds(*speed))
        {
            return Err(text.invalid(
                &["flight", "wind_m_s"],
                &format!(
                    "with speed_m_s = {} leaves {speed} m/s over ground: allowed {SPEED}",
                    self.flight.speed_m_s
                ),
            ));
        }
        if (1..FEWEST_CONTROL_POINTS).contains(&self.control.points) {
            return Err(text.invalid(
                &["control", "points"],
                &format!(
                    "is too few for shifts of the strips: allowed 0, or {FEWEST_CONTROL_POINTS} to 50 points"
                ),
            ));
        }
        Ok(())
    }
}
