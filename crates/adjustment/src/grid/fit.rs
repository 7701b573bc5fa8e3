//! Least squares of polynomial and residual grids together.

use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;
use fmc_reference::residual_spline::ResidualSpline;
use nalgebra::DMatrix;

use super::design::{Place, penalties, weights};
use super::lattice::Lattice;
use super::reduced::Reduced;
use super::request::GridRequest;
use super::smoother::{Smoother, Undetermined};
use crate::calibration::snooping::count;

/// Least weight of a squared second difference of coefficients, of that of an observation: 0.1 nm
/// of bias for 3 µm in waves of ten nodes, and a determined coefficient where no observation lies.
const LEAST_CURVATURE_WEIGHT: f64 = 1e-6;

/// Weight of a squared coefficient: of the many pairs of polynomial and grid that differ by a
/// plane, the one with the smallest grid.
const COEFFICIENT_WEIGHT: f64 = 1e-9;

/// Least stage offsets apart, mm, at which a structure of the lens and one of the sensor differ.
const LEAST_OFFSETS_APART_MM: f64 = 1e-3;

/// A grid that was fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedGrid {
    /// Part that carries the structure.
    pub carrier: GridCarrier,
    /// Nodes.
    pub lattice: Lattice,
    /// Coefficients of x and y, mm, node by node along x, row by row along y.
    pub coefficients_mm: Vec<[f64; 2]>,
}

impl FittedGrid {
    /// Returns the grid as a spline in double precision.
    #[must_use]
    pub fn spline(&self) -> ResidualSpline {
        let [columns, _] = self.lattice.sides();
        ResidualSpline::new(
            self.lattice.first_mm(),
            self.lattice.pitch_mm(),
            usize::from(columns),
            self.coefficients_mm.clone(),
        )
    }
}

/// Polynomial and grids of a distortion table.
#[derive(Debug, Clone, PartialEq)]
pub struct GridFit {
    /// Polynomial about the principal point.
    pub lens: Lens,
    /// Grids, in the order of the request.
    pub grids: Vec<FittedGrid>,
    /// Observed - computed, mm, row by row.
    pub residuals_mm: Vec<[f64; 2]>,
    /// Cofactors of the estimated coefficients of the polynomial, for observations of σ = 1 mm.
    pub cofactors: DMatrix<f64>,
    /// Share of an observation in its own computed value, x and y, row by row.
    pub leverages: Vec<[f64; 2]>,
    /// Coefficients of the polynomial that the grids follow wholly: they are left as they were.
    pub undetermined: Vec<usize>,
}

impl GridFit {
    /// Number of unknowns that the observations determine: the sum of the leverages.
    #[must_use]
    pub fn effective_unknowns(&self) -> f64 {
        self.leverages.iter().flatten().sum()
    }
}

/// Fits polynomial and grids to a distortion table.
///
/// # Model
/// `D(x) = κ·r + polynomial(r) + G_lens((x - c·e)/(1+κ)) + G_sensor(x)` with
/// `r = (x - x0 - c·e)/(1+κ)`, linear in all coefficients: the sum of the squared residuals, of
/// `LEAST_CURVATURE_WEIGHT` times the squared second differences of the grids' coefficients, and of
/// `COEFFICIENT_WEIGHT` times their squares, is least. The grids are eliminated, which leaves the
/// normal equations of the polynomial. Cofactors and leverages take both penalties as observations.
///
/// # Errors
/// [`InputError`] that names the file, for an empty table, a point outside a grid, and for a table
/// of one stage position from which both grids are asked for.
pub fn fit(request: &GridRequest<'_>) -> Result<GridFit, InputError> {
    weighted(request, LEAST_CURVATURE_WEIGHT)
}

/// Fits polynomial and grids to a table with noise.
///
/// # Model
/// As [`fit`], with the weight (σ0/s)² of a second difference: s, the root of the mean square of
/// what the polynomial leaves, is the size that second differences are expected to have, σ0 that of
/// the residuals of [`fit`]. Without it, noise is carried to the nodes beyond the border, and with
/// two grids from one to the other, a hundredfold.
///
/// # Errors
/// As [`fit`].
pub(super) fn fit_noisy(
    request: &GridRequest<'_>,
    left_by_polynomial_rms_mm: f64,
) -> Result<GridFit, InputError> {
    let found = fit(request)?;
    let squares: f64 = found.residuals_mm.iter().flatten().map(|v| v * v).sum();
    let redundancy = count(2 * found.residuals_mm.len()) - found.effective_unknowns();
    let variance = squares / redundancy.max(1.0);
    let weight = variance / left_by_polynomial_rms_mm.powi(2);
    if weight > LEAST_CURVATURE_WEIGHT {
        weighted(request, weight.min(1.0))
    } else {
        Ok(found)
    }
}

