//! Australis and iWitness: the camera of a report, mm.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;

use crate::calibrated::Calibrated;
use crate::correction::Correction;
use crate::decimal::number;
use crate::fields::pixel_count;
use crate::found::{Formula, Found};
use crate::lines::{after, beside, check_finite};
use crate::source::Source;
use crate::uncertainty::Uncertainty;

/// Variables of a report.
const VARIABLES: [&str; 10] = ["C", "XP", "YP", "K1", "K2", "K3", "P1", "P2", "B1", "B2"];

/// Name of the file.
pub(crate) const FILE: &str = "australis.txt";

/// Writes the camera as corrections, as the reports have them.
///
/// # Errors
/// [`InputError`] for a camera with affinity: the sign of B1 and B2 there is not known.
pub(crate) fn write(camera: &Calibrated) -> Result<String, InputError> {
    if camera.lens.b.iter().any(|b| b.abs() > 0.0) {
        return Err(InputError::invalid(
            "australis: the camera has B1 or B2, whose sign in Australis is not known",
        )
        .with_help("metashape and micmac have a place for both, opencv and colmap for B1"));
    }
    let plain = camera.without_k0();
    let [_, k1, k2, k3] = plain.lens.k;
    let [p1, p2] = plain.lens.p;
    let [x0, y0] = plain.principal_point_mm;
    let [width, height] = plain.size_px;
    let pixel = number(plain.pixel_mm);
    let rows = [
        ("C", plain.principal_distance_mm),
        ("XP", x0),
        ("YP", y0),
        ("K1", -k1),
        ("K2", -k2),
        ("K3", -k3),
        ("P1", -p1),
        ("P2", -p2),
        ("B1", 0.0),
        ("B2", 0.0),
    ]
    .map(|(name, value)| format!("  {name:<4} {}\n", number(value)))
    .concat();
    Ok(format!(
        "Camera {}\nSensor Size (pixels)  {width} {height}\nPixel Size (mm)  {pixel} {pixel}\n\
         Camera Variable  Final Value (mm)\n{rows}",
        plain.name
    ))
}

/// Reads a report: the final value of each variable.
pub(crate) fn read(source: &Source<'_>) -> Result<Found, InputError> {
    let text = source.text()?;
    check_finite(source, text, &VARIABLES)?;
    for unread in ["K4", "P3", "P4"] {
        if after(text, unread).is_some_and(|numbers| numbers.iter().any(|one| one.abs() > 0.0)) {
            return Err(source.invalid(format!("{unread} is not 0 and has no place here")));
        }
    }
    // Initial value, adjustment, final value, initial σ, final σ; or the value alone.
    let value = |key: &str| {
        after(text, key).and_then(|numbers| match numbers.as_slice() {
            [only] | [only, _] => Some(*only),
            [_, _, last, ..] => Some(*last),
            [] => None,
        })
    };
    let required =
        |key: &str| value(key).ok_or_else(|| source.invalid(format!("{key} is missing")));
    let optional = |key: &str| value(key).unwrap_or(0.0);
    for key in ["B1", "B2"] {
        if optional(key).abs() > 0.0 {
            return Err(source
                .invalid(format!(
                    "{key} is not 0, and its sign in Australis is not known"
                ))
                .with_help("calibrate with B1 and B2 held at 0"));
        }
    }
    let correction = Correction {
        principal_distance_mm: required("C")?,
        principal_point_mm: [required("XP")?, required("YP")?],
        lens: Lens {
            // A variable that was not estimated may be left out, but none before P2.
            k: [0.0, -required("K1")?, -required("K2")?, -optional("K3")],
            p: [-required("P1")?, -required("P2")?],
            b: [0.0; 2],
        },
        k4: 0.0,
        divisor: [0.0; 3],
        offset_mm: [0.0; 2],
    };
    let mut found = Found::new("camera", Formula::Correction(correction));
    // The last of five numbers is the final standard deviation.
    let sigmas: Vec<(String, f64)> = VARIABLES
        .iter()
        .filter_map(|key| match *after(text, key)? {
            [_, _, _, _, sigma, ..] => Some(((*key).to_owned(), sigma)),
            _ => None,
        })
        .collect();
    if !sigmas.is_empty() {
        let (parameters, sigma) = sigmas.into_iter().unzip();
        found.uncertainty = Some(Uncertainty {
            parameters,
            sigma,
            correlations: None,
        });
    }
    let size = beside(text, "sensor size").unwrap_or_default();
    if let [width, height] = *size
        && let (Some(width), Some(height)) = (pixel_count(width), pixel_count(height))
    {
        found.size_px = Some([width, height]);
    }
    if let [pixel_mm, ..] = *beside(text, "pixel size").unwrap_or_default() {
        found.pixel_mm = Some(pixel_mm);
    }
    found.checked(source)
}
