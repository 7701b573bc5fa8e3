//! Space resection of every frame, with self-calibration over all frames.

use nalgebra::{Matrix2, Vector2};

use crate::collinearity::{Projection, projection};
use crate::correction::COEFFICIENTS;
use crate::exterior_orientation::{ELEMENTS, ExteriorOrientation};
use crate::frame_observation::{ControlObservation, FrameObservations, PointSigmas};
use crate::normal_equations::{FrameBlock, FrameVector, NormalEquations, SharedVector};
use crate::separability::{self, Inseparable};

/// Largest number of iterations; a strip takes three to five.
pub const MOST_ITERATIONS: usize = 40;

/// Stopping rule: no unknown moves by more than this fraction of the σ that it would have as the
/// only unknown.
const SMALLEST_STEP: f64 = 1e-7;

/// Damping after the first step that raises the cost, as a fraction of the diagonal.
const FIRST_DAMPING: f64 = 1e-3;

/// An adjustment problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Adjustment {
    /// Principal distance f, mm.
    pub principal_distance_mm: f64,
    /// Standard deviations, which determine the weights.
    pub sigmas: PointSigmas,
    /// `true` for the coefficients that are estimated.
    pub estimated: [bool; COEFFICIENTS],
    /// Initial values of the coefficients, as [`CorrectedPoint`](crate::correction::CorrectedPoint)
    /// counts them; those not estimated keep them.
    pub initial: [f64; COEFFICIENTS],
    /// Observations of the frames.
    pub frames: Vec<FrameObservations>,
}

/// The result of an adjustment.
#[derive(Debug, Clone, PartialEq)]
pub struct Adjusted {
    /// Exterior orientations.
    pub orientations: Vec<ExteriorOrientation>,
    /// Standard deviations of the elements of the orientations, m and rad, for σ0 = 1.
    pub orientation_sigmas: Vec<[f64; ELEMENTS]>,
    /// Coefficients, as [`CorrectedPoint`](crate::correction::CorrectedPoint) counts them.
    pub coefficients: [f64; COEFFICIENTS],
    /// Standard deviations of the coefficients for σ0 = 1; zero for one that is not estimated.
    pub coefficient_sigmas: [f64; COEFFICIENTS],
    /// Root mean square of the image residuals, Yuan et al. 2012, eq. 29, before the first and
    /// after every iteration, mm.
    pub rms_mm: Vec<f64>,
    /// σ0² = ΣPvv/redundancy.
    pub variance_of_unit_weight: f64,
}

impl Adjusted {
    /// Returns the number of iterations after which the RMS stays within `fraction` of its last
    /// value.
    #[must_use]
    pub fn iterations_to(&self, fraction: f64) -> usize {
        let last = self.rms_mm.last().copied().unwrap_or(0.0);
        self.rms_mm
            .iter()
            .rposition(|rms| (rms - last).abs() > fraction * last)
            .map_or(0, |index| index + 1)
    }
}

/// Error of an adjustment.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AdjustmentError {
    /// The observations cannot separate some unknowns.
    #[error(transparent)]
    Inseparable(#[from] Inseparable),
    /// A control point moved above the lens, or the damping found no better step.
    #[error("the adjustment does not converge within {MOST_ITERATIONS} iterations")]
    NotConverged,
}

/// Values of the unknowns.
#[derive(Debug, Clone, PartialEq)]
struct State {
    orientations: Vec<ExteriorOrientation>,
    coefficients: [f64; COEFFICIENTS],
}

