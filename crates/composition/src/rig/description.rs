//! Rig file.

use fmc_camera_file::InputError;
use fmc_camera_file::toml_text::TomlText;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::green::Green;
use super::polynomial::{DEGREES, Polynomial, terms};
use crate::number::real;

/// Largest side of an image, px.
const LARGEST_PX: usize = 300_000;

/// Largest number of sub-images: a label image has 8 bits, and 0 is without content.
const LARGEST_COUNT: usize = 255;

/// A camera of several detectors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Name.
    pub name: String,
    /// Principal distance, mm.
    pub principal_distance_mm: f64,
    /// Side of a pixel, µm.
    pub pixel_um: f64,
    /// Virtual image; its principal point is its centre.
    #[serde(rename = "virtual")]
    pub frame: VirtualSize,
    /// Meaning of the polynomials; absent until calibrated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<CalibrationTable>,
    /// Sub-images.
    pub sub: Vec<SubImage>,
    /// Camera of one detector with the same ground cover.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub green: Option<Green>,
}

/// Size of the virtual image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VirtualSize {
    /// Columns.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
}

/// Treatment of the heights of control.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Heights {
    /// Control is projected with its height by the orientation of the exposure: the polynomials
    /// are the camera's.
    Use,
    /// Zhao et al. 2013: the polynomials lead to X, Y of the ground, of one exposure.
    Ignore,
}

/// Meaning of the polynomials.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibrationTable {
    /// Treatment of the heights of control.
    pub heights: Heights,
}

/// A sub-image: one detector.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SubImage {
    /// Name, that of its files.
    #[serde(deserialize_with = "read_id", serialize_with = "write_id")]
    pub id: String,
    /// Columns.
    pub width_px: usize,
    /// Rows.
    pub height_px: usize,
    /// Nominal place of its centre from that of the virtual image, to the right and downwards, px.
    pub place_px: [f64; 2],
    /// Calibrated polynomial.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polynomial: Option<Polynomial>,
}

/// A name may be written as a number.
fn read_id<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Id {
        Number(u32),
        Name(String),
    }
    Ok(match Id::deserialize(deserializer)? {
        Id::Number(number) => number.to_string(),
        Id::Name(name) => name,
    })
}

fn write_id<S: Serializer>(id: &str, serializer: S) -> Result<S::Ok, S::Error> {
    match id.parse::<u32>() {
        Ok(number) if number.to_string() == id => serializer.serialize_u32(number),
        _ => serializer.serialize_str(id),
    }
}

impl SubImage {
    /// Width and height, px.
    #[must_use]
    pub const fn size_px(&self) -> [usize; 2] {
        [self.width_px, self.height_px]
    }

    /// Place in the middle of the pixels, px.
    #[must_use]
    pub fn centre_px(&self) -> [f64; 2] {
        [real(self.width_px), real(self.height_px)].map(|side| (side - 1.0) / 2.0)
    }

    /// Returns true if a place lies on the pixels, edges included.
    #[must_use]
    pub fn contains(&self, [col, row]: [f64; 2]) -> bool {
        let [width, height] = [real(self.width_px), real(self.height_px)];
        (-0.5..=width - 0.5).contains(&col) && (-0.5..=height - 0.5).contains(&row)
    }

    /// Returns the nominal polynomial: a shift.
    #[must_use]
    pub fn nominal(&self, frame: VirtualSize) -> Polynomial {
        let half = real(self.height_px) / 2.0;
        let degree = *DEGREES.start();
        // W/2 is half a pixel right of the middle of the pixels.
        let [u, v] = frame.centre_px();
        let [right, down] = self.place_px;
        let mut polynomial = Polynomial {
            degree,
            u: vec![0.0; terms(degree)],
            v: vec![0.0; terms(degree)],
            sigma_px: 0.0,
        };
        for (list, [constant, by_xi, by_eta]) in [
            (&mut polynomial.u, [u + right + 0.5, half, 0.0]),
            (&mut polynomial.v, [v + down + 0.5, 0.0, half]),
        ] {
            for (slot, value) in list.iter_mut().zip([constant, by_xi, by_eta]) {
                *slot = value;
            }
        }
        polynomial
    }
}

impl VirtualSize {
    /// Place of the centre, px.
    #[must_use]
    pub fn centre_px(&self) -> [f64; 2] {
        [real(self.width_px), real(self.height_px)].map(|side| (side - 1.0) / 2.0)
    }
}

