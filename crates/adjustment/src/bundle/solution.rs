//! Least squares adjustment of a network.

use super::datum::Datum;
use super::error::{BundleError, MOST_ITERATIONS};
use super::layout::{Layout, PointUnknowns};
use super::network::{Network, PointRole};
use super::normals::Normals;
use super::separation;
use super::state::State;

/// Stopping rule: no function of the unknowns moves by more than this fraction of its own a priori
/// σ ([`Step::length`](super::state::Step::length)).
pub const SMALLEST_STEP: f64 = 1e-7;

/// Damping after the first step that raises the cost, as a fraction of the diagonal.
const FIRST_DAMPING: f64 = 1e-4;

/// Relative change of vᵀPv by rounding, also with coordinates far from the origin.
const ROUNDING: f64 = 1e-9;

/// Length of a step below which damping has done its work.
const SHORT_STEP: f64 = 1e-3;

/// Steps in sequence that may raise vᵀPv (the watchdog technique, Chamberlain et al. 1982): along a
/// curved valley the next one falls below where a damped step would have come to.
const MOST_RISES: usize = 3;

/// Damped steps that lower vᵀPv before undamped ones are tried again, twice as many each time.
const PATIENCE: usize = 6;

/// Damping after which steps are undamped again.
const LEAST_DAMPING: f64 = 1e-9;

/// Damping that ends the search for a better step.
const MOST_DAMPING: f64 = 1e8;

/// Choice of the observations or constraints that determine the datum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum DatumChoice {
    /// Observations where they suffice; inner constraints for what they leave.
    #[default]
    Auto,
    /// Inner constraints over all object points: control coordinates and positions observed on
    /// board are initial values.
    Free,
    /// Observations; an error where they do not suffice.
    Held,
}

/// An adjusted network, before statistics.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Adjusted values.
    pub state: State,
    /// Places of the unknowns.
    pub layout: Layout,
    /// Datum.
    pub datum: Datum,
    /// Elements of images that held the datum.
    pub held: Vec<usize>,
    /// Iterations.
    pub iterations: usize,
    /// vᵀPv.
    pub cost: f64,
    /// Number of observations.
    pub observations: usize,
    /// Number of unknowns less that of constraints.
    pub unknowns: usize,
}

impl Solution {
    /// Observations less unknowns, plus constraints.
    #[must_use]
    pub const fn redundancy(&self) -> usize {
        self.observations.saturating_sub(self.unknowns)
    }

    /// σ0, 1 without redundancy.
    #[must_use]
    pub fn sigma0(&self) -> f64 {
        match u32::try_from(self.redundancy()) {
            Ok(redundancy) if redundancy > 0 => (self.cost / f64::from(redundancy)).sqrt(),
            _ => 1.0,
        }
    }
}

/// Returns the network as the datum asks for it: without observations of the ground frame for a
/// free one.
#[must_use]
pub fn with_datum(network: &Network, choice: DatumChoice) -> Network {
    let mut network = network.clone();
    if choice == DatumChoice::Free {
        for point in &mut network.points {
            if point.role == PointRole::Control {
                point.role = PointRole::Tie;
            }
        }
        for image in &mut network.images {
            image.observed = None;
        }
    }
    network
}

/// Adjusts a network by damped Gauss-Newton iterations from given values.
///
/// # Model
/// Undamped steps; after several that raise vᵀPv, Levenberg-Marquardt damping of the whole
/// diagonal. The iterations end when an undamped step moves no function of the unknowns by more
/// than [`SMALLEST_STEP`] of its σ. Where rounding does not let the steps become as short, they end
/// when the predicted fall is within the rounding of vᵀPv and a step is no shorter than the one
/// before.
///
/// # Errors
/// [`BundleError`]: the datum, inseparable unknowns, or no convergence.
pub fn adjust(
    network: &Network,
    choice: DatumChoice,
    start: &State,
) -> Result<Solution, BundleError> {
    adjust_watched(network, choice, start, |_| ())
}

/// Adjusts a network as [`adjust`] does and shows the values after every iteration that is kept.
///
/// # Errors
/// [`BundleError`] as for [`adjust`].
pub fn adjust_watched(
    network: &Network,
    choice: DatumChoice,
    start: &State,
    mut watch: impl FnMut(&State),
) -> Result<Solution, BundleError> {
    let layout = Layout::new(network).map_err(|_| BundleError::NotConverged)?;
    let datum = Datum::of(network, &layout, start);
    if !datum.inseparable.is_empty() {
        return Err(BundleError::Inseparable {
            unknowns: datum
                .inseparable
                .iter()
                .map(|parameter| network.parameter_name(*parameter))
                .collect(),
        });
    }
    if choice == DatumChoice::Held && datum.defects() > 0 {
        return Err(BundleError::Datum {
            defects: datum.defects(),
        });
    }
    let mut search = Search {
        network,
        layout: &layout,
        held: Vec::new(),
    };
    let first =
        Normals::new(network, &layout, start, 0.0).map_err(|_| BundleError::NotConverged)?;
    search.held = datum.held_elements(start, &first.diagonal);
    let (mut state, mut cost, mut iterations) =
        search.minimum(start.clone(), first.cost, &mut watch)?;
    if datum.defects() > 0 {
        let aligned = datum
            .aligned(&layout, &state, start)
            .ok_or(BundleError::NotConverged)?;
        let (after, least, more) = search.minimum(aligned, f64::INFINITY, &mut watch)?;
        (state, cost) = (after, least);
        iterations += more.saturating_sub(1);
    }
    let held = search.held;
    let (observations, unknowns) = counts(network, &layout);
    Ok(Solution {
        state,
        held,
        iterations,
        cost,
        observations,
        unknowns: unknowns - datum.defects(),
        layout,
        datum,
    })
}

