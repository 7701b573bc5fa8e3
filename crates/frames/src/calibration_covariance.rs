//! Standard deviations and correlations of a calibration.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use fmc_camera::geometry::evaluation_form::Jacobian;
use fmc_camera_file::{CameraFile, InputError, Sign};
use serde::Deserialize;

use crate::columns::shown;
use crate::lens_parameter::Parameter;
use crate::pixel_covariance::{are_in_pixels, in_mm};

/// Covariance of the parameters on which the distortion depends.
///
/// It is read from JSON as `host-sim import` writes it beside a camera file: `parameters`, `sigma`
/// and, where they are known, `correlations`. The parameters are those of the camera file with its
/// sign: `x0` and `y0` or `xp` and `yp` (mm), `k0` to `k3` (mm⁻²ⁱ), `p1`, `p2` (mm⁻¹), `b1`, `b2`;
/// the principal distance, `c` or `f`, does not change image coordinates. With `cx` or `cy` among
/// them they are Metashape's, in pixels and of rays.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationCovariance {
    parameters: Vec<Parameter>,
    /// Row by row, as long as the parameters.
    covariance: Vec<Vec<f64>>,
}

impl CalibrationCovariance {
    /// Reads a file.
    ///
    /// # Errors
    /// [`InputError`] naming the file and what is wrong in it: a parameter that is not known, a σ
    /// that is negative, correlations that are not square, not symmetric or beyond ±1.
    pub fn read(path: &Path, camera: &CameraFile) -> Result<Self, InputError> {
        let file = File::open(path).map_err(|error| InputError::reading(path, &error))?;
        Self::read_for(&path.display().to_string(), BufReader::new(file), camera)
    }

    /// Reads as [`Self::read`] does, from any source; `file` is its name in messages.
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn read_for(
        file: &str,
        source: impl Read,
        camera: &CameraFile,
    ) -> Result<Self, InputError> {
        let (names, covariance) = stated(file, source)?;
        if are_in_pixels(&names) {
            let (parameters, covariance) = in_mm(file, &names, &covariance, camera)?;
            return Ok(Self {
                parameters,
                covariance,
            });
        }
        let found = Self::of(file, &names, covariance)?;
        Ok(match camera.distortion.sign {
            Sign::Distortion => found,
            Sign::Correction => found.of_corrections(),
        })
    }

    /// Returns the covariance of parameters in the symbols of the camera file.
    fn of(file: &str, names: &[String], covariance: Vec<Vec<f64>>) -> Result<Self, InputError> {
        let refused = |text: String| InputError::invalid(format!("{file}: {text}"));
        let mut parameters = Vec::new();
        for name in names {
            let parameter = Parameter::of(name).ok_or_else(|| {
                refused(format!(
                    "parameter {} is not one of x0, y0, k0 to k3, p1, p2, b1, b2, c in mm, nor are there cx and cy, as \
                     Metashape has them in pixels",
                    shown(name)
                ))
            })?;
            if parameters.contains(&parameter) {
                return Err(refused(format!("parameter {} appears twice", shown(name))));
            }
            parameters.push(parameter);
        }
        Ok(Self {
            parameters,
            covariance,
        })
    }

    /// Turns the signs of the coefficients round, for a camera file whose coefficients are
    /// corrections.
    fn of_corrections(mut self) -> Self {
        let is_coefficient =
            |parameter: &Parameter| !matches!(parameter, Parameter::X0 | Parameter::Y0);
        let signs: Vec<bool> = self.parameters.iter().map(is_coefficient).collect();
        for (row, own) in self.covariance.iter_mut().zip(&signs) {
            for (cell, other) in row.iter_mut().zip(&signs) {
                if own != other {
                    *cell = -*cell;
                }
            }
        }
        self
    }

