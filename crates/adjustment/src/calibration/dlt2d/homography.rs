//! Homography between a plane target and its image.

use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::super::least_squares::{Linearised, Model};
use crate::calibration::dlt3d::pinhole::Pinhole;
use crate::calibration::gross_errors::Searched;

/// Unknowns of a homography.
pub(super) const EIGHT: usize = 8;

/// Triples of four corners.
const TRIPLES: [[usize; 3]; 4] = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];

/// Height of a triangle over its longest side below which its corners lie on a line.
pub(super) const LEAST_HEIGHT: f64 = 1e-3;

/// A target of the plane in the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub(super) measured_mm: [f64; 2],
    pub(super) sigma_mm: f64,
    /// Place in the plane, from the mean of all targets, in units of their spread.
    pub(super) plane: [f64; 2],
}

/// Homographies of a request.
pub(super) struct Homographies<'a> {
    pub(super) searched: Searched<Imaged<'a>, 2>,
    /// Of the table.
    pub(super) table: Matrix3<f64>,
    /// From metres to the coordinates of [`Pair::plane`].
    pub(super) plane: Matrix3<f64>,
}

/// Applies a homography.
pub(super) fn apply(homography: &Matrix3<f64>, [x, y]: [f64; 2]) -> [f64; 2] {
    let image = homography * Vector3::new(x, y, 1.0);
    [image.x / image.z, image.y / image.z]
}

/// Returns three of four points that lie on a line, by their places in the list.
pub(super) fn collinear(points: [[f64; 2]; 4]) -> Option<[usize; 3]> {
    TRIPLES.into_iter().find(|triple| {
        let [a, b, c] = triple.map(|index| points.get(index).copied().unwrap_or_default());
        let side = |[x, y]: [f64; 2], [u, v]: [f64; 2]| (u - x).hypot(v - y);
        let area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        let longest = side(a, b).max(side(b, c)).max(side(a, c));
        area <= LEAST_HEIGHT * longest * longest
    })
}

/// Returns the homography through four points exactly; `None` if three of them are collinear.
pub(super) fn through(pairs: [Pair; 4]) -> Option<Matrix3<f64>> {
    let mut design = SMatrix::<f64, EIGHT, EIGHT>::zeros();
    let mut right = SVector::<f64, EIGHT>::zeros();
    for (index, pair) in pairs.iter().enumerate() {
        let [x, y] = pair.plane;
        let [u, v] = pair.measured_mm;
        design.set_row(
            2 * index,
            &SVector::from([x, y, 1.0, 0.0, 0.0, 0.0, -u * x, -u * y]).transpose(),
        );
        design.set_row(
            2 * index + 1,
            &SVector::from([0.0, 0.0, 0.0, x, y, 1.0, -v * x, -v * y]).transpose(),
        );
        *right.get_mut(2 * index)? = u;
        *right.get_mut(2 * index + 1)? = v;
    }
    let solution = design.lu().solve(&right)?;
    Some(from_eight(&solution))
}

#[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
fn from_eight(eight: &SVector<f64, EIGHT>) -> Matrix3<f64> {
    let [[a, b, c, d, e, f, g, h]] = eight.data.0;
    Matrix3::new(a, b, c, d, e, f, g, h, 1.0)
}

/// Homography and distortion of the moment, with the targets.
///
/// # Model
/// v = measured - D(measured) - G(measured) - H(X), D the distortion about the camera's principal
/// point, G what its residual grids add.
#[derive(Debug, Clone)]
pub(super) struct Imaged<'a> {
    pub(super) homography: Matrix3<f64>,
    /// Principal point and distortion; its other fields are not read.
    pub(super) lens: Pinhole,
    /// K0, B1, B2, which are held.
    pub(super) held: [f64; 3],
    pub(super) grids: &'a ResidualSplines,
    pub(super) pairs: &'a [Pair],
    pub(super) is_estimated: [bool; 5],
}

impl Imaged<'_> {
    pub(super) fn coefficients(&self) -> impl Iterator<Item = usize> {
        let flags = self.is_estimated.into_iter().enumerate();
        flags.filter_map(|(index, is_estimated)| is_estimated.then_some(index))
    }
}

impl Model<2> for Imaged<'_> {
    fn unknowns(&self) -> usize {
        EIGHT + self.coefficients().count()
    }

    fn observations(&self) -> usize {
        self.pairs.len()
    }

    fn sigma_mm(&self, index: usize) -> f64 {
        self.pairs.get(index).map_or(1.0, |pair| pair.sigma_mm)
    }

    #[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
    fn linearised(&self, index: usize) -> Option<Linearised<2>> {
        let pair = self.pairs.get(index)?;
        let [px, py] = pair.plane;
        let image = self.homography * Vector3::new(px, py, 1.0);
        if image.z <= 0.0 {
            return None;
        }
        let [u, v] = [image.x / image.z, image.y / image.z];
        let [a, b, one] = [px / image.z, py / image.z, image.z.recip()];
        let [x, y] = pair.measured_mm;
        let [x0, y0] = self.lens.principal_point_mm;
        let [xr, yr] = [x - x0, y - y0];
        let ([dx, dy], _) = self.lens.radial_and_decentring([xr, yr]);
        let [k0, b1, b2] = self.held;
        let [of_grids_x, of_grids_y] = self.grids.calibrated(pair.measured_mm);
        let [dx, dy] = [
            dx + (k0 + b1) * xr + b2 * yr + of_grids_x,
            dy + k0 * yr + of_grids_y,
        ];
        let mut by_x = vec![-a, -b, -one, 0.0, 0.0, 0.0, u * a, u * b];
        let mut by_y = vec![0.0, 0.0, 0.0, -a, -b, -one, v * a, v * b];
        let coefficients = Pinhole::by_coefficients([xr, yr]);
        for index in self.coefficients() {
            let [of_x, of_y] = coefficients.get(index).copied()?;
            by_x.push(-of_x);
            by_y.push(-of_y);
        }
        Some(Linearised {
            residual: [x - dx - u, y - dy - v],
            derivatives: [by_x, by_y],
        })
    }

    #[expect(clippy::many_single_char_names, reason = "symbols of the equations")]
    fn moved(&self, step: &[f64]) -> Option<Self> {
        let (&[a, b, c, d, e, f, g, h], coefficients) = step.split_first_chunk::<EIGHT>()?;
        let mut next = self.clone();
        next.homography += Matrix3::new(a, b, c, d, e, f, g, h, 0.0);
        for (index, change) in self.coefficients().zip(coefficients) {
            next.lens.add(index, *change)?;
        }
        Some(next)
    }
}