impl Rig {
    /// Parses a rig file; `file` is the name that messages use.
    ///
    /// # Errors
    /// [`InputError`] naming file, key, value and allowed range.
    pub fn parse(file: &str, text: &str) -> Result<Self, InputError> {
        let document = TomlText::new(file, text);
        let rig: Self = document.deserialize()?;
        let positive = |key: &[&str], value: f64, most: f64| {
            if value > 0.0 && value <= most {
                Ok(())
            } else {
                Err(document.invalid(key, &format!("is out of range: above 0 to {most}")))
            }
        };
        positive(&["principal_distance_mm"], rig.principal_distance_mm, 1e4)?;
        positive(&["pixel_um"], rig.pixel_um, 1e4)?;
        let side = |key: &[&str], value: usize, least: usize| {
            if (least..=LARGEST_PX).contains(&value) {
                Ok(())
            } else {
                let fault = format!("is out of range: {least} to {LARGEST_PX} px");
                Err(document.invalid(key, &fault))
            }
        };
        side(&["virtual", "width_px"], rig.frame.width_px, 32)?;
        side(&["virtual", "height_px"], rig.frame.height_px, 32)?;
        if rig.sub.is_empty() {
            return Err(InputError::invalid(format!(
                "{file}: no [[sub]]; at least one"
            )));
        }
        if rig.sub.len() > LARGEST_COUNT {
            return Err(InputError::invalid(format!(
                "{file}: {} [[sub]]; at most {LARGEST_COUNT}",
                rig.sub.len()
            )));
        }
        for (number, sub) in rig.sub.iter().enumerate() {
            let index = number.to_string();
            side(&["sub", &index, "width_px"], sub.width_px, 32)?;
            side(&["sub", &index, "height_px"], sub.height_px, 32)?;
            if rig.sub.iter().take(number).any(|other| other.id == sub.id) {
                return Err(document.invalid(&["sub", &index, "id"], "appears twice"));
            }
            if sub.id.is_empty() || sub.id == "green" || sub.id.contains(['/', '\\', '_', '.']) {
                return Err(document.invalid(
                    &["sub", &index, "id"],
                    "is no name of a sub-image: letters and digits, not \"green\"",
                ));
            }
            let [half_u, half_v] = rig.frame.centre_px();
            let [right, down] = sub.place_px;
            if !(right.abs() <= half_u && down.abs() <= half_v) {
                return Err(document.invalid(
                    &["sub", &index, "place_px"],
                    &format!("is outside the virtual image: ±{half_u}, ±{half_v} px"),
                ));
            }
            if let Some(polynomial) = &sub.polynomial {
                check(&document, &index, polynomial)?;
            }
        }
        if let Some(green) = &rig.green {
            positive(
                &["green", "principal_distance_mm"],
                green.principal_distance_mm,
                1e4,
            )?;
            positive(&["green", "pixel_um"], green.pixel_um, 1e4)?;
            side(&["green", "width_px"], green.width_px, 32)?;
            side(&["green", "height_px"], green.height_px, 32)?;
        }
        Ok(rig)
    }

    /// Returns the rig as a file.
    ///
    /// # Errors
    /// The text cannot be made.
    pub fn text(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }

    /// Returns the number of a sub-image.
    #[must_use]
    pub fn number(&self, id: &str) -> Option<usize> {
        self.sub.iter().position(|sub| sub.id == id)
    }

    /// Principal distance in pixels of the virtual image.
    #[must_use]
    pub fn principal_distance_px(&self) -> f64 {
        1e3 * self.principal_distance_mm / self.pixel_um
    }

    /// Returns the polynomial of a sub-image, the nominal one before the calibration.
    #[must_use]
    pub fn polynomial(&self, sub: &SubImage) -> Polynomial {
        let calibrated = sub.polynomial.clone();
        calibrated.unwrap_or_else(|| sub.nominal(self.frame))
    }

    /// Returns the ids of all sub-images, for messages.
    #[must_use]
    pub fn ids(&self) -> String {
        let ids: Vec<&str> = self.sub.iter().map(|sub| sub.id.as_str()).collect();
        ids.join(", ")
    }
}

fn check(document: &TomlText, index: &str, polynomial: &Polynomial) -> Result<(), InputError> {
    let key = ["sub", index, "polynomial"];
    if !DEGREES.contains(&polynomial.degree) {
        let [a, b, c] = key;
        return Err(document.invalid(&[a, b, c, "degree"], "is out of range: 2 to 5"));
    }
    for (name, list) in [("u", &polynomial.u), ("v", &polynomial.v)] {
        let wanted = terms(polynomial.degree);
        if list.len() != wanted || list.iter().any(|value| !value.is_finite()) {
            let [a, b, c] = key;
            let fault = format!("must be {wanted} finite coefficients");
            return Err(document.invalid(&[a, b, c, name], &fault));
        }
    }
    Ok(())
}
