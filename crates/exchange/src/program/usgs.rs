//! Calibration reports of the USGS: the text of a report.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;

use crate::correction::Correction;
use crate::found::{Formula, Found, Stated};
use crate::lines::{after, beside, check_finite};
use crate::source::Source;

/// Difference of polynomial and printed table that rounding to whole micrometres explains, with
/// rounding of the coefficients, µm.
pub(crate) const TABLE_TOLERANCE_UM: f64 = 0.55;

/// Names of the numbers of a report.
const NAMES: [&str; 11] = [
    "K0", "K1", "K2", "K3", "K4", "P1", "P2", "P3", "P4", "xp", "yp",
];

/// Reads a report. The coefficients are corrections, K0 included; the printed radial distortion is
/// measured - ideal, which shows the sign of the polynomial.
///
/// # Errors
/// [`InputError`] also if the table contradicts the polynomial with either sign.
pub(crate) fn read(source: &Source<'_>, stated: &Stated<'_>) -> Result<Found, InputError> {
    let text = source.text()?;
    check_finite(source, text, &NAMES)?;
    let one = |key: &str| after(text, key).and_then(|numbers| numbers.first().copied());
    let required = |key: &str| one(key).ok_or_else(|| source.invalid(format!("{key} is missing")));
    let focal = beside(text, "focal length")
        .and_then(|numbers| numbers.first().copied())
        .ok_or_else(|| source.invalid("calibrated focal length is missing"))?;
    let point = match (one("xp"), one("yp")) {
        (Some(x), Some(y)) => [x, y],
        _ => match *beside(text, "sym.)").unwrap_or_default() {
            [x, y, ..] => [x, y],
            _ => return Err(source.invalid("the calibrated principal point is missing")),
        },
    };
    for unread in ["K4", "P3", "P4"] {
        if one(unread).is_some_and(|value| value.abs() > 0.0) {
            return Err(source.invalid(format!("{unread} is not 0 and has no place here")));
        }
    }
    let optional = |key: &str| one(key).unwrap_or(0.0);
    let printed = Lens {
        k: [
            required("K0")?,
            required("K1")?,
            required("K2")?,
            optional("K3"),
        ],
        p: [optional("P1"), optional("P2")],
        b: [0.0; 2],
    };
    let (is_correction, note) = sign(source, focal, &printed, text, stated)?;
    let sign = if is_correction { -1.0 } else { 1.0 };
    let correction = Correction {
        principal_distance_mm: focal,
        principal_point_mm: point,
        lens: Lens {
            k: printed.k.map(|k| sign * k),
            p: printed.p.map(|p| sign * p),
            b: [0.0; 2],
        },
        k4: 0.0,
        divisor: [0.0; 3],
        offset_mm: [0.0; 2],
    };
    let found = Found::new("camera", Formula::Correction(correction));
    Found {
        notes: vec![note],
        ..found
    }
    .checked(source)
}

/// Returns `true` for corrections, and the words that say how that was found.
fn sign(
    source: &Source<'_>,
    focal: f64,
    lens: &Lens,
    text: &str,
    stated: &Stated<'_>,
) -> Result<(bool, String), InputError> {
    let angles = beside(text, "field angle").unwrap_or_default();
    let table = beside(text, "symmetric radial (")
        .or_else(|| beside(text, "symmetric radial"))
        .unwrap_or_default();
    if angles.is_empty() || angles.len() != table.len() {
        let is_correction = stated.is_correction.unwrap_or(true);
        let note = "no table of radial distortion: the sign is that of other reports".to_owned();
        return Ok((is_correction, note));
    }
    let largest = |sign: f64| {
        angles
            .iter()
            .zip(&table)
            .map(|(angle, printed_um)| {
                let r = focal * angle.to_radians().tan();
                let [k0, k1, k2, k3] = lens.k;
                let r2 = r * r;
                let radial_um = 1e3 * r * (k0 + r2 * (k1 + r2 * (k2 + r2 * k3)));
                (sign * radial_um - printed_um).abs()
            })
            .fold(0.0, f64::max)
    };
    let [as_correction, as_distortion] = [largest(-1.0), largest(1.0)];
    let (is_correction, off) = if as_correction <= as_distortion {
        (true, as_correction)
    } else {
        (false, as_distortion)
    };
    if off > TABLE_TOLERANCE_UM {
        return Err(source
            .invalid(format!(
                "the printed radial distortion differs by {off:.2} µm from the polynomial"
            ))
            .with_help(
                "whole micrometres are printed: 0.5 µm is rounding, more is a misread digit",
            ));
    }
    if stated.is_correction.is_some_and(|one| one != is_correction) {
        return Err(source.invalid("--sign contradicts the printed table of radial distortion"));
    }
    let word = if is_correction {
        "corrections"
    } else {
        "distortions"
    };
    let count = table.len();
    Ok((
        is_correction,
        format!(
            "{count} printed values of radial distortion agree within {off:.2} µm: the \
             coefficients are {word}"
        ),
    ))
}
