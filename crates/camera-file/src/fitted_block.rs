//! Insertion of coefficients into the text of a camera file, which otherwise stays as it is.

use std::str::FromStr;

use toml_edit::{DocumentMut, Value};

use crate::camera::CameraFile;
use crate::input_error::InputError;
use crate::insertion::{float, put, table};
use crate::tables::{FittedTable, Sign};

/// A static coefficient that was estimated together with the five: its key in `[distortion]` and
/// its value, measured - ideal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decentring {
    /// Key, `p1` or `p2`.
    pub key: &'static str,
    /// Value, mm⁻¹.
    pub per_mm: f64,
}

/// Returns the text of a camera file with these coefficients; comments, order and all other values
/// of `text` are kept. `file` is the name that messages use.
///
/// # Errors
/// [`InputError`] for a text that is not TOML, and if the camera with the coefficients would not be
/// usable.
pub fn with_coefficients(
    file: &str,
    text: &str,
    fitted: &FittedTable,
    decentring: Option<Decentring>,
) -> Result<String, InputError> {
    let (camera, _) = CameraFile::parse(file, text)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let not_toml = |error: &dyn std::fmt::Display| InputError::invalid(format!("{file}: {error}"));
    let mut document = DocumentMut::from_str(text).map_err(|error| not_toml(&error))?;
    let block = table(&mut document, "fitted").ok_or_else(|| not_toml(&"fitted is no table"))?;
    for (key, number) in [
        ("km0", fitted.km0),
        ("km1", fitted.km1),
        ("km2", fitted.km2),
        ("kd1", fitted.kd1),
        ("pm1", fitted.pm1),
    ] {
        put(block, key, float(number));
    }
    put(block, "per", Value::from(fitted.per.name()));
    if let Some(Decentring { key, per_mm }) = decentring {
        let sign = match camera.distortion.sign {
            Sign::Distortion => 1.0,
            Sign::Correction => -1.0,
        };
        let block = table(&mut document, "distortion")
            .ok_or_else(|| not_toml(&"distortion is no table"))?;
        put(block, key, float(sign * per_mm));
    }
    let text = document.to_string();
    CameraFile::parse(&format!("{file} with the coefficients"), &text)?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tables::Per;

    const CAMERA: &str = "# Serial 7\nname = \"A\" # owner: B\nprincipal_distance_mm = 100\n\n[fitted] # of June\nkm1 = -1e-6 # old\n\n# the lens\n[distortion]\nsign = \"correction\"\np1 = 0.0\n[sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n";

    const FITTED: FittedTable = FittedTable {
        km0: 1e-4,
        km1: -1.25e-6,
        km2: 0.0,
        kd1: 2e-6,
        pm1: 1e-6,
        per: Per::Centroid,
    };

    #[test]
    fn everything_but_the_coefficients_stays_as_it_was() {
        let text = with_coefficients("a.toml", CAMERA, &FITTED, None).unwrap();
        for line in CAMERA.lines().filter(|line| !line.starts_with("km1")) {
            assert!(text.lines().any(|kept| kept == line), "{line}\n{text}");
        }
        assert!(text.contains("km1 = -1.25e-6 # old\n"), "{text}");
        assert!(text.find("[fitted]").unwrap() < text.find("# the lens").unwrap());
        let (camera, _) = CameraFile::parse("b.toml", &text).unwrap();
        assert_eq!(camera.fitted, Some(FITTED));
    }

    #[test]
    fn table_that_is_not_there_is_added_at_the_end() {
        let without = CAMERA.replace("[fitted] # of June\nkm1 = -1e-6 # old\n\n", "");
        let text = with_coefficients("a.toml", &without, &FITTED, None).unwrap();
        assert!(text.starts_with(&without), "{text}");
        assert!(text.contains("\n\n[fitted]\nkm0 = 1e-4\n"), "{text}");
    }

    #[test]
    fn decentring_has_the_sign_of_its_table() {
        let decentring = Decentring {
            key: "p1",
            per_mm: 2e-6,
        };
        let text = with_coefficients("a.toml", CAMERA, &FITTED, Some(decentring)).unwrap();
        assert!(text.contains("p1 = -2e-6\n"), "{text}");
        let (camera, _) = CameraFile::parse("b.toml", &text).unwrap();
        let distortion = camera.distortion.measured_minus_ideal();
        assert_eq!(
            [distortion.p1, distortion.p2].map(f64::to_bits),
            [2e-6_f64, -0.0].map(f64::to_bits)
        );
    }

    #[test]
    fn coefficients_that_fold_the_image_are_refused() {
        let folding = FittedTable {
            km1: 1e-3,
            ..FITTED
        };
        assert!(with_coefficients("a.toml", CAMERA, &folding, None).is_err());
    }
}
