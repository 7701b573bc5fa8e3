//! Least squares of polynomial and residual grids together.

use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;
use fmc_reference::residual_spline::ResidualSpline;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::lattice::Lattice;
use super::polynomial::{COEFFICIENTS, derivatives, lens, scales};
use super::roughness::second_differences;
use super::smoother::{Smoother, Undetermined};
use super::table::TableObservation;

/// Weight of a squared second difference of coefficients, of that of an observation: 0.1 nm of bias
/// for 3 µm in waves of ten nodes, and a determined coefficient where no observation lies.
const CURVATURE_WEIGHT: f64 = 1e-6;

/// Weight of a squared coefficient: of the many pairs of polynomial and grid that differ by a
/// plane, the one with the smallest grid.
const COEFFICIENT_WEIGHT: f64 = 1e-9;

/// Least stage offsets apart, mm, at which a structure of the lens and one of the sensor differ.
const LEAST_OFFSETS_APART_MM: f64 = 1e-3;

/// Share of the largest eigenvalue of the reduced normal equations below which a combination of
/// coefficients of the polynomial is left at zero, to the grid.
const LEAST_EIGENVALUE: f64 = 1e-13;

/// Question to a distortion table.
#[derive(Debug, Clone)]
pub struct GridRequest<'a> {
    /// Name that messages use for the file of the table.
    pub file: String,
    /// Rows of the table.
    pub observations: &'a [TableObservation],
    /// Principal point at the calibrated position, mm.
    pub principal_point_mm: [f64; 2],
    /// Unit vector e of the FMC axis.
    pub axis: [f64; 2],
    /// Polynomial whose coefficients are kept unless they are estimated.
    pub lens: Lens,
    /// Coefficients of the polynomial that are estimated: K0 to K3, P1, P2, B1, B2.
    pub is_estimated: [bool; COEFFICIENTS],
    /// Grids, each with its nodes: one, or one of the lens and one of the sensor.
    pub grids: Vec<(GridCarrier, Lattice)>,
}

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
}

/// Fits polynomial and grids to a distortion table.
///
/// # Model
/// `D(x) = polynomial(x - x0 - c·e) + G_lens(x - c·e) + G_sensor(x)`, linear in all coefficients:
/// the sum of the squared residuals, of `CURVATURE_WEIGHT` times the squared second differences
/// of the grids' coefficients, and of `COEFFICIENT_WEIGHT` times their squares, is least. The
/// grids are eliminated, which leaves the normal equations of the polynomial.
///
/// # Errors
/// [`InputError`] that names the file, for an empty table, a point outside a grid, and for a table
/// of one stage position from which both grids are asked for.
pub fn fit(request: &GridRequest<'_>) -> Result<GridFit, InputError> {
    let GridRequest {
        file, observations, ..
    } = request;
    let invalid = |text: String| InputError::invalid(format!("{file}: {text}"));
    check(request).map_err(invalid)?;
    let design = design_rows(request).map_err(invalid)?;
    let mut penalties = Vec::new();
    let mut first = 0;
    for (_, lattice) in &request.grids {
        for difference in second_differences(lattice) {
            let moved = difference
                .into_iter()
                .map(|(node, factor)| (first + node, factor));
            penalties.push(moved.collect());
        }
        first += lattice.nodes();
    }
    let undetermined = |error: Undetermined| InputError::invalid(format!("{file}: {error}"));
    let smoother = Smoother::new(
        &design,
        &penalties,
        CURVATURE_WEIGHT,
        first,
        COEFFICIENT_WEIGHT,
    )
    .map_err(undetermined)?;

    let points: Vec<[f64; 2]> = observations
        .iter()
        .map(|row| from_pp(request, row))
        .collect();
    let observed: Vec<[f64; 2]> = points
        .iter()
        .zip(observations.iter())
        .map(|(point, row)| difference(row.distortion_mm, request.lens.displacement(*point)))
        .collect();
    let change = polynomial(request, &points, &observed, &smoother);
    let remainder: Vec<[f64; 2]> = points
        .iter()
        .zip(&observed)
        .map(|(point, observed)| difference(*observed, change.displacement(*point)))
        .collect();
    let of_axis = |axis: usize| -> Vec<f64> {
        remainder
            .iter()
            .filter_map(|pair| pair.get(axis).copied())
            .collect()
    };
    let [of_x, of_y] = [of_axis(0), of_axis(1)].map(|axis| smoother.coefficients(&axis));
    let residuals_mm = remainder
        .iter()
        .zip(
            smoother
                .predicted(&of_x)
                .into_iter()
                .zip(smoother.predicted(&of_y)),
        )
        .map(|(observed, (x, y))| difference(*observed, [x, y]))
        .collect();
    let mut pairs = of_x.into_iter().zip(of_y).map(|(x, y)| [x, y]);
    let grids = request
        .grids
        .iter()
        .map(|(carrier, lattice)| FittedGrid {
            carrier: *carrier,
            lattice: *lattice,
            coefficients_mm: pairs.by_ref().take(lattice.nodes()).collect(),
        })
        .collect();
    Ok(GridFit {
        lens: sum(&request.lens, &change),
        grids,
        residuals_mm,
    })
}

