//! Damped Gauss-Newton adjustment of few unknowns, by orthogonal decomposition.

use nalgebra::{DMatrix, DVector};

/// Largest number of iterations.
pub(crate) const MOST_ITERATIONS: usize = 100;

/// An iteration that moves no residual by more than this, mm, is the last.
pub(crate) const LAST_STEP_MM: f64 = 1e-10;

/// Least singular value of a design with columns of unit length, as a share of the largest; below,
/// the observations do not separate the unknowns.
pub(crate) const LEAST_SEPARATION: f64 = 1e-8;

/// Unknowns with more than this share of the largest in an inseparable combination are named.
const NAMED_SHARE: f64 = 0.3;

/// Dampings that are tried before a step counts as impossible.
const DAMPINGS: usize = 30;

/// Residuals of one observation with their derivatives by the unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Linearised<const D: usize> {
    /// Observed - computed, mm.
    pub(crate) residual: [f64; D],
    /// Derivatives of the residual by the unknowns.
    pub(crate) derivatives: [Vec<f64>; D],
}

/// Observations of `D` components each, with a model of them at the unknowns of the moment.
pub(crate) trait Model<const D: usize>: Clone {
    /// Number of unknowns.
    fn unknowns(&self) -> usize;
    /// Number of observations, of `D` components each.
    fn observations(&self) -> usize;
    /// σ of the components of an observation, mm.
    fn sigma_mm(&self, index: usize) -> f64;
    /// Returns residual and derivatives; `None` where the model does not exist.
    fn linearised(&self, index: usize) -> Option<Linearised<D>>;
    /// Returns the model with its unknowns changed; `None` where it does not exist.
    fn moved(&self, step: &[f64]) -> Option<Self>;
}

/// A reason why an adjustment failed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum AdjustmentError {
    /// Fewer components than unknowns.
    TooFew { components: usize, unknowns: usize },
    /// The model does not exist for an observation.
    Undefined { index: usize },
    /// The observations do not separate these unknowns.
    Inseparable { unknowns: Vec<usize> },
    /// The last step still moved a residual by so much.
    NotConverged { step_mm: f64 },
}

/// An adjustment.
#[derive(Debug, Clone)]
pub(crate) struct Adjusted<M, const D: usize> {
    pub(crate) model: M,
    /// Cofactor matrix of the unknowns.
    pub(crate) cofactors: DMatrix<f64>,
    /// Factor of the given σ; 1 without redundancy.
    pub(crate) sigma0: f64,
    pub(crate) redundancy: usize,
    pub(crate) iterations: usize,
    /// Residuals of all observations, mm, rejected ones too.
    pub(crate) residuals: Vec<[f64; D]>,
    /// aᵀQa/σ² of their components.
    pub(crate) leverages: Vec<[f64; D]>,
}

/// Adjusts the unknowns to the accepted observations.
pub(crate) fn adjust<M: Model<D>, const D: usize>(
    start: &M,
    accepted: &[bool],
) -> Result<Adjusted<M, D>, AdjustmentError> {
    let unknowns = start.unknowns();
    let components = D * accepted.iter().filter(|accepted| **accepted).count();
    if components < unknowns {
        return Err(AdjustmentError::TooFew {
            components,
            unknowns,
        });
    }
    let mut model = start.clone();
    let mut system = System::of(&model, accepted)?;
    let mut iterations = 0;
    loop {
        iterations += 1;
        let factor = system.factor()?;
        let mut damping = 0.0;
        let mut last_mm = 0.0;
        let mut next = None;
        for _ in 0..DAMPINGS {
            let step = factor.step(damping);
            last_mm = system.effect_mm(&step);
            let moved = model
                .moved(step.as_slice())
                .and_then(|model| Some((System::of(&model, accepted).ok()?, model)));
            let is_better = moved
                .as_ref()
                .is_some_and(|(moved, _)| moved.cost() <= system.cost() || last_mm <= LAST_STEP_MM);
            if is_better {
                next = moved;
                break;
            }
            damping = if damping > 0.0 { 10.0 * damping } else { 1e-6 };
        }
        // A step that rounding alone hinders is the last one.
        let Some((moved_system, moved_model)) = next else {
            if last_mm <= 1e3 * LAST_STEP_MM {
                break;
            }
            return Err(AdjustmentError::NotConverged { step_mm: last_mm });
        };
        (system, model) = (moved_system, moved_model);
        if last_mm <= LAST_STEP_MM {
            break;
        }
        if iterations >= MOST_ITERATIONS {
            return Err(AdjustmentError::NotConverged { step_mm: last_mm });
        }
    }
    let cofactors = system.factor()?.cofactors();
    let redundancy = components - unknowns;
    let sigma0 = if redundancy == 0 {
        1.0
    } else {
        (system.cost() / super::snooping::count(redundancy)).sqrt()
    };
    let (mut residuals, mut leverages) = (Vec::new(), Vec::new());
    for index in 0..model.observations() {
        let row = model
            .linearised(index)
            .ok_or(AdjustmentError::Undefined { index })?;
        let sigma = model.sigma_mm(index);
        residuals.push(row.residual);
        leverages.push(row.derivatives.map(|derivatives| {
            let row = DVector::from_vec(derivatives);
            row.dot(&(&cofactors * &row)) / sigma.powi(2)
        }));
    }
    Ok(Adjusted {
        model,
        cofactors,
        sigma0,
        redundancy,
        iterations,
        residuals,
        leverages,
    })
}

