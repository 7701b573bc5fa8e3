//! Files of flight settings, which replace the defaults that they name.

use std::fs;
use std::path::Path;

use fmc_camera::flight::settings::FlightSettings;
use toml::{Table, Value};

use crate::InputError;

/// Numbers that have no default.
const OPTIONAL: [&str; 1] = ["drive.index_mm"];

/// Settings of a flight, and which of them were written.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightSettingsFile {
    /// Name that messages use.
    pub name: String,
    /// All settings: those that were written, and the defaults of the others.
    pub settings: FlightSettings,
    written: Table,
}

impl FlightSettingsFile {
    /// Reads a file of settings, each under its name in the camera's own `FlightSettings`.
    ///
    /// # Errors
    /// [`InputError`] naming the file and a setting that does not exist, is of another kind, or is
    /// outside its range.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let text = fs::read_to_string(path).map_err(|error| InputError::reading(path, &error))?;
        let table = text
            .parse()
            .map_err(|error: toml::de::Error| error.to_string());
        table
            .and_then(|table| Self::of_table(path.display().to_string(), table))
            .map_err(|what| InputError::invalid(format!("{}: {what}", path.display())))
    }

    /// Returns the settings of a table; `name` is the one that messages use for it.
    ///
    /// # Errors
    /// The setting that does not exist, is of another kind, or is outside its range.
    pub fn of_table(name: String, written: Table) -> Result<Self, String> {
        let mut settings =
            Table::try_from(FlightSettings::default()).map_err(|error| error.to_string())?;
        overlay(&mut settings, written.clone(), "")?;
        let settings: FlightSettings = settings
            .try_into()
            .map_err(|error: toml::de::Error| error.to_string())?;
        Ok(Self {
            name,
            settings: settings.checked().map_err(|error| error.to_string())?,
            written,
        })
    }

    /// Returns true if a setting was written, not left at its default.
    #[must_use]
    pub fn has(&self, path: &[&str]) -> bool {
        let Some((first, rest)) = path.split_first() else {
            return false;
        };
        let mut value = self.written.get(*first);
        for key in rest {
            value = value.and_then(|value| value.get(*key));
        }
        value.is_some()
    }
}

/// Replaces the settings that are written.
fn overlay(settings: &mut Table, written: Table, above: &str) -> Result<(), String> {
    for (name, value) in written {
        let path = format!("{above}{name}");
        match (settings.get_mut(&name), value) {
            (None, Value::Float(number)) if OPTIONAL.contains(&path.as_str()) => {
                settings.insert(name, Value::Float(number));
            }
            #[expect(
                clippy::cast_precision_loss,
                reason = "whole numbers of settings are small"
            )]
            (None, Value::Integer(number)) if OPTIONAL.contains(&path.as_str()) => {
                settings.insert(name, Value::Float(number as f64));
            }
            (None, value) if OPTIONAL.contains(&path.as_str()) => {
                return Err(format!("{path} = {value} is not a float"));
            }
            (None, _) => return Err(format!("there is no setting {path}")),
            (Some(Value::Table(settings)), Value::Table(written)) => {
                overlay(settings, written, &format!("{path}."))?;
            }
            (Some(place), value) => {
                let value = match (&*place, value) {
                    #[expect(
                        clippy::cast_precision_loss,
                        reason = "whole numbers of settings are small"
                    )]
                    (Value::Float(_), Value::Integer(number)) => Value::Float(number as f64),
                    (_, value) => value,
                };
                if !place.same_type(&value) {
                    return Err(format!("{path} = {value} is not a {}", place.type_str()));
                }
                *place = value;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use fmc_camera::flight::exposure::FlightDirection;

    fn parse(text: &str) -> Result<FlightSettings, String> {
        let table = text
            .parse()
            .map_err(|error: toml::de::Error| error.to_string())?;
        FlightSettingsFile::of_table("settings.toml".to_owned(), table).map(|file| file.settings)
    }

    #[test]
    fn written_settings_are_known_from_defaults() {
        let table = "[drive]\nencoder_step_um = 0.1\n".parse().unwrap();
        let file = FlightSettingsFile::of_table("settings.toml".to_owned(), table).unwrap();
        assert!(file.has(&["drive", "encoder_step_um"]) && file.has(&["drive"]));
        assert!(!file.has(&["drive", "motor_reversed"]) && !file.has(&["exposure_s"]));
        assert_eq!(file.settings, FlightSettings::default());
    }

    #[test]
    fn what_is_not_written_is_the_default_bit_by_bit() {
        assert_eq!(parse("").unwrap(), FlightSettings::default());
        let settings = parse(
            "exposure_s = 0.005\ndirection = \"Reverse\"\n[drive]\nencoder_step_um = 1\n\
             [drive.velocity_loop]\nmax_duty = 0.3\n[vh.laser_height]\nrange = [5, 500.0]\n",
        )
        .unwrap();
        let mut expected = FlightSettings {
            exposure_s: 0.005,
            direction: FlightDirection::Reverse,
            ..FlightSettings::default()
        };
        expected.drive.encoder_step_um = 1.0;
        expected.drive.velocity_loop.max_duty = 0.3;
        expected.vh.laser_height.range = [5.0, 500.0];
        assert_eq!(settings, expected);
    }

    #[test]
    fn documented_example_is_read() {
        let document = include_str!("../../../docs/integration.md");
        let (_, section) = document.split_once("## 3 Settings").unwrap();
        let (_, rest) = section.split_once("```toml\n").unwrap();
        let (example, _) = rest.split_once("```").unwrap();
        let settings = parse(example).unwrap();
        assert!(settings.drive.motor_reversed, "{settings:?}");
        assert_ne!(settings, FlightSettings::default());
    }

    #[test]
    fn wrong_settings_are_named_with_value_and_range() {
        for (text, parts) in [
            ("exposure = 0.1", ["no setting exposure", ""]),
            ("[drive]\nstep = 1", ["no setting drive.step", ""]),
            ("drive = 1", ["drive = 1", "table"]),
            ("exposure_s = true", ["exposure_s = true", "float"]),
            (
                "smear_budget_px = 1000",
                ["smear_budget_px = 1000", "0.01 to 100"],
            ),
            (
                "[drive]\nencoder_step_um = 0",
                ["encoder_step_um = 0", "0.001 to 100"],
            ),
            ("direction = \"Up\"", ["Up", "Reverse"]),
        ] {
            let error = parse(text).unwrap_err();
            for part in parts {
                assert!(error.contains(part), "{text}: {error}");
            }
        }
    }
}