/// Returns the change of the polynomial that leaves the least to the grids and to the residuals.
fn polynomial(
    request: &GridRequest<'_>,
    points: &[[f64; 2]],
    observed: &[[f64; 2]],
    smoother: &Smoother<'_>,
) -> Lens {
    let estimated: Vec<usize> = (0..COEFFICIENTS)
        .filter(|index| request.is_estimated.get(*index) == Some(&true))
        .collect();
    let unknowns = estimated.len();
    let mut coefficients = [0.0; COEFFICIENTS];
    if unknowns == 0 {
        return lens(coefficients);
    }
    let radius_mm = points.iter().map(|[x, y]| x.hypot(*y)).fold(1.0, f64::max);
    let design: Vec<[[f64; 2]; COEFFICIENTS]> = points
        .iter()
        .map(|point| derivatives(*point, radius_mm))
        .collect();
    let mut normal = DMatrix::<f64>::zeros(unknowns, unknowns);
    let mut right = DVector::<f64>::zeros(unknowns);
    for axis in 0..2 {
        let values: Vec<Vec<f64>> = estimated
            .iter()
            .map(|index| {
                let value = |row: &[[f64; 2]; COEFFICIENTS]| row.get(*index)?.get(axis).copied();
                design.iter().filter_map(value).collect()
            })
            .collect();
        let observed: Vec<f64> = observed
            .iter()
            .filter_map(|pair| pair.get(axis).copied())
            .collect();
        let left: Vec<Vec<f64>> = values.iter().map(|values| smoother.left(values)).collect();
        normal += DMatrix::from_fn(unknowns, unknowns, |row, column| {
            dot(values.get(row), left.get(column))
        });
        right += DVector::from_fn(unknowns, |row, _| dot(left.get(row), Some(&observed)));
    }
    let solution = least_norm(&normal, &right);
    let scales = scales(radius_mm);
    for (index, value) in estimated.iter().zip(solution.iter()) {
        if let (Some(coefficient), Some(scale)) = (coefficients.get_mut(*index), scales.get(*index))
        {
            *coefficient = value / scale;
        }
    }
    lens(coefficients)
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

/// Returns the weights of the coefficients of all grids, by observation.
fn design_rows(request: &GridRequest<'_>) -> Result<Vec<Vec<(usize, f64)>>, String> {
    let [ex, ey] = request.axis;
    let mut rows = Vec::new();
    for (row, observation) in (2..).zip(request.observations) {
        let [x, y] = observation.measured_mm;
        let mut weights = Vec::new();
        let mut first = 0;
        for (carrier, lattice) in &request.grids {
            let offset = match carrier {
                GridCarrier::Lens => observation.stage_offset_mm,
                GridCarrier::Sensor => 0.0,
            };
            let at = [x - offset * ex, y - offset * ey];
            let Some(found) = lattice.weights(at) else {
                return Err(format!(
                    "row {row}: the point ({x}, {y}) mm at the stage offset {} mm lies outside the \
                     grid, which reaches half the stroke beyond the sensor",
                    observation.stage_offset_mm
                ));
            };
            weights.extend(found.map(|(node, weight)| (first + node, weight)));
            first += lattice.nodes();
        }
        rows.push(weights);
    }
    Ok(rows)
}

/// Returns a measured point from the principal point of its stage position, mm.
fn from_pp(request: &GridRequest<'_>, row: &TableObservation) -> [f64; 2] {
    let [ex, ey] = request
        .axis
        .map(|component| component * row.stage_offset_mm);
    let [x0, y0] = request.principal_point_mm;
    difference(row.measured_mm, [x0 + ex, y0 + ey])
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

fn dot(a: Option<&Vec<f64>>, b: Option<&Vec<f64>>) -> f64 {
    let pairs = a.into_iter().flatten().zip(b.into_iter().flatten());
    pairs.map(|(a, b)| a * b).sum()
}

/// Returns the shortest solution of normal equations, without combinations that they do not
/// determine.
fn least_norm(normal: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let symmetric = 0.5 * (normal + normal.transpose());
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = symmetric.symmetric_eigen();
    let least = eigenvalues.amax() * LEAST_EIGENVALUE;
    let mut projected = eigenvectors.transpose() * right;
    for (value, eigenvalue) in projected.iter_mut().zip(eigenvalues.iter()) {
        *value = if *eigenvalue > least {
            *value / eigenvalue
        } else {
            0.0
        };
    }
    eigenvectors * projected
}