/// Linearised observations, divided by their σ.
struct System {
    design: DMatrix<f64>,
    residuals: DVector<f64>,
    sigmas_mm: Vec<f64>,
}

impl System {
    fn of<M: Model<D>, const D: usize>(
        model: &M,
        accepted: &[bool],
    ) -> Result<Self, AdjustmentError> {
        let unknowns = model.unknowns();
        let mut rows = Vec::new();
        let (mut residuals, mut sigmas_mm) = (Vec::new(), Vec::new());
        for (index, _) in accepted.iter().enumerate().filter(|(_, taken)| **taken) {
            let sigma = model.sigma_mm(index);
            let one = model
                .linearised(index)
                .ok_or(AdjustmentError::Undefined { index })?;
            for (residual, derivatives) in one.residual.into_iter().zip(one.derivatives) {
                residuals.push(residual / sigma);
                sigmas_mm.push(sigma);
                rows.extend(derivatives.into_iter().map(|one| one / sigma));
            }
        }
        Ok(Self {
            design: DMatrix::from_row_slice(residuals.len(), unknowns, &rows),
            residuals: DVector::from_vec(residuals),
            sigmas_mm,
        })
    }

    fn cost(&self) -> f64 {
        self.residuals.norm_squared()
    }

    /// Returns the largest change of a residual by a step, mm.
    fn effect_mm(&self, step: &DVector<f64>) -> f64 {
        let change = &self.design * step;
        let changes = change.iter().zip(&self.sigmas_mm);
        changes
            .map(|(change, sigma)| (change * sigma).abs())
            .fold(0.0, f64::max)
    }

    fn factor(&self) -> Result<Factor, AdjustmentError> {
        let lengths: Vec<f64> = self.design.column_iter().map(|one| one.norm()).collect();
        let unobserved: Vec<usize> = (0..lengths.len())
            .filter(|index| lengths.get(*index).is_none_or(|length| *length <= 0.0))
            .collect();
        if !unobserved.is_empty() {
            return Err(AdjustmentError::Inseparable {
                unknowns: unobserved,
            });
        }
        let scale = DVector::from_iterator(lengths.len(), lengths.iter().map(|one| one.recip()));
        let mut design = self.design.clone();
        for (mut column, scale) in design.column_iter_mut().zip(scale.iter()) {
            column *= *scale;
        }
        let decomposed = design.qr();
        let mut right = -&self.residuals;
        decomposed.q_tr_mul(&mut right);
        let unknowns = lengths.len();
        let right = right.rows(0, unknowns).into_owned();
        let svd = decomposed.r().svd(true, true);
        let (Some(u), Some(vt)) = (svd.u, svd.v_t) else {
            return Err(AdjustmentError::Inseparable {
                unknowns: Vec::new(),
            });
        };
        let values = svd.singular_values;
        let (least, largest) = (values.min(), values.max());
        if least.is_nan() || least < LEAST_SEPARATION * largest {
            let direction = vt.row(values.imin());
            let most = direction.amax();
            return Err(AdjustmentError::Inseparable {
                unknowns: direction
                    .iter()
                    .enumerate()
                    .filter(|(_, share)| share.abs() >= NAMED_SHARE * most)
                    .map(|(index, _)| index)
                    .collect(),
            });
        }
        Ok(Factor {
            scale,
            projected: u.tr_mul(&right),
            values,
            vt,
        })
    }
}

/// Singular values of the scaled design with the projected residuals.
struct Factor {
    scale: DVector<f64>,
    projected: DVector<f64>,
    values: DVector<f64>,
    vt: DMatrix<f64>,
}

impl Factor {
    /// Returns the step of the unknowns with a damping as a share of the largest singular value
    /// squared.
    fn step(&self, damping: f64) -> DVector<f64> {
        let added = damping * self.values.max().powi(2);
        let shares = self.projected.zip_map(&self.values, |projected, value| {
            projected * value / (value * value + added)
        });
        self.vt.tr_mul(&shares).component_mul(&self.scale)
    }

    fn cofactors(&self) -> DMatrix<f64> {
        let mut rows = self.vt.clone();
        for (mut row, value) in rows.row_iter_mut().zip(self.values.iter()) {
            row /= *value;
        }
        let scaled = rows.tr_mul(&rows);
        DMatrix::from_fn(scaled.nrows(), scaled.ncols(), |row, column| {
            let scale = |index: usize| self.scale.get(index).copied().unwrap_or(0.0);
            scaled.get((row, column)).copied().unwrap_or(0.0) * scale(row) * scale(column)
        })
    }
}