    /// Returns the variance of the distortion along x and y, mm².
    ///
    /// # Model
    /// G·C·Gᵀ, with G = ∂D/∂(x0, y0, K, P, B) of measured - ideal.
    ///
    /// # Units and frames
    /// `point_mm` is counted from the frame's principal point, in the sensor frame; `jacobian` is
    /// ∂D/∂x there. `scale` is multiplied with each column of G: the inverse of I - J for the
    /// change of a measured point.
    #[must_use]
    pub fn variance_mm2(
        &self,
        point_mm: [f64; 2],
        jacobian: Jacobian,
        scale: impl Fn([f64; 2]) -> [f64; 2],
    ) -> [f64; 2] {
        let changes: Vec<[f64; 2]> = self
            .parameters
            .iter()
            .map(|parameter| scale(parameter.change(point_mm, jacobian)))
            .collect();
        let mut variance = [0.0; 2];
        for (row, [own_x, own_y]) in self.covariance.iter().zip(&changes) {
            for (cell, [other_x, other_y]) in row.iter().zip(&changes) {
                let [x, y] = &mut variance;
                *x += cell * own_x * other_x;
                *y += cell * own_y * other_y;
            }
        }
        // Correlations that were rounded may give less than nothing.
        variance.map(|one: f64| one.max(0.0))
    }
}

/// Reads the names of the parameters, and their covariance row by row.
fn stated(file: &str, source: impl Read) -> Result<(Vec<String>, Vec<Vec<f64>>), InputError> {
    #[derive(Deserialize)]
    struct Stated {
        parameters: Vec<String>,
        sigma: Vec<f64>,
        #[serde(default)]
        correlations: Option<Vec<Vec<f64>>>,
    }
    let refused = |text: String| InputError::invalid(format!("{file}: {text}"));
    let Stated {
        parameters: names,
        sigma,
        correlations,
    } = serde_json::from_reader(source).map_err(|error| refused(error.to_string()))?;
    if sigma.len() != names.len() {
        return Err(refused(format!(
            "sigma has {} values for {} parameters",
            sigma.len(),
            names.len()
        )));
    }
    for (name, sigma) in names.iter().zip(&sigma) {
        if !(0.0..f64::INFINITY).contains(sigma) {
            return Err(refused(format!(
                "sigma of {name} = {sigma}: must be at least 0"
            )));
        }
    }
    let count = names.len();
    let correlation = |row: usize, column: usize| match &correlations {
        None if row == column => Some(1.0),
        None => Some(0.0),
        Some(rows) => rows.get(row).and_then(|row| row.get(column)).copied(),
    };
    if let Some(rows) = &correlations
        && (rows.len() != count || rows.iter().any(|row| row.len() != count))
    {
        return Err(refused(format!(
            "correlations are not {count} rows of {count}"
        )));
    }
    let mut covariance = vec![vec![0.0; count]; count];
    for (row, (cells, own)) in covariance.iter_mut().zip(&sigma).enumerate() {
        for (column, (cell, other)) in cells.iter_mut().zip(&sigma).enumerate() {
            let both = correlation(row, column).zip(correlation(column, row));
            let Some((one, turned)) = both else { continue };
            if !(one.abs() <= 1.0 + 1e-9 && (one - turned).abs() <= 1e-6) {
                return Err(refused(format!(
                    "correlation {one} in row {row}, column {column}: must be symmetric and within -1 to 1"
                )));
            }
            *cell = one * own * other;
        }
    }
    Ok((names, covariance))
}

#[cfg(test)]
mod tests {
    use fmc_camera::geometry::brown::Brown;

    use super::*;

    const NONE: Jacobian = Jacobian {
        dx_by_x: 0.0,
        dx_by_y: 0.0,
        dy_by_x: 0.0,
        dy_by_y: 0.0,
    };

    fn read(text: &str) -> Result<CalibrationCovariance, InputError> {
        let (names, covariance) = stated("sigma.json", text.as_bytes())?;
        CalibrationCovariance::of("sigma.json", &names, covariance)
    }