impl Adjustment {
    /// Solves by damped Gauss-Newton iterations (Levenberg-Marquardt), starting undamped from the
    /// observed orientations.
    ///
    /// # Model
    /// Image observations: `corrected point - (distortion by the coefficients) - collinearity = v`,
    /// with the ground points' σ carried into the image; orientation observations:
    /// `observed - element = v`. A ground point that several frames show has the same error in all
    /// of them, which the weights treat as independent: exterior orientations are not affected, but
    /// the standard deviations of the coefficients come out somewhat small.
    ///
    /// # Errors
    /// [`AdjustmentError`], which names the unknowns that the observations cannot separate.
    pub fn solve(&self) -> Result<Adjusted, AdjustmentError> {
        let mut state = State {
            orientations: self
                .frames
                .iter()
                .map(|frame| frame.pos.orientation)
                .collect(),
            coefficients: self.initial,
        };
        let weights = self.weights(&state)?;
        let mut rms_mm = vec![self.rms_mm(&state)?];
        separability::check(
            &self.normal_equations(&state, &weights, false)?,
            &self.normal_equations(&state, &weights, true)?,
            self.estimated,
        )?;
        let mut cost = self.cost(&state, &weights)?;
        let mut damping = 0.0;
        for _ in 0..MOST_ITERATIONS {
            let normals = self.normal_equations(&state, &weights, true)?;
            let solution = normals
                .solve(damping)
                .ok_or(AdjustmentError::NotConverged)?;
            let moved = state.moved(&solution.frames, &solution.shared);
            let largest = largest_step(&normals, &solution.frames, &solution.shared);
            let new_cost = self.cost(&moved, &weights);
            match new_cost {
                // A cost that no longer falls changes only by rounding.
                Ok(new_cost) if new_cost <= cost || largest < SMALLEST_STEP => {
                    state = moved;
                    cost = new_cost;
                    damping = if damping > FIRST_DAMPING {
                        0.1 * damping
                    } else {
                        0.0
                    };
                    rms_mm.push(self.rms_mm(&state)?);
                    if largest < SMALLEST_STEP {
                        return self.adjusted(&state, &weights, rms_mm, cost);
                    }
                }
                _ => damping = FIRST_DAMPING.max(10.0 * damping),
            }
        }
        Err(AdjustmentError::NotConverged)
    }

    fn adjusted(
        &self,
        state: &State,
        weights: &[Vec<Matrix2<f64>>],
        rms_mm: Vec<f64>,
        cost: f64,
    ) -> Result<Adjusted, AdjustmentError> {
        let cofactors = self
            .normal_equations(state, weights, true)?
            .cofactors()
            .ok_or(AdjustmentError::NotConverged)?;
        let root = |variance: f64| variance.max(0.0).sqrt();
        let mut coefficient_sigmas = [0.0; COEFFICIENTS];
        for ((sigma, variance), is_free) in coefficient_sigmas
            .iter_mut()
            .zip(cofactors.shared.diagonal().iter())
            .zip(self.estimated)
        {
            if is_free {
                *sigma = root(*variance);
            }
        }
        Ok(Adjusted {
            orientations: state.orientations.clone(),
            orientation_sigmas: cofactors
                .frames
                .iter()
                .map(|matrix| {
                    let [diagonal] = matrix.diagonal().data.0;
                    diagonal.map(root)
                })
                .collect(),
            coefficients: state.coefficients,
            coefficient_sigmas,
            rms_mm,
            variance_of_unit_weight: cost / self.redundancy(),
        })
    }

    /// Returns the number of observations less that of unknowns.
    fn redundancy(&self) -> f64 {
        let observations: usize = self
            .frames
            .iter()
            .map(|frame| 2 * frame.control.len() + frame.pos.sigmas.iter().flatten().count())
            .sum();
        let estimated = self.estimated.iter().filter(|is_free| **is_free).count();
        let unknowns = ELEMENTS * self.frames.len() + estimated;
        f64::from(u32::try_from(observations.saturating_sub(unknowns)).unwrap_or(u32::MAX))
    }

    fn projection(
        &self,
        orientation: &ExteriorOrientation,
        ground_m: [f64; 3],
    ) -> Result<Projection, AdjustmentError> {
        projection(orientation, self.principal_distance_mm, ground_m)
            .ok_or(AdjustmentError::NotConverged)
    }

    /// Returns the weight of every image point, from its own variance and that of the ground point
    /// as seen from the initial orientation.
    fn weights(&self, state: &State) -> Result<Vec<Vec<Matrix2<f64>>>, AdjustmentError> {
        let PointSigmas { image_mm, ground_m } = self.sigmas;
        self.frames
            .iter()
            .zip(&state.orientations)
            .map(|(frame, orientation)| {
                frame
                    .control
                    .iter()
                    .map(|point| {
                        let by_ground = self.projection(orientation, point.ground_m)?.by_ground;
                        let variance = image_mm.powi(2) * Matrix2::identity()
                            + ground_m.powi(2) * by_ground * by_ground.transpose();
                        variance.try_inverse().ok_or(AdjustmentError::NotConverged)
                    })
                    .collect()
            })
            .collect()
    }

