//! Covariance of a calibration in pixels, as Metashape states it.

use fmc_camera_file::{CameraFile, InputError};

use crate::columns::shown;
use crate::lens_parameter::Parameter;

/// Parameters of the camera file on which those in pixels act, and K4, which only they have.
const OURS: [Parameter; 10] = [
    Parameter::X0,
    Parameter::Y0,
    Parameter::Radial(1),
    Parameter::Radial(2),
    Parameter::Radial(3),
    Parameter::Radial(4),
    Parameter::P1,
    Parameter::P2,
    Parameter::B1,
    Parameter::B2,
];

/// Returns `true` if these are the symbols of a camera in pixels.
pub(crate) fn are_in_pixels(names: &[String]) -> bool {
    let is = |name: &String, wanted: &str| name.eq_ignore_ascii_case(wanted);
    names.iter().any(|name| is(name, "cx") || is(name, "cy"))
}

/// Returns parameters and covariance in mm of one in pixels.
///
/// # Model
/// Metashape distorts rays, `f·x·(1 + k1·r² + …) + …`, with P1 at x² and rows downwards. The change
/// of the distortion by a coefficient is the same in both directions but for terms K1·r², 4 % at
/// the corner of a lens of 1.2 %: Kᵢ = kᵢ/f²ⁱ, P1 = p1/f, P2 = -p2/f with f in mm, B1 = b1/f, B2 =
/// -b2/f with f in px, x0 = cx·pitch, y0 = -cy·pitch. With f all coefficients change: kᵢ belong to
/// rays.
///
/// # Errors
/// [`InputError`] naming the file and a parameter that is not known.
pub(crate) fn in_mm(
    file: &str,
    names: &[String],
    covariance: &[Vec<f64>],
    camera: &CameraFile,
) -> Result<(Vec<Parameter>, Vec<Vec<f64>>), InputError> {
    let changes = names
        .iter()
        .map(|name| {
            changes(name, camera).ok_or_else(|| {
                InputError::invalid(format!(
                    "{file}: parameter {} is not one of f, cx, cy, b1, b2, k1 to k4, p1, p2 in pixels",
                    shown(name)
                ))
            })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut found = vec![vec![0.0; OURS.len()]; OURS.len()];
    for (row, own) in covariance.iter().zip(&changes) {
        for (cell, other) in row.iter().zip(&changes) {
            for (line, own) in found.iter_mut().zip(own) {
                for (sum, other) in line.iter_mut().zip(other) {
                    *sum += own * cell * other;
                }
            }
        }
    }
    Ok((OURS.to_vec(), found))
}

/// Returns the change of each of [`OURS`] with a parameter in pixels.
fn changes(name: &str, camera: &CameraFile) -> Option<[f64; OURS.len()]> {
    let pitch_mm = camera.sensor.pixel_um * 1e-3;
    let f_mm = camera.principal_distance_mm;
    let f_px = f_mm / pitch_mm;
    let lens = camera.distortion.measured_minus_ideal();
    let radial = |power: i32| f_mm.powi(-2 * power);
    let one =
        |wanted: Parameter, change: f64| OURS.map(|ours| if ours == wanted { change } else { 0.0 });
    Some(match name.to_ascii_lowercase().as_str() {
        "f" => OURS.map(|ours| match ours {
            Parameter::Radial(1) => -2.0 * lens.k1 / f_px,
            Parameter::Radial(2) => -4.0 * lens.k2 / f_px,
            Parameter::Radial(3) => -6.0 * lens.k3 / f_px,
            Parameter::P1 => -lens.p1 / f_px,
            Parameter::P2 => -lens.p2 / f_px,
            Parameter::B1 => -lens.b1 / f_px,
            Parameter::B2 => -lens.b2 / f_px,
            _ => 0.0,
        }),
        "cx" => one(Parameter::X0, pitch_mm),
        "cy" => one(Parameter::Y0, -pitch_mm),
        "k1" => one(Parameter::Radial(1), radial(1)),
        "k2" => one(Parameter::Radial(2), radial(2)),
        "k3" => one(Parameter::Radial(3), radial(3)),
        "k4" => one(Parameter::Radial(4), radial(4)),
        "p1" => one(Parameter::P1, 1.0 / f_mm),
        "p2" => one(Parameter::P2, -1.0 / f_mm),
        "b1" => one(Parameter::B1, 1.0 / f_px),
        "b2" => one(Parameter::B2, -1.0 / f_px),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const IXM: &str = include_str!("../../../host-sim/cameras/phase-one-ixm-rs150f-50.toml");

    #[test]
    fn signs_and_the_distance_are_seen_by_correlations() {
        let (file, _) = CameraFile::parse("ixm.toml", IXM).unwrap();
        let of = |names: [&str; 2], sigma: [f64; 2], correlation: f64| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            let both = correlation * sigma[0] * sigma[1];
            let covariance = vec![vec![sigma[0].powi(2), both], vec![both, sigma[1].powi(2)]];
            in_mm("m.json", &names, &covariance, &file).unwrap().1
        };
        // x0 with cx, y0 against cy; P1 with p1, P2 against p2; by 3.76 µm and 51.37 mm.
        let found = of(["cx", "cy"], [1.0, 2.0], 0.5);
        assert!((found[0][1] + 0.5 * 2.0 * 0.003_76_f64.powi(2)).abs() < 1e-12);
        let found = of(["p1", "p2"], [1.0, 1.0], 1.0);
        assert!((found[6][7] * 51.3712_f64.powi(2) + 1.0).abs() < 1e-9);
        // f and k1 that keep K1 = k1/f²: its variance vanishes.
        let k1 = file.distortion.measured_minus_ideal().k1;
        let sigma_k1 = 2.0 * k1.abs() * 51.3712_f64.powi(2) / 13_662.553_191;
        let sign = k1.signum();
        assert!(of(["f", "k1"], [1.0, sigma_k1], sign)[2][2].abs() < 1e-12 * k1 * k1);
        let names = ["cx".to_owned(), "tau".to_owned()];
        let wrong = in_mm("m.json", &names, &[], &file).unwrap_err().to_string();
        assert!(
            wrong.starts_with("m.json: parameter tau is not one of f, cx"),
            "{wrong}"
        );
    }
}
