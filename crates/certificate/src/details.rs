//! Details of a certificate that no camera file has: laboratory, persons, instruments, dates.

use std::fmt;

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use toml::value::Datetime;

/// Statements of a certificate beside the camera file; whatever is missing is printed as "not
/// stated".
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the file"
)]
pub struct Details {
    pub number: Option<String>,
    pub calibrated_on: Option<Date>,
    pub issued_on: Option<Date>,
    pub valid_until: Option<Date>,
    pub laboratory: Laboratory,
    pub camera: Instrument,
    pub lens: Instrument,
    pub stage: Instrument,
    pub encoder: Instrument,
    /// Persons who sign, `person` tables.
    #[serde(rename = "person")]
    pub persons: Vec<Person>,
    /// Method and set-up of the calibration, in words.
    pub procedure: Option<String>,
    /// Standards to which the lengths and angles are traced.
    pub traceability: Option<String>,
    /// Conditions such as temperature and pressure, in words.
    pub environment: Option<String>,
    pub remarks: Option<String>,
}

/// `[laboratory]`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the file"
)]
pub struct Laboratory {
    pub name: Option<String>,
    pub address: Option<String>,
    pub accreditation: Option<String>,
}

/// `[camera]`, `[lens]`, `[stage]`, `[encoder]`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the file"
)]
pub struct Instrument {
    pub maker: Option<String>,
    pub model: Option<String>,
    pub serial: Option<String>,
}

/// A table `person`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
#[expect(
    missing_docs,
    reason = "each field is the key of the same name in the file"
)]
pub struct Person {
    pub name: Option<String>,
    pub role: Option<String>,
}

/// A day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Date {
    /// Year.
    pub year: u16,
    /// Month, from 1.
    pub month: u8,
    /// Day, from 1.
    pub day: u8,
}

impl fmt::Display for Date {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

impl Serialize for Date {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Date {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written = Datetime::deserialize(deserializer)?;
        match (written.date, written.time) {
            (Some(date), None) => Ok(Self {
                year: date.year,
                month: date.month,
                day: date.day,
            }),
            _ => Err(serde::de::Error::custom(
                "a day such as 2026-03-14 is expected",
            )),
        }
    }
}

/// Largest length of a text, characters.
const LONGEST: usize = 1000;

impl Details {
    /// Reads the text of a file; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] with file, line and key, for an unknown key, a text that is blank, too long
    /// or has a control character, and dates in the wrong order.
    pub fn parse(file: &str, text: &str) -> Result<Self, InputError> {
        let text = TomlText::new(file, text);
        let details: Self = text.deserialize()?;
        for (path, value) in details.texts() {
            let path: Vec<&str> = path.iter().map(String::as_str).collect();
            if value.trim().is_empty() {
                return Err(text.invalid(&path, "is blank; leave it out where it is not known"));
            }
            if value.contains(|c: char| c.is_control() && c != '\n') {
                return Err(text.invalid(&path, "holds a control character"));
            }
            if value.chars().count() > LONGEST {
                return Err(text.invalid(&path, &format!("is longer than {LONGEST} characters")));
            }
        }
        for (earlier, later, key) in [
            (details.calibrated_on, details.issued_on, "issued_on"),
            (details.calibrated_on, details.valid_until, "valid_until"),
            (details.issued_on, details.valid_until, "valid_until"),
        ] {
            if let (Some(earlier), Some(later)) = (earlier, later)
                && later < earlier
            {
                return Err(text.invalid(&[key], &format!("is before {earlier}")));
            }
        }
        Ok(details)
    }

    /// Returns every text with its path in the file.
    fn texts(&self) -> Vec<(Vec<String>, &str)> {
        let own = [
            ("number", &self.number),
            ("procedure", &self.procedure),
            ("traceability", &self.traceability),
            ("environment", &self.environment),
            ("remarks", &self.remarks),
        ];
        let laboratory = [
            ("name", &self.laboratory.name),
            ("address", &self.laboratory.address),
            ("accreditation", &self.laboratory.accreditation),
        ];
        let instruments = [
            ("camera", &self.camera),
            ("lens", &self.lens),
            ("stage", &self.stage),
            ("encoder", &self.encoder),
        ];
        let instruments = instruments.into_iter().flat_map(|(table, instrument)| {
            [
                ("maker", &instrument.maker),
                ("model", &instrument.model),
                ("serial", &instrument.serial),
            ]
            .map(|(key, value)| (vec![table.to_owned(), key.to_owned()], value))
        });
        let persons = self.persons.iter().enumerate().flat_map(|(index, person)| {
            [("name", &person.name), ("role", &person.role)].map(|(key, value)| {
                let path = vec!["person".to_owned(), index.to_string(), key.to_owned()];
                (path, value)
            })
        });
        own.map(|(key, value)| (vec![key.to_owned()], value))
            .into_iter()
            .chain(
                laboratory
                    .map(|(key, value)| (vec!["laboratory".to_owned(), key.to_owned()], value)),
            )
            .chain(instruments)
            .chain(persons)
            .filter_map(|(path, value)| Some((path, value.as_deref()?)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> String {
        Details::parse("d.toml", text).unwrap_err().to_string()
    }

    #[test]
    fn details_are_read_and_all_may_be_missing() {
        assert_eq!(Details::parse("d.toml", "").unwrap(), Details::default());
        let text = "number = \"7\"\ncalibrated_on = 2026-03-14\n[lens]\nserial = \"L1\"\n\
                    [[person]]\nname = \"A. Berg\"\nrole = \"operator\"\n";
        let details = Details::parse("d.toml", text).unwrap();
        assert_eq!(details.calibrated_on.unwrap().to_string(), "2026-03-14");
        assert_eq!(details.lens.serial.as_deref(), Some("L1"));
        assert_eq!(details.persons.len(), 1);
    }

    #[test]
    fn wrong_details_are_named_with_their_place() {
        assert!(fault("colour = \"red\"").contains("colour"));
        assert!(fault("number = \" \"").contains("d.toml, line 1: number = \" \" is blank"));
        assert!(fault("[[person]]\nname = \"\"").contains("person.0.name"));
        assert!(fault("issued_on = 2026-02-30").contains("line 1"));
        assert!(fault("issued_on = 2026-02-03T10:00:00").contains("a day such as"));
        let order = "calibrated_on = 2026-03-14\nvalid_until = 2026-03-13\n";
        assert!(fault(order).contains("valid_until = 2026-03-13 is before 2026-03-14"));
    }
}