    fn cost(&self, state: &State, weights: &[Vec<Matrix2<f64>>]) -> Result<f64, AdjustmentError> {
        let mut cost = 0.0;
        for ((frame, orientation), weights) in
            self.frames.iter().zip(&state.orientations).zip(weights)
        {
            for (point, weight) in frame.control.iter().zip(weights) {
                let projection = self.projection(orientation, point.ground_m)?;
                let residual = residual(point, &projection, state);
                cost += residual.dot(&(weight * residual));
            }
            for (residual, sigma) in frame
                .pos
                .residuals(orientation)
                .iter()
                .zip(frame.pos.sigmas)
            {
                cost += sigma.map_or(0.0, |sigma| (residual / sigma).powi(2));
            }
        }
        if cost.is_finite() {
            Ok(cost)
        } else {
            Err(AdjustmentError::NotConverged)
        }
    }

    /// Returns the RMS of Yuan et al. 2012, eq. 29.
    fn rms_mm(&self, state: &State) -> Result<f64, AdjustmentError> {
        let mut squares = 0.0;
        let mut points = 0.0;
        for (frame, orientation) in self.frames.iter().zip(&state.orientations) {
            for point in &frame.control {
                let projection = self.projection(orientation, point.ground_m)?;
                squares += residual(point, &projection, state).norm_squared();
                points += 1.0;
            }
        }
        Ok((squares / points).sqrt())
    }

    fn normal_equations(
        &self,
        state: &State,
        weights: &[Vec<Matrix2<f64>>],
        with_pos: bool,
    ) -> Result<NormalEquations, AdjustmentError> {
        let mut normals = NormalEquations::default();
        for ((frame, orientation), weights) in
            self.frames.iter().zip(&state.orientations).zip(weights)
        {
            let mut block = FrameBlock::default();
            for (point, weight) in frame.control.iter().zip(weights) {
                let projection = self.projection(orientation, point.ground_m)?;
                let residual = residual(point, &projection, state);
                let columns = point.corrected.columns.iter().zip(self.estimated);
                let columns: Vec<Vector2<f64>> = columns
                    .map(|(column, is_free)| {
                        if is_free {
                            Vector2::from(*column)
                        } else {
                            Vector2::zeros()
                        }
                    })
                    .collect();
                let shared = nalgebra::SMatrix::<f64, 2, COEFFICIENTS>::from_columns(&columns);
                let own = projection.by_orientation;
                block.matrix += own.tr_mul(&(weight * own));
                block.coupling += own.tr_mul(&(weight * shared));
                block.right += own.tr_mul(&(weight * residual));
                normals.shared += shared.tr_mul(&(weight * shared));
                normals.shared_right += shared.tr_mul(&(weight * residual));
            }
            if with_pos {
                frame.pos.add_to(&mut block, orientation);
            }
            normals.frames.push(block);
        }
        if with_pos {
            for (index, is_free) in self.estimated.iter().enumerate() {
                if let (false, Some(element)) = (is_free, normals.shared.get_mut((index, index))) {
                    *element = 1.0;
                }
            }
        }
        Ok(normals)
    }
}

/// Returns corrected less projected image point, mm.
fn residual(point: &ControlObservation, projection: &Projection, state: &State) -> Vector2<f64> {
    Vector2::from(point.corrected.ideal(&state.coefficients)) - projection.image_mm
}

impl State {
    fn moved(&self, frames: &[FrameVector], shared: &SharedVector) -> Self {
        let mut coefficients = self.coefficients;
        for (coefficient, step) in coefficients.iter_mut().zip(shared.iter()) {
            *coefficient += step;
        }
        Self {
            orientations: self
                .orientations
                .iter()
                .zip(frames)
                .map(|(orientation, step)| {
                    ExteriorOrientation::from_elements(&(orientation.elements() + step))
                })
                .collect(),
            coefficients,
        }
    }
}

/// Returns the largest step of an unknown in units of the σ that it would have alone.
fn largest_step(normals: &NormalEquations, frames: &[FrameVector], shared: &SharedVector) -> f64 {
    let of_shared = normals
        .shared
        .diagonal()
        .iter()
        .zip(shared.iter())
        .map(|(weight, step)| weight.sqrt() * step.abs())
        .fold(0.0, f64::max);
    normals
        .frames
        .iter()
        .zip(frames)
        .flat_map(|(block, step)| {
            let diagonal = block.matrix.diagonal();
            [0, 1, 2, 3, 4, 5].map(|index| {
                let weight = diagonal.get(index).copied().unwrap_or(0.0);
                weight.sqrt() * step.get(index).copied().unwrap_or(0.0).abs()
            })
        })
        .fold(of_shared, f64::max)
}
