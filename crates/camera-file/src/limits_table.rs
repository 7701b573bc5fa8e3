//! `[limits]` of the camera file, or the limits of a camera that states none.

use std::fmt::Display;

use fmc_camera::geometry::range::Quantity;
use serde::{Deserialize, Deserializer};

use crate::tables::pair;

/// `[limits]`: exposures that the camera accepts.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(from = "Written")]
pub struct LimitsTable {
    /// Smallest and largest V/H, 1/s.
    pub vh_per_s: [f64; 2],
    /// Shortest and longest exposure, s.
    pub exposure_s: [f64; 2],
    is_vh_default: bool,
    is_exposure_default: bool,
}

/// The table as it is written.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Written {
    #[serde(deserialize_with = "some_pair")]
    vh_per_s: Option<[f64; 2]>,
    #[serde(deserialize_with = "some_pair")]
    exposure_s: Option<[f64; 2]>,
}

impl From<Written> for LimitsTable {
    fn from(written: Written) -> Self {
        Self {
            vh_per_s: written.vh_per_s.unwrap_or(VH_PER_S),
            exposure_s: written.exposure_s.unwrap_or(EXPOSURE_S),
            is_vh_default: written.vh_per_s.is_none(),
            is_exposure_default: written.exposure_s.is_none(),
        }
    }
}

/// Smallest and largest V/H of a file that states none, 1/s: those of
/// [`Limits::DEFAULT`](fmc_camera::flight::exposure::Limits::DEFAULT) in double precision.
const VH_PER_S: [f64; 2] = [0.01, 0.3];

/// Shortest and longest exposure of a file that states none, s.
const EXPOSURE_S: [f64; 2] = [1.0 / 5000.0, 1.0 / 30.0];

impl Default for LimitsTable {
    fn default() -> Self {
        Written::default().into()
    }
}

impl LimitsTable {
    /// Returns `true` if the file does not have `vh_per_s`.
    #[must_use]
    pub const fn is_vh_default(&self) -> bool {
        self.is_vh_default
    }

    /// Returns `true` if the file does not have `exposure_s`.
    #[must_use]
    pub const fn is_exposure_default(&self) -> bool {
        self.is_exposure_default
    }

    /// Returns the words that tell where the limits of a quantity come from: the table of a file,
    /// or the defaults of a file that does not have them.
    #[must_use]
    pub fn origin(&self, quantity: Quantity, file: &impl Display) -> String {
        let is_default = match quantity {
            Quantity::VhPerS => self.is_vh_default,
            _ => self.is_exposure_default,
        };
        if !is_default {
            format!("[limits] of {file}")
        } else if self.is_vh_default && self.is_exposure_default {
            format!("default limits; {file} has no [limits]")
        } else {
            format!(
                "default limits; [limits] of {file} has no {}",
                quantity.name()
            )
        }
    }
}

/// Reads exactly two numbers.
fn some_pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    pair(deserializer).map(Some)
}

#[cfg(test)]
mod tests {
    use fmc_camera::flight::exposure::Limits;

    use crate::CameraFile;
    use crate::number::single;

    use super::*;

    fn read(limits: &str) -> LimitsTable {
        let text = format!(
            "name = \"t\"\nprincipal_distance_mm = 100.0\n\
             [sensor]\nwidth_px = 1000\nheight_px = 500\npixel_um = 10.0\n{limits}"
        );
        CameraFile::parse("t.toml", &text).unwrap().0.limits
    }

    #[test]
    fn defaults_are_those_of_the_library() {
        let limits = read("");
        let in_the_cameras_precision = Limits {
            vh_per_s: limits.vh_per_s.map(single),
            exposure_s: limits.exposure_s.map(single),
        };
        assert_eq!(in_the_cameras_precision, Limits::DEFAULT);
    }

    #[test]
    fn origin_tells_written_limits_from_defaults() {
        let says = |limits, quantity| read(limits).origin(quantity, &"t.toml");
        let vh = "[limits]\nvh_per_s = [0.1, 0.2]\n";
        let none = "default limits; t.toml has no [limits]";
        for quantity in [Quantity::VhPerS, Quantity::ExposureS] {
            assert_eq!(says("", quantity), none);
        }
        assert_eq!(says(vh, Quantity::VhPerS), "[limits] of t.toml");
        assert_eq!(
            says(vh, Quantity::ExposureS),
            "default limits; [limits] of t.toml has no exposure_s"
        );
    }
}
