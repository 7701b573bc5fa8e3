//! `PhotoModeler`: the numbers of its camera dialogue, mm.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;

use crate::calibrated::Calibrated;
use crate::correction::Correction;
use crate::decimal::number;
use crate::fields::pixel_count;
use crate::found::{Formula, Found};
use crate::lines::{after, beside, check_finite};
use crate::source::Source;

/// Name of the file.
pub(crate) const FILE: &str = "photomodeler.txt";

/// Names of the numbers, as the dialogue and the reports have them.
const NAMES: [&str; 7] = ["XP", "YP", "K1", "K2", "K3", "P1", "P2"];

/// Writes the numbers as corrections. P1 goes with x².
pub(crate) fn write(camera: &Calibrated) -> String {
    let plain = camera.without_k0();
    let [_, k1, k2, k3] = plain.lens.k;
    let [p1, p2] = plain.lens.p;
    let [x0, y0] = plain.principal_point_mm;
    let [half_width, half_height] = plain.half_format_mm();
    let [width, height] = plain.size_px;
    let rows = [
        ("Focal Length", plain.principal_distance_mm),
        ("Format Size W", 2.0 * half_width),
        ("Format Size H", 2.0 * half_height),
        ("Principal Point X", half_width + x0),
        ("Principal Point Y", half_height - y0),
        ("XP", x0),
        ("YP", y0),
        ("K1", -k1),
        ("K2", -k2),
        ("K3", -k3),
        ("P1", -p1),
        ("P2", -p2),
    ]
    .map(|(name, value)| format!("{name:<18} {}\n", number(value)))
    .concat();
    format!(
        "Camera {}\nImage Size  {width} {height}\n{rows}\
         # mm. Principal Point X, Y: from the left and the upper edge of the format, as in the \
         dialogue;\n# XP, YP: the same from the middle of the format, y up.\n",
        plain.name
    )
}

/// Reads the numbers.
pub(crate) fn read(source: &Source<'_>) -> Result<Found, InputError> {
    let text = source.text()?;
    check_finite(source, text, &NAMES)?;
    let one = |numbers: Option<Vec<f64>>| numbers.and_then(|numbers| numbers.first().copied());
    let named = |phrase: &str| one(beside(text, phrase));
    let required =
        |phrase: &str| named(phrase).ok_or_else(|| source.invalid(format!("{phrase} is missing")));
    let value = |key: &str| one(after(text, key));
    let coefficient =
        |key: &str| value(key).ok_or_else(|| source.invalid(format!("{key} is missing")));
    for unread in ["K4", "P3", "P4"] {
        if value(unread).is_some_and(|value| value.abs() > 0.0) {
            return Err(source.invalid(format!("{unread} is not 0 and has no place here")));
        }
    }
    let principal_point_mm = match (one(after(text, "XP")), one(after(text, "YP"))) {
        (Some(x), Some(y)) => [x, y],
        _ => [
            required("principal point x")? - required("format size w")? / 2.0,
            required("format size h")? / 2.0 - required("principal point y")?,
        ],
    };
    let correction = Correction {
        principal_distance_mm: required("focal length")?,
        principal_point_mm,
        lens: Lens {
            // Reports of older versions have no K3.
            k: [
                0.0,
                -coefficient("K1")?,
                -coefficient("K2")?,
                -value("K3").unwrap_or(0.0),
            ],
            p: [-coefficient("P1")?, -coefficient("P2")?],
            b: [0.0; 2],
        },
        k4: 0.0,
        divisor: [0.0; 3],
        offset_mm: [0.0; 2],
    };
    let mut found = Found::new("camera", Formula::Correction(correction));
    if let [width, height, ..] = *beside(text, "image size").unwrap_or_default()
        && let (Some(width), Some(height)) = (pixel_count(width), pixel_count(height))
    {
        found.size_px = Some([width, height]);
        found.pixel_mm = named("format size w").map(|mm| mm / f64::from(width));
    }
    found.checked(source)
}
