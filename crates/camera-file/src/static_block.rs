//! Insertion of a static calibration into the text of a camera file; the rest stays as it is.

use std::str::FromStr;

use toml_edit::{Array, DocumentMut, Value};

use crate::camera::CameraFile;
use crate::input_error::InputError;
use crate::insertion::{float, put, table};
use crate::tables::{DistortionTable, Sign};

/// Interior orientation and distortion at the calibrated position of the stage.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticCalibration {
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// Principal point (x0, y0), mm in the sensor frame.
    pub principal_point_mm: [f64; 2],
    /// Coefficients as measured - ideal; the field `sign` is not read.
    pub distortion: DistortionTable,
    /// Run-out of the stage, µm per power of mm, lowest power first; `None` leaves that of the
    /// file.
    pub flatness_um: Option<Vec<f64>>,
}

impl StaticCalibration {
    /// Returns the static calibration of a camera file, without its run-out.
    #[must_use]
    pub fn of(camera: &CameraFile) -> Self {
        Self {
            principal_distance_mm: camera.principal_distance_mm,
            principal_point_mm: camera.principal_point_mm,
            distortion: camera.distortion.measured_minus_ideal(),
            flatness_um: None,
        }
    }
}

/// Returns the text of a camera file with this static calibration, in the sign of its table of
/// distortion; comments, order and all other values of `text` are kept. `file` is the name that
/// messages use.
///
/// # Errors
/// [`InputError`] for a text that is not TOML, and if the camera with the calibration would not be
/// usable.
pub fn with_calibration(
    file: &str,
    text: &str,
    calibration: &StaticCalibration,
) -> Result<String, InputError> {
    let (camera, _) = CameraFile::parse(file, text)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let not_toml = |error: &dyn std::fmt::Display| InputError::invalid(format!("{file}: {error}"));
    let mut document = DocumentMut::from_str(text).map_err(|error| not_toml(&error))?;
    let root = document.as_table_mut();
    put(
        root,
        "principal_distance_mm",
        Value::from(calibration.principal_distance_mm),
    );
    let [x0, y0] = calibration.principal_point_mm;
    put(root, "principal_point_mm", array(&[x0, y0]));
    let sign = match camera.distortion.sign {
        Sign::Distortion => 1.0,
        Sign::Correction => -1.0,
    };
    let DistortionTable {
        sign: _,
        k0,
        k1,
        k2,
        k3,
        p1,
        p2,
        b1,
        b2,
    } = calibration.distortion;
    let block =
        table(&mut document, "distortion").ok_or_else(|| not_toml(&"distortion is no table"))?;
    for (key, number) in [
        ("k0", k0),
        ("k1", k1),
        ("k2", k2),
        ("k3", k3),
        ("p1", p1),
        ("p2", p2),
        ("b1", b1),
        ("b2", b2),
    ] {
        // A coefficient that is zero and not in the file stays out of it.
        if number.abs() > 0.0 || block.contains_key(key) {
            put(block, key, float(sign * number + 0.0));
        }
    }
    if let Some(flatness_um) = &calibration.flatness_um {
        let block = table(&mut document, "fmc").ok_or_else(|| not_toml(&"fmc is no table"))?;
        put(block, "flatness_um", array(flatness_um));
    }
    let text = document.to_string();
    CameraFile::parse(&format!("{file} with the calibration"), &text)?;
    Ok(text)
}

fn array(numbers: &[f64]) -> Value {
    let mut array = Array::new();
    for number in numbers {
        array.push(*number);
    }
    Value::Array(array)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: &str = "# Serial 7\nname = \"A\" # owner: B\nprincipal_distance_mm = 100 # nominal\n\n# the lens\n[distortion]\nsign = \"correction\"\np1 = 0.0\n[sensor]\nwidth_px = 9216\nheight_px = 9216\npixel_um = 8.75\n";

    fn found() -> StaticCalibration {
        StaticCalibration {
            principal_distance_mm: 100.012_345_678,
            principal_point_mm: [0.012, -0.034],
            distortion: DistortionTable {
                k1: -2.5e-7,
                p2: 1e-8,
                ..DistortionTable::default()
            },
            flatness_um: Some(vec![0.0, 0.25]),
        }
    }

    #[test]
    fn calibration_is_read_back_and_the_rest_stays() {
        let text = with_calibration("a.toml", CAMERA, &found()).unwrap();
        for line in [
            "# Serial 7",
            "name = \"A\" # owner: B",
            "# the lens",
            "sign = \"correction\"",
        ] {
            assert!(text.lines().any(|kept| kept == line), "{line}\n{text}");
        }
        assert!(
            text.contains("principal_distance_mm = 100.012345678 # nominal"),
            "{text}"
        );
        assert!(text.contains("k1 = 2.5e-7"), "{text}");
        assert!(!text.contains("k3"), "{text}");
        let (camera, _) = CameraFile::parse("b.toml", &text).unwrap();
        let read = StaticCalibration::of(&camera);
        assert_eq!(
            read.principal_distance_mm.to_bits(),
            100.012_345_678_f64.to_bits()
        );
        assert_eq!(
            read.principal_point_mm.map(f64::to_bits),
            found().principal_point_mm.map(f64::to_bits)
        );
        assert_eq!(read.distortion, found().distortion);
        let flatness: Vec<u64> = camera
            .fmc
            .flatness_um
            .iter()
            .map(|um| um.to_bits())
            .collect();
        assert_eq!(flatness, [0.0_f64, 0.25].map(f64::to_bits));
    }

    #[test]
    fn calibration_that_folds_the_image_is_refused() {
        let mut folding = found();
        folding.distortion.k1 = 1e-3;
        assert!(with_calibration("a.toml", CAMERA, &folding).is_err());
    }
}