    #[test]
    fn sigma_of_one_coefficient_is_its_change_of_the_distortion() {
        let (x, y) = (12.0, -7.0);
        let brown = |name: &str| {
            let mut lens = Brown::default();
            let coefficient = match name {
                "k0" => &mut lens.k0,
                "k1" => &mut lens.k1,
                "k2" => &mut lens.k2,
                "k3" => &mut lens.k3,
                "p1" => &mut lens.p1,
                "p2" => &mut lens.p2,
                "b1" => &mut lens.b1,
                _ => &mut lens.b2,
            };
            *coefficient = 1e-9;
            let form = lens.evaluation_form();
            (form.displacement(x, y), form.jacobian(x, y))
        };
        for name in ["k0", "K1", "k2", "k3", "p1", "P2", "b1", "b2"] {
            let text = format!("{{\"parameters\": [\"{name}\"], \"sigma\": [1e-9]}}");
            let point = [x, y].map(f64::from);
            let variance = read(&text).unwrap().variance_mm2(point, NONE, |one| one);
            let (change, _) = brown(&name.to_ascii_lowercase());
            for (variance, change) in variance.into_iter().zip([change.dx_mm, change.dy_mm]) {
                let change = f64::from(change).abs();
                assert!((variance.sqrt() - change).abs() <= 1e-6 * change, "{name}");
            }
        }
        // The principal point moves the distortion against its slope.
        let (_, slope) = brown("k1");
        let text = "{\"parameters\": [\"XP\", \"c\"], \"sigma\": [2.0, 9.0]}";
        let [along_x, along_y] = read(text)
            .unwrap()
            .variance_mm2([12.0, -7.0], slope, |one| one);
        assert!((along_x.sqrt() - 2.0 * f64::from(slope.dx_by_x).abs()).abs() < 1e-12);
        assert!((along_y.sqrt() - 2.0 * f64::from(slope.dy_by_x).abs()).abs() < 1e-12);
    }

    #[test]
    fn correlations_enlarge_or_diminish_the_sum() {
        let of = |correlation: f64| {
            let text = format!(
                "{{\"parameters\": [\"k0\", \"b1\"], \"sigma\": [3e-6, 4e-6], \
                 \"correlations\": [[1, {correlation}], [{correlation}, 1]]}}"
            );
            let [along_x, _] = read(&text)
                .unwrap()
                .variance_mm2([10.0, 0.0], NONE, |one| one);
            along_x.sqrt()
        };
        for (correlation, expected) in [(0.0, 5e-5), (1.0, 7e-5), (-1.0, 1e-5)] {
            assert!((of(correlation) - expected).abs() < 1e-12, "{correlation}");
        }
        // As corrections, both coefficients turn round: nothing changes but towards x0.
        let text = "{\"parameters\": [\"x0\", \"k0\"], \"sigma\": [1, 1], \"correlations\": [[1, 1], [1, 1]]}";
        let slope = Jacobian {
            dx_by_x: 1.0,
            ..NONE
        };
        let [along_x, _] = read(text)
            .unwrap()
            .variance_mm2([1.0, 0.0], slope, |one| one);
        assert!(along_x.abs() < 1e-12);
        let turned = read(text).unwrap().of_corrections();
        let [along_x, _] = turned.variance_mm2([1.0, 0.0], slope, |one| one);
        assert!((along_x - 4.0).abs() < 1e-12);
    }

    #[test]
    fn wrong_files_are_refused() {
        for (text, expected) in [
            ("{", "sigma.json: EOF"),
            (
                "{\"parameters\": [\"k1\"]}",
                "sigma.json: missing field `sigma`",
            ),
            (
                "{\"parameters\": [\"k1\"], \"sigma\": []}",
                "sigma.json: sigma has 0 values for 1",
            ),
            (
                "{\"parameters\": [\"fx\"], \"sigma\": [1]}",
                "sigma.json: parameter fx is not one of",
            ),
            (
                "{\"parameters\": [\"k1\", \"K1\"], \"sigma\": [1, 1]}",
                "sigma.json: parameter K1 appears twice",
            ),
            (
                "{\"parameters\": [\"k1\"], \"sigma\": [-1]}",
                "sigma.json: sigma of k1 = -1: must be at least 0",
            ),
            (
                "{\"parameters\": [\"k1\"], \"sigma\": [1], \"correlations\": [[1, 0]]}",
                "sigma.json: correlations are not 1 rows of 1",
            ),
            (
                "{\"parameters\": [\"k1\", \"k2\"], \"sigma\": [1, 1], \"correlations\": [[1, 0.5], [-0.5, 1]]}",
                "sigma.json: correlation 0.5 in row 0, column 1: must be symmetric",
            ),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
