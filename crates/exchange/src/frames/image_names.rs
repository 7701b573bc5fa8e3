//! Names of the images of a flight: from a pattern, or from a table.

use std::collections::HashMap;
use std::fmt::Write as _;

use fmc_camera_file::InputError;
use fmc_frames::ImageMap;

use super::flight::Flight;
use super::image_camera::ImageCamera;

/// Pattern of the names where none is stated.
pub const PATTERN: &str = "IMG_{sequence:05}.tif";

/// Names of the images.
#[derive(Debug, Clone, PartialEq)]
pub enum ImageNames {
    /// Every name is made of the sequence number.
    Pattern(Pattern),
    /// Every name is a row of a table.
    Map(ImageMap),
}

/// Text with places for the sequence number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    text: String,
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Text(String),
    /// The sequence number, filled up with zeros to a number of digits.
    Sequence(usize),
}

impl Pattern {
    /// Reads a pattern such as [`PATTERN`]: `{sequence}`, or `{sequence:05}` for five digits at
    /// least.
    ///
    /// # Errors
    /// The fault, for a pattern without a place for the number, or with another one.
    pub fn parse(text: &str) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some((before, behind)) = rest.split_once('{') {
            let (place, after) = behind
                .split_once('}')
                .ok_or_else(|| "a { without its }".to_owned())?;
            parts.push(Part::Text(before.to_owned()));
            parts.push(Part::Sequence(digits(place)?));
            rest = after;
        }
        parts.push(Part::Text(rest.to_owned()));
        if parts.len() == 1 {
            return Err("no {sequence}: all images would have one name".to_owned());
        }
        if text.contains(char::is_control) {
            return Err("a control character".to_owned());
        }
        Ok(Self {
            text: text.to_owned(),
            parts,
        })
    }

    /// The pattern as it was written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    fn write(&self, sequence: u32, name: &mut String) {
        for part in &self.parts {
            match part {
                Part::Text(text) => name.push_str(text),
                // Writing to a string does not fail.
                Part::Sequence(digits) => {
                    let _ = write!(name, "{sequence:0digits$}");
                }
            }
        }
    }
}

/// Returns the least number of digits of a place.
fn digits(place: &str) -> Result<usize, String> {
    let other = || format!("{{{place}}} is not {{sequence}} or such as {{sequence:05}}");
    let width = place.strip_prefix("sequence").ok_or_else(other)?;
    if width.is_empty() {
        return Ok(0);
    }
    width
        .strip_prefix(":0")
        .and_then(|digits| digits.parse().ok())
        .filter(|digits| (1..=20).contains(digits))
        .ok_or_else(other)
}

impl ImageNames {
    /// Checks that every frame has a name of its own, and every row of a table a frame.
    ///
    /// # Errors
    /// [`InputError`] naming the table and its line: a gap, a trigger that was refused, a sequence
    /// number that no record has, a name that holds a control character.
    pub fn check(&self, flight: &Flight) -> Result<(), InputError> {
        let Self::Map(map) = self else {
            return Ok(());
        };
        let file = map.file();
        let at = |sequence: u32, fault: String| {
            let line = map.line(sequence).unwrap_or_default();
            InputError::invalid(format!("{file}, line {line}: {fault}"))
        };
        let mut exposed: Vec<u32> = flight.frames.iter().map(|frame| frame.sequence).collect();
        exposed.sort_unstable();
        for sequence in &exposed {
            match map.image(*sequence) {
                None => {
                    return Err(InputError::invalid(format!(
                        "{file}: column sequence: {sequence} is missing, which the records have as \
                         an exposure"
                    )));
                }
                Some(image) if image.contains(char::is_control) => {
                    let fault = format!("image = {image:?} holds a control character");
                    return Err(at(*sequence, fault));
                }
                Some(_) => {}
            }
        }
        let surplus = map
            .sequences()
            .into_iter()
            .find(|sequence| exposed.binary_search(sequence).is_err());
        let Some(sequence) = surplus else {
            return Ok(());
        };
        let refused = flight.refused.iter().find(|one| one.sequence == sequence);
        let fault = refused.map_or_else(
            || format!("sequence = {sequence}: no record has it"),
            |refused| {
                format!(
                    "sequence = {sequence} is a refused trigger ({}): it has no image",
                    refused.reason
                )
            },
        );
        Err(at(sequence, fault))
    }

    /// Checks that a part of the names tells the images apart.
    pub(crate) fn check_distinct(
        &self,
        flight: &Flight,
        part: fn(&str) -> &str,
    ) -> Result<(), InputError> {
        let map = match self {
            // Numbers differ: the part does if it holds the number.
            Self::Pattern(pattern) => {
                let label = part(pattern.text());
                if label.contains("{sequence") || flight.frames.len() == 1 {
                    return Ok(());
                }
                return Err(InputError::invalid(format!(
                    "--image-name {}: all images have the label {label:?}",
                    pattern.text()
                )));
            }
            Self::Map(map) => map,
        };
        let mut others: HashMap<&str, u32> = HashMap::with_capacity(flight.frames.len());
        for frame in &flight.frames {
            let image = map.image(frame.sequence).unwrap_or_default();
            if let Some(other) = others.insert(part(image), frame.sequence) {
                let line = map.line(frame.sequence).unwrap_or_default();
                return Err(InputError::invalid(format!(
                    "{}, line {line}: image = {image:?} has the label of sequence {other}",
                    map.file()
                )));
            }
        }
        Ok(())
    }

    /// Calls `each` with every frame and the name of its image; frames without a name are passed
    /// over ([`check`](Self::check) finds them).
    ///
    /// # Errors
    /// Those of `each`.
    pub fn each<E>(
        &self,
        frames: &[ImageCamera],
        mut each: impl FnMut(&ImageCamera, &str) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut name = String::new();
        for frame in frames {
            match self {
                Self::Pattern(pattern) => {
                    name.clear();
                    pattern.write(frame.sequence, &mut name);
                    each(frame, &name)?;
                }
                Self::Map(map) => {
                    if let Some(image) = map.image(frame.sequence) {
                        each(frame, image)?;
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(pattern: &str, sequence: u32) -> String {
        let mut name = String::new();
        Pattern::parse(pattern).unwrap().write(sequence, &mut name);
        name
    }

    #[test]
    fn pattern_fills_up_with_zeros_and_never_cuts() {
        assert_eq!(name(PATTERN, 7), "IMG_00007.tif");
        assert_eq!(name(PATTERN, 1_234_567), "IMG_1234567.tif");
        assert_eq!(name("{sequence}", 0), "0");
        assert_eq!(name("s{sequence:03}/{sequence}.jpg", 12), "s012/12.jpg");
    }

    #[test]
    fn pattern_of_another_kind_is_refused_by_what_is_wrong() {
        for (text, fault) in [
            ("IMG.tif", "no {sequence}"),
            ("", "no {sequence}"),
            ("IMG_{sequence", "without its }"),
            ("IMG_{seq}.tif", "{seq} is not"),
            ("{sequence:5}", "{sequence:5} is not"),
            ("{sequence:0}", "{sequence:0} is not"),
            ("{sequence:099}", "{sequence:099} is not"),
            ("a\n{sequence}", "control character"),
        ] {
            let found = Pattern::parse(text).unwrap_err();
            assert!(found.contains(fault), "{text}: {found}");
        }
    }
}
