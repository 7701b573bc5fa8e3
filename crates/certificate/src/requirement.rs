//! Demands of a laboratory's form on a certificate.

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;
use serde::Deserialize;
use serde_json::Value;

use crate::content::Certificate;

/// A form: keys of `certificate.json` that must not be empty.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Requirement {
    /// Name of the form.
    pub name: Option<String>,
    /// Paths of keys, such as `identity.lens.serial`; `parameters.values.*.sigma` demands it of
    /// every element of a list, and `parameters.values.k1.sigma` of the one of that name.
    pub required: Vec<String>,
}

/// End of a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Found {
    Stated,
    Missing,
    Unknown,
}

impl Requirement {
    /// Reads the text of a form; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] with file, line and key.
    pub fn parse(file: &str, text: &str) -> Result<Self, InputError> {
        let text = TomlText::new(file, text);
        let form: Self = text.deserialize()?;
        if form.required.is_empty() {
            return Err(text.invalid(&["required"], "is empty: the form demands nothing"));
        }
        Ok(form)
    }

    /// Returns the paths whose values a certificate does not state.
    ///
    /// # Errors
    /// [`InputError`] for a path that no certificate has; `file` is the name that messages use.
    pub fn missing(&self, file: &str, certificate: &Certificate) -> Result<Vec<&str>, InputError> {
        let content = serde_json::to_value(certificate)
            .map_err(|error| InputError::invalid(format!("certificate: {error}")))?;
        let mut missing = Vec::new();
        for path in &self.required {
            let keys: Vec<&str> = path.split('.').collect();
            match find(&content, &keys) {
                Found::Stated => {}
                Found::Missing => missing.push(path.as_str()),
                Found::Unknown => {
                    return Err(InputError::invalid(format!(
                        "{file}: required: {path} is no key of certificate.json"
                    ))
                    .with_help("a certificate that was written without --require shows its keys"));
                }
            }
        }
        Ok(missing)
    }
}

fn find(value: &Value, keys: &[&str]) -> Found {
    let Some((key, rest)) = keys.split_first() else {
        return if is_stated(value) {
            Found::Stated
        } else {
            Found::Missing
        };
    };
    match value {
        // A part that is not stated at all has none of its keys.
        Value::Null => Found::Missing,
        Value::Object(object) => object
            .get(*key)
            .map_or(Found::Unknown, |value| find(value, rest)),
        Value::Array(list) if *key == "*" => {
            let all = list.iter().map(|value| find(value, rest));
            all.fold(
                if list.is_empty() {
                    Found::Missing
                } else {
                    Found::Stated
                },
                |worst, found| match (worst, found) {
                    (Found::Unknown, _) | (_, Found::Unknown) => Found::Unknown,
                    (Found::Missing, _) | (_, Found::Missing) => Found::Missing,
                    _ => Found::Stated,
                },
            )
        }
        Value::Array(list) => {
            let name = |value: &&Value| ["name", "format"].iter().any(|of| value[*of] == **key);
            list.iter()
                .find(name)
                .map_or(Found::Missing, |value| find(value, rest))
        }
        _ => Found::Unknown,
    }
}

fn is_stated(value: &Value) -> bool {
    match value {
        Value::Null => false,
        Value::String(text) => !text.is_empty(),
        Value::Array(list) => !list.is_empty() && list.iter().all(is_stated),
        Value::Object(object) => object.values().any(is_stated),
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn keys_are_found_by_their_path() {
        let content = json!({
            "identity": {"number": null, "lens": {"serial": "L1", "maker": null}, "persons": []},
            "parameters": {"values": [{"name": "k1", "sigma": 1e-9}, {"name": "k2", "sigma": null}]},
            "observed": null,
        });
        for (path, found) in [
            ("identity.number", Found::Missing),
            ("identity.lens.serial", Found::Stated),
            ("identity.lens", Found::Stated),
            ("identity.persons", Found::Missing),
            ("identity.persons.*.name", Found::Missing),
            ("identity.colour", Found::Unknown),
            ("parameters.values.k1.sigma", Found::Stated),
            ("parameters.values.k2.sigma", Found::Missing),
            ("parameters.values.k9.sigma", Found::Missing),
            ("parameters.values.*.sigma", Found::Missing),
            ("parameters.values.*.colour", Found::Unknown),
            ("observed.radius_mm", Found::Missing),
        ] {
            let keys: Vec<&str> = path.split('.').collect();
            assert_eq!(find(&content, &keys), found, "{path}");
        }
    }

    #[test]
    fn form_that_demands_nothing_is_refused() {
        for text in ["", "required = []", "required = [\"a\"]\ncolour = 1"] {
            assert!(Requirement::parse("form.toml", text).is_err(), "{text}");
        }
    }
}
