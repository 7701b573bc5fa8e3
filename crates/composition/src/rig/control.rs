//! Control points and ties measured in sub-images.

use std::collections::HashMap;

use fmc_camera_file::InputError;

use super::description::Rig;

/// Parts of a sub-image's side that points must span beyond a line: below it they lie on one.
const LEAST_SPAN: f64 = 0.02;

/// A place in a sub-image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Number of the sub-image in the rig.
    pub sub: usize,
    /// Column and row, px.
    pub pixel: [f64; 2],
}

/// A control point measured in a sub-image.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlPoint {
    /// Name.
    pub id: String,
    /// Exposure that shows it.
    pub exposure: String,
    /// Place that was measured.
    pub place: Place,
    /// Ground coordinates, m.
    pub ground_m: [f64; 3],
    /// σ of each ground coordinate, m.
    pub sigma_m: f64,
    /// Line in the file, 0 without one.
    pub line: u64,
}

/// A point of the same content in two sub-images of one exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// Name.
    pub id: String,
    /// Exposure that shows it.
    pub exposure: String,
    /// Its places.
    pub places: [Place; 2],
}

/// Control and ties of a calibration, with the names of their files for messages.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measurements {
    /// Name of the control file.
    pub control_file: String,
    /// Control points.
    pub control: Vec<ControlPoint>,
    /// Ties.
    pub ties: Vec<Tie>,
}

impl Measurements {
    /// Names of the exposures, in order of appearance.
    #[must_use]
    pub fn exposures(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        let of_ties = self.ties.iter().map(|tie| &tie.exposure);
        for name in self
            .control
            .iter()
            .map(|point| &point.exposure)
            .chain(of_ties)
        {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        names
    }

    /// Checks what needs no adjustment: places on their sub-images, names that appear once, ground
    /// coordinates that agree, ground points that span an area in every sub-image.
    ///
    /// # Errors
    /// [`InputError`] naming file, line, point, value and what is allowed.
    pub fn check(&self, rig: &Rig) -> Result<(), InputError> {
        let mut seen: HashMap<(&str, &str, usize), u64> = HashMap::new();
        let mut grounds: HashMap<&str, (u64, [f64; 3])> = HashMap::new();
        for point in &self.control {
            let refused = |fault: String| {
                Err(InputError::invalid(format!(
                    "{}, line {}: point {}: {fault}",
                    self.control_file, point.line, point.id
                )))
            };
            let Some(sub) = rig.sub.get(point.place.sub) else {
                return refused(format!("no such sub-image; the rig has {}", rig.ids()));
            };
            if !sub.contains(point.place.pixel) {
                let [col, row] = point.place.pixel;
                return refused(format!(
                    "col_px,row_px = {col}, {row} is outside sub-image {}; allowed: -0.5 to {}, -0.5 to {}",
                    sub.id,
                    sub.centre_px()[0] * 2.0 + 0.5,
                    sub.centre_px()[1] * 2.0 + 0.5
                ));
            }
            if !(point.sigma_m > 0.0 && point.sigma_m.is_finite()) {
                return refused(format!("sigma_m = {}; it must be above 0", point.sigma_m));
            }
            let key = (point.exposure.as_str(), point.id.as_str(), point.place.sub);
            if let Some(first) = seen.insert(key, point.line) {
                return refused(format!(
                    "appears twice in sub-image {} of exposure {} (line {first}); ids must be unique in each",
                    sub.id, point.exposure
                ));
            }
            let first = grounds
                .entry(&point.id)
                .or_insert((point.line, point.ground_m));
            if first
                .1
                .iter()
                .zip(point.ground_m)
                .any(|(a, b)| (a - b).abs() > 1e-6)
            {
                return refused(format!(
                    "x_m,y_m,z_m differ from those of line {}; a point has one place on the ground",
                    first.0
                ));
            }
        }
        self.check_spread(rig)
    }

    /// Refuses control of a sub-image that lies on a line.
    fn check_spread(&self, rig: &Rig) -> Result<(), InputError> {
        for (number, sub) in rig.sub.iter().enumerate() {
            let of_sub = self
                .control
                .iter()
                .filter(|point| point.place.sub == number);
            let normalised: Vec<[f64; 2]> = of_sub
                .map(|point| super::polynomial::normalised(sub.size_px(), point.place.pixel))
                .collect();
            if normalised.len() >= 3 && width_across(&normalised) < LEAST_SPAN {
                return Err(InputError::invalid(format!(
                    "{}: the {} control points of sub-image {} lie on a line; they must span an area",
                    self.control_file,
                    normalised.len(),
                    sub.id
                )));
            }
        }
        Ok(())
    }
}

/// Root of the smaller eigenvalue of the moments: the width across the line of best fit.
fn width_across(points: &[[f64; 2]]) -> f64 {
    let count = crate::number::real(points.len());
    let mean = |axis: fn(&[f64; 2]) -> f64| points.iter().map(axis).sum::<f64>() / count;
    let (x, y) = (mean(|point| point[0]), mean(|point| point[1]));
    let mut moments = nalgebra::Matrix2::zeros();
    for point in points {
        let way = nalgebra::Vector2::new(point[0] - x, point[1] - y);
        moments += way * way.transpose() / count;
    }
    moments.symmetric_eigenvalues().min().max(0.0).sqrt()
}