/// Returns the numbers of observations and unknowns.
fn counts(network: &Network, layout: &Layout) -> (usize, usize) {
    let rays = network
        .image_points
        .iter()
        .filter(|ray| layout.uses(ray))
        .count();
    let coordinates: usize = network
        .points
        .iter()
        .enumerate()
        .filter(|(number, _)| {
            !matches!(
                layout.point(*number),
                PointUnknowns::Held | PointUnknowns::Unused
            )
        })
        .map(|(_, point)| point.observed_sigmas().iter().flatten().count())
        .sum();
    let poses: usize = network
        .images
        .iter()
        .filter_map(|image| image.observed)
        .map(|observed| observed.sigmas.iter().flatten().count())
        .sum();
    // A prior of a value that is held says nothing.
    let priors = network
        .priors
        .iter()
        .filter(|prior| layout.column(prior.parameter).is_some())
        .count();
    let bars = network.scale_bars.iter();
    let bars = bars.filter(|bar| layout.uses_bar(bar)).count();
    let observations = 2 * rays + coordinates + poses + bars + priors;
    (observations, layout.unknowns())
}

struct Search<'a> {
    network: &'a Network,
    layout: &'a Layout,
    held: Vec<usize>,
}

impl Search<'_> {
    fn normals(&self, state: &State, damping: f64) -> Option<Normals> {
        let mut normals = Normals::new(self.network, self.layout, state, damping).ok()?;
        normals.hold(&self.held);
        Some(normals)
    }

    /// Iterates to the least vᵀPv; returns it with the number of iterations.
    fn minimum(
        &self,
        start: State,
        cost: f64,
        watch: &mut impl FnMut(&State),
    ) -> Result<(State, f64, usize), BundleError> {
        let failed = || BundleError::NotConverged;
        let mut best = Best {
            state: start.clone(),
            cost,
        };
        let mut state = start;
        let mut damping = 0.0;
        let mut rises = 0;
        let mut normals = self.normals(&state, damping).ok_or_else(failed)?;
        let mut before = f64::INFINITY;
        let (mut falls, mut patience) = (0, PATIENCE);
        for iteration in 1..=MOST_ITERATIONS {
            let step = match normals.solve(self.network, self.layout, &state) {
                Ok(step) => step,
                Err(_) if damping <= 0.0 => {
                    separation::check(self.network, self.layout, &normals)?;
                    damping = FIRST_DAMPING;
                    normals = self.normals(&state, damping).ok_or_else(failed)?;
                    continue;
                }
                Err(_) => return Err(failed()),
            };
            let moved = state.moved(self.layout, &step);
            let next = self
                .normals(&moved, 0.0)
                .filter(|next| next.cost.is_finite());
            let length = step.length();
            let is_unseen = damping <= 0.0 && step.fall <= ROUNDING * normals.cost;
            match next {
                // vᵀPv changes by rounding alone: the length of the steps tells where they end.
                Some(next) if is_unseen || (damping <= 0.0 && length < SMALLEST_STEP) => {
                    watch(&moved);
                    if length < SMALLEST_STEP || length >= before {
                        return Ok((moved, next.cost, iteration));
                    }
                    best = Best {
                        state: moved.clone(),
                        cost: best.cost.min(next.cost),
                    };
                    (state, rises, before) = (moved, 0, length);
                    normals = next;
                }
                Some(next) if next.cost <= best.cost * (1.0 + ROUNDING) => {
                    watch(&moved);
                    best = Best {
                        state: moved.clone(),
                        cost: next.cost,
                    };
                    (state, rises, falls) = (moved, 0, falls + 1);
                    damping = if falls >= patience {
                        (falls, patience) = (0, 2 * patience);
                        0.0
                    } else if damping > LEAST_DAMPING && length > SHORT_STEP {
                        0.1 * damping
                    } else {
                        0.0
                    };
                    normals = if damping > 0.0 {
                        self.normals(&state, damping).ok_or_else(failed)?
                    } else {
                        next
                    };
                }
                Some(next) if damping <= 0.0 && rises < MOST_RISES => {
                    watch(&moved);
                    rises += 1;
                    state = moved;
                    normals = next;
                }
                _ => {
                    damping = if damping > 0.0 {
                        10.0 * damping
                    } else {
                        FIRST_DAMPING
                    };
                    if damping > MOST_DAMPING {
                        break;
                    }
                    (state, rises) = (best.state.clone(), 0);
                    normals = self.normals(&state, damping).ok_or_else(failed)?;
                }
            }
        }
        let normals = self.normals(&best.state, 0.0);
        Err(separation::not_converged(
            self.network,
            self.layout,
            normals,
        ))
    }
}

/// Values with the least vᵀPv so far.
struct Best {
    state: State,
    cost: f64,
}
