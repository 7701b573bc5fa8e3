//! Text of a camera file with a given interior orientation.

use std::str::FromStr;

use toml_edit::{DocumentMut, value};

use crate::camera::CameraFile;
use crate::input_error::InputError;
use crate::tables::DistortionTable;

/// Interior orientation of a camera file.
#[derive(Debug, Clone, PartialEq)]
pub struct Interior {
    /// Name of the camera.
    pub name: String,
    /// Principal distance, mm.
    pub principal_distance_mm: f64,
    /// Principal point, mm in the sensor frame.
    pub principal_point_mm: [f64; 2],
    /// Columns and rows, px.
    pub size_px: [u32; 2],
    /// Pixel pitch, µm.
    pub pixel_um: f64,
    /// Distortion, measured - ideal.
    pub distortion: DistortionTable,
}

/// Tables that belong to the camera's mechanism and not to its lens.
const TABLES: [&str; 3] = ["fmc", "shutter", "limits"];

/// Keys that belong to the camera, too.
const KEYS: [&str; 2] = ["serial", "exit_pupil_mm"];

/// Returns the text of a camera file: comments, interior orientation, and from the text `base` of
/// another camera file mechanism, shutter, limits, serial number and exit pupil as they stand
/// there. `file` is the name that messages use.
///
/// # Errors
/// [`InputError`] for a `base` that is not a camera file, and if the camera would not be usable.
pub fn write(
    file: &str,
    comments: &[String],
    interior: &Interior,
    base: Option<&str>,
) -> Result<String, InputError> {
    let not_toml = |error: toml_edit::TomlError| InputError::invalid(format!("{file}: {error}"));
    let mut document = DocumentMut::from_str(&own(interior)).map_err(not_toml)?;
    document.insert("name", value(interior.name.trim()));
    if let Some(base) = base {
        let base = base.strip_prefix('\u{feff}').unwrap_or(base);
        let base = DocumentMut::from_str(base).map_err(not_toml)?;
        for key in KEYS.into_iter().chain(TABLES) {
            if let Some(item) = base.get(key) {
                document.insert(key, item.clone());
            }
        }
    }
    let comments: String = comments
        .iter()
        .flat_map(|comment| comment.lines())
        .flat_map(|line| {
            [
                "# ".to_owned(),
                line.replace(char::is_control, " "),
                "\n".to_owned(),
            ]
        })
        .collect();
    let text = format!("{comments}{document}");
    CameraFile::parse(file, &text)?;
    Ok(text)
}

/// Returns the tables of the lens, whose name is to be put in.
fn own(interior: &Interior) -> String {
    let [x0, y0] = interior.principal_point_mm;
    let [width, height] = interior.size_px;
    let distortion = interior.distortion.measured_minus_ideal();
    let coefficients: String = [
        ("k0", distortion.k0),
        ("k1", distortion.k1),
        ("k2", distortion.k2),
        ("k3", distortion.k3),
        ("p1", distortion.p1),
        ("p2", distortion.p2),
        ("b1", distortion.b1),
        ("b2", distortion.b2),
    ]
    .into_iter()
    .filter(|(_, number)| number.abs() > 0.0)
    .flat_map(|(key, number)| [key.to_owned(), format!(" = {number:?}\n")])
    .collect();
    format!(
        "name = \"\"\nprincipal_distance_mm = {:?}\nprincipal_point_mm = [{x0:?}, {y0:?}]\n\n\
         [sensor]\nwidth_px = {width}\nheight_px = {height}\npixel_um = {:?}\n\n\
         [distortion]\nsign = \"distortion\"\n{coefficients}",
        interior.principal_distance_mm, interior.pixel_um
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interior() -> Interior {
        Interior {
            name: "a \"b\" #1".to_owned(),
            principal_distance_mm: 51.371_200_000_000_1,
            principal_point_mm: [0.0584, -0.0239],
            size_px: [14204, 10652],
            pixel_um: 3.76,
            distortion: DistortionTable {
                k1: -1.6056e-5,
                p2: 4.512_02e-6,
                ..DistortionTable::default()
            },
        }
    }

    #[test]
    fn numbers_come_back_bit_for_bit_with_the_mechanism_of_the_base() {
        let base = "name = \"old\"\nserial = \"A1\"\nexit_pupil_mm = 60.0\n\
                    principal_distance_mm = 50.0\n[sensor]\nwidth_px = 100\nheight_px = 100\n\
                    pixel_um = 9.0\n[fitted]\nkm0 = 1e-5\n\
                    [fmc] # as built\naxis = \"-x\"\nstroke_mm = 3.0\n[limits]\n\
                    vh_per_s = [0.1, 0.2]\n";
        let comments = ["from elsewhere\nof June".to_owned()];
        let text = write("a.toml", &comments, &interior(), Some(base)).unwrap();
        assert!(
            text.starts_with("# from elsewhere\n# of June\nname = "),
            "{text}"
        );
        let (camera, _) = CameraFile::parse("a.toml", &text).unwrap();
        assert_eq!(camera.name, interior().name);
        assert_eq!(camera.distortion, interior().distortion);
        assert_eq!(
            camera.principal_distance_mm.to_bits(),
            51.371_200_000_000_1_f64.to_bits()
        );
        assert_eq!(camera.fmc.axis.name(), "-x");
        assert_eq!(camera.serial, "A1");
        assert_eq!(camera.exit_pupil_mm, Some(60.0));
        // Fitted coefficients belong to the lens that is replaced.
        assert_eq!(camera.fitted, None);
    }

    #[test]
    fn camera_that_cannot_be_used_is_not_written() {
        let mut folding = interior();
        folding.distortion.k1 = 1e-2;
        assert!(write("a.toml", &[], &folding, None).is_err());
        assert!(write("a.toml", &[], &interior(), Some("name =")).is_err());
    }
}