fn weighted(request: &GridRequest<'_>, curvature_weight: f64) -> Result<GridFit, InputError> {
    let file = &request.file;
    let invalid = |text: String| InputError::invalid(format!("{file}: {text}"));
    check(request).map_err(invalid)?;
    let rows = request.observations.iter();
    let places: Vec<Place> = rows.map(|row| Place::new(request, row)).collect();
    let design = weights(request, &places).map_err(invalid)?;
    let smoother = Smoother::new(
        &design,
        &penalties(request),
        curvature_weight,
        request
            .grids
            .iter()
            .map(|(_, lattice)| lattice.nodes())
            .sum(),
        COEFFICIENT_WEIGHT,
    )
    .map_err(|error: Undetermined| invalid(error.to_string()))?;
    let points: Vec<[f64; 2]> = places.iter().map(|place| place.from_pp_mm).collect();
    let reduced = Reduced::new(&points, request.is_estimated, &smoother);
    let distortion: Vec<[f64; 2]> = places.iter().map(|place| place.distortion_mm).collect();
    let observed = left_by(&request.lens, &points, &distortion);
    let change = reduced.change(&observed);
    let remainder = left_by(&change, &points, &observed);
    let [of_x, of_y] = [|[x, _]: &[f64; 2]| *x, |[_, y]: &[f64; 2]| *y].map(|axis| {
        let values: Vec<f64> = remainder.iter().map(axis).collect();
        let coefficients = smoother.coefficients(&values);
        let predicted = smoother.predicted(&coefficients);
        (coefficients, predicted)
    });
    let mut pairs = of_x.0.into_iter().zip(of_y.0).map(|(x, y)| [x, y]);
    let predicted = of_x.1.into_iter().zip(of_y.1).map(|(x, y)| [x, y]);
    let of_grids = smoother.leverages();
    let leverages = reduced
        .leverages()
        .into_iter()
        .chain(std::iter::repeat([0.0; 2]));
    Ok(GridFit {
        lens: sum(&request.lens, &change),
        grids: request
            .grids
            .iter()
            .map(|(carrier, lattice)| FittedGrid {
                carrier: *carrier,
                lattice: *lattice,
                coefficients_mm: pairs.by_ref().take(lattice.nodes()).collect(),
            })
            .collect(),
        residuals_mm: remainder
            .iter()
            .zip(predicted)
            .map(|(observed, predicted)| difference(*observed, predicted))
            .collect(),
        cofactors: reduced.cofactors(),
        leverages: of_grids
            .into_iter()
            .zip(leverages)
            .map(|(grids, polynomial)| polynomial.map(|one| one + grids))
            .collect(),
        undetermined: reduced.undetermined().to_vec(),
    })
}

/// Returns what a polynomial leaves of displacements at points from the principal point, mm.
fn left_by(lens: &Lens, points: &[[f64; 2]], observed: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let rows = points.iter().zip(observed);
    rows.map(|(point, observed)| difference(*observed, lens.displacement(*point)))
        .collect()
}

fn check(request: &GridRequest<'_>) -> Result<(), String> {
    if request.observations.is_empty() {
        return Err("there is no row".to_owned());
    }
    if request.grids.len() < 2 {
        return Ok(());
    }
    let offsets = request.observations.iter().map(|row| row.stage_offset_mm);
    let least = offsets.clone().fold(f64::INFINITY, f64::min);
    let largest = offsets.fold(f64::NEG_INFINITY, f64::max);
    if largest - least < LEAST_OFFSETS_APART_MM {
        return Err(format!(
            "all rows have the stage offset {least} mm: a table of one stage position cannot tell \
             a structure of the lens from one of the sensor; measure at two or more, or choose one"
        ));
    }
    Ok(())
}

fn sum(a: &Lens, b: &Lens) -> Lens {
    let Lens {
        k: [k0, k1, k2, k3],
        p: [p1, p2],
        b: [b1, b2],
    } = *a;
    let Lens { k, p, b } = *b;
    Lens {
        k: [k0 + k[0], k1 + k[1], k2 + k[2], k3 + k[3]],
        p: [p1 + p[0], p2 + p[1]],
        b: [b1 + b[0], b2 + b[1]],
    }
}

fn difference([ax, ay]: [f64; 2], [bx, by]: [f64; 2]) -> [f64; 2] {
    [ax - bx, ay - by]
}
