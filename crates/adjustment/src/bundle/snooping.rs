//! Search for gross errors in a network: image points that disagree with the others, and control
//! points that do not fit.

use nalgebra::Vector3;

use crate::calibration::snooping::{
    FAMILY_ERROR, LEAST_REDUNDANCY, ROUNDING_MM, count, pope, student,
};

use super::cofactors::Cofactors;
use super::error::BundleError;
use super::network::{Network, PointRole};
use super::solution::{DatumChoice, Solution, adjust};
use super::state::State;
use super::tested::Tests;

/// Largest number of rounds of testing and adjusting.
const MOST_ROUNDS: usize = 400;

/// Image points are rejected in one round with the worst if their test value is at least this share
/// of its, and they belong to other object points.
const SHARE_OF_WORST: f64 = 0.75;

/// Fall of vᵀPv, in units of σ0², by which the release of a control point must exceed the rejection
/// of its worst image point: the release has one unknown more.
const LEAST_ADVANTAGE: f64 = 15.0;

/// Control points tried in one round.
const MOST_CANDIDATES: usize = 4;

/// A control point whose given coordinates do not fit.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlMisfit {
    /// Number of the point.
    pub point: usize,
    /// Coordinates without it as control less given ones, m.
    pub difference_m: Vector3<f64>,
}

/// An adjusted network after the search.
#[derive(Debug, Clone)]
pub struct Snooped {
    /// The network, rejected image points marked.
    pub network: Network,
    /// Its adjustment, all control points as given.
    pub solution: Solution,
    /// Cofactors.
    pub cofactors: Cofactors,
    /// Tests.
    pub tests: Tests,
    /// Critical value of the test of an observation in the adjustment.
    pub critical: f64,
    /// Control points that do not fit.
    pub misfits: Vec<ControlMisfit>,
    /// σ0 without the control points that do not fit.
    pub sigma0_without_misfits: f64,
}

/// Critical values for observations in the adjustment and outside of it.
///
/// # Model
/// The probability that any good observation is rejected, shared by all components; Pope's τ for
/// observations in the adjustment, Student's t for the others.
#[must_use]
pub fn critical_values(family_error: f64, observations: usize, redundancy: usize) -> [f64; 2] {
    let freedom = count(redundancy).max(2.0);
    let outside = student(
        1.0 - family_error / (2.0 * count(observations.max(1))),
        freedom - 1.0,
    );
    [pope(outside, freedom), outside]
}

impl Snooped {
    /// Tests an adjusted network without rejecting anything.
    ///
    /// # Errors
    /// [`BundleError`] if the cofactors cannot be computed.
    pub fn unrejected(network: &Network, solution: &Solution) -> Result<Self, BundleError> {
        let cofactors = Cofactors::of(network, solution).map_err(|_| BundleError::NotConverged)?;
        let [critical, _] =
            critical_values(FAMILY_ERROR, solution.observations, solution.redundancy());
        Ok(Self {
            network: network.clone(),
            solution: solution.clone(),
            tests: Tests::of(network, solution, &cofactors),
            cofactors,
            critical,
            misfits: Vec::new(),
            sigma0_without_misfits: solution.sigma0(),
        })
    }
}

struct Round {
    solution: Solution,
    cofactors: Cofactors,
    tests: Tests,
    critical: [f64; 2],
    /// The cofactors are those of the solution, not of an earlier one with more observations.
    is_exact: bool,
}

impl Round {
    fn of(network: &Network, choice: DatumChoice, start: &State) -> Result<Self, BundleError> {
        Self::exact(network, adjust(network, choice, start)?)
    }

    fn exact(network: &Network, solution: Solution) -> Result<Self, BundleError> {
        let cofactors = Cofactors::of(network, &solution).map_err(|_| BundleError::NotConverged)?;
        Ok(Self::tested(network, solution, cofactors, true))
    }

    /// Adjusts the network of this round with fewer observations, and tests with the cofactors that
    /// are there: to compute those of the images takes longer than to adjust.
    ///
    /// # Model
    /// Cofactors grow when observations are left out (`Q' - Q` is positive semidefinite). With the
    /// earlier ones a redundancy number is too large and a test value too small, so that nothing is
    /// rejected that would not be with the right ones; what is not found is found with those.
    fn with_fewer(self, network: &Network, choice: DatumChoice) -> Result<Self, BundleError> {
        let solution = adjust(network, choice, &self.solution.state)?;
        if solution.layout.border != self.solution.layout.border {
            return Self::exact(network, solution);
        }
        Ok(Self::tested(network, solution, self.cofactors, false))
    }

    fn tested(network: &Network, solution: Solution, cofactors: Cofactors, is_exact: bool) -> Self {
        let tests = Tests::of(network, &solution, &cofactors);
        let critical = critical_values(FAMILY_ERROR, solution.observations, solution.redundancy());
        Self {
            solution,
            cofactors,
            tests,
            critical,
            is_exact,
        }
    }

    /// Test value of an image point; 0 for residuals that are rounding.
    fn value(&self, place: usize) -> f64 {
        let components = self.tests.image_points.get(place);
        components
            .into_iter()
            .flatten()
            .filter(|component| component.residual.abs() > ROUNDING_MM)
            .map(|component| component.test_value)
            .fold(0.0, f64::max)
    }
}

/// Adjusts a network, rejecting gross errors.
///
/// # Model
/// Pope's test of every component with σ0 estimated; the worst image point is rejected, then again,
/// until none exceeds the critical value; rejected ones that agree with the final adjustment are
/// admitted again. Where the worst image point belongs to a control point whose release explains
/// more than its rejection, the control point is taken to be wrong and released for the rest of the
/// search; the final adjustment has all control points as given.
///
/// # Errors
/// [`BundleError`] of an adjustment.
pub fn snooped(
    network: &Network,
    choice: DatumChoice,
    start: &State,
) -> Result<Snooped, BundleError> {
    let mut working = network.clone();
    let mut misfits: Vec<usize> = Vec::new();
    let mut admitted_again = vec![false; network.image_points.len()];
    let mut round = Round::of(&working, choice, start)?;
    for _ in 0..MOST_ROUNDS {
        if round.solution.redundancy() < LEAST_REDUNDANCY {
            break;
        }
        let [inside, outside] = round.critical;
        let worst = violators(&working, &round, inside);
        if worst.is_empty() && !round.is_exact {
            round = Round::exact(&working, round.solution)?;
            continue;
        }
        let mut next = working.clone();
        let mut is_subset = false;
        if let Some(&(place, _)) = worst.first() {
            let point = working
                .image_points
                .get(place)
                .map_or(0, |observed| observed.point);
            let released = if is_control(&working, point) {
                released(&working, choice, &round, &worst, place)?
            } else {
                None
            };
            if let Some(point) = released {
                misfits.push(point);
                release(&mut next, point);
            } else {
                reject(&mut next, &worst);
                is_subset = true;
            }
        } else {
            let mut changed = false;
            for (place, observed) in next.image_points.iter_mut().enumerate() {
                let value = round.value(place);
                if !observed.accepted && value > 0.0 && value <= outside {
                    if let Some(flag) = admitted_again.get_mut(place) {
                        if *flag {
                            continue;
                        }
                        *flag = true;
                    }
                    observed.accepted = true;
                    changed = true;
                }
            }
            if !changed {
                break;
            }
        }
        round = if is_subset {
            round.with_fewer(&next, choice)?
        } else {
            Round::of(&next, choice, &round.solution.state)?
        };
        working = next;
    }
    if !round.is_exact {
        round = Round::exact(&working, round.solution)?;
    }
    finished(network, choice, working, round, &misfits)
}

fn finished(
    network: &Network,
    choice: DatumChoice,
    working: Network,
    round: Round,
    misfits: &[usize],
) -> Result<Snooped, BundleError> {
    let sigma0_without_misfits = round.solution.sigma0();
    let misfits: Vec<ControlMisfit> = misfits
        .iter()
        .map(|&point| ControlMisfit {
            point,
            difference_m: round.solution.state.point(point)
                - network
                    .points
                    .get(point)
                    .map_or_else(Vector3::zeros, |point| point.given_m),
        })
        .collect();
    if misfits.is_empty() {
        return Ok(Snooped {
            network: working,
            critical: round.critical[0],
            solution: round.solution,
            cofactors: round.cofactors,
            tests: round.tests,
            misfits,
            sigma0_without_misfits,
        });
    }
    let mut all = network.clone();
    for (observed, other) in all.image_points.iter_mut().zip(&working.image_points) {
        observed.accepted = other.accepted;
    }
    let mut start = round.solution.state;
    for misfit in &misfits {
        if let (Some(position), Some(point)) = (
            start.points_m.get_mut(misfit.point),
            all.points.get(misfit.point),
        ) {
            *position = point.given_m;
        }
    }
    let round = Round::of(&all, choice, &start)?;
    Ok(Snooped {
        network: all,
        critical: round.critical[0],
        solution: round.solution,
        cofactors: round.cofactors,
        tests: round.tests,
        misfits,
        sigma0_without_misfits,
    })
}

/// Returns the accepted image points above the critical value, the worst first.
fn violators(network: &Network, round: &Round, critical: f64) -> Vec<(usize, f64)> {
    let mut worst: Vec<(usize, f64)> = network
        .image_points
        .iter()
        .enumerate()
        .filter(|(_, observed)| observed.accepted)
        .map(|(place, _)| (place, round.value(place)))
        .filter(|(_, value)| *value > critical)
        .collect();
    worst.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    worst
}

fn is_control(network: &Network, point: usize) -> bool {
    network
        .points
        .get(point)
        .is_some_and(|point| point.role == PointRole::Control)
}

fn release(network: &mut Network, point: usize) {
    if let Some(point) = network.points.get_mut(point) {
        point.role = PointRole::Check;
    }
}

/// Rejects the worst image point, and those nearly as bad of other object points.
fn reject(network: &mut Network, worst: &[(usize, f64)]) {
    let Some(&(_, largest)) = worst.first() else {
        return;
    };
    let mut points = Vec::new();
    for (place, value) in worst {
        let Some(observed) = network.image_points.get_mut(*place) else {
            continue;
        };
        if *value >= SHARE_OF_WORST * largest && !points.contains(&observed.point) {
            points.push(observed.point);
            observed.accepted = false;
        }
    }
}

/// Returns the control point whose release explains more than the rejection of the worst image
/// point.
fn released(
    network: &Network,
    choice: DatumChoice,
    round: &Round,
    worst: &[(usize, f64)],
    place: usize,
) -> Result<Option<usize>, BundleError> {
    let mut candidates: Vec<(usize, usize)> = Vec::new();
    for (place, _) in worst {
        let Some(observed) = network.image_points.get(*place) else {
            continue;
        };
        if !is_control(network, observed.point) {
            continue;
        }
        match candidates
            .iter_mut()
            .find(|(point, _)| *point == observed.point)
        {
            Some((_, count)) => *count += 1,
            None => candidates.push((observed.point, 1)),
        }
    }
    let worst_point = network
        .image_points
        .get(place)
        .map(|observed| observed.point);
    // A single bad image point of a control point is no reason to doubt the control point.
    candidates.retain(|(point, count)| *count > 1 || worst_point == Some(*point));
    candidates.truncate(MOST_CANDIDATES);
    if candidates.is_empty() {
        return Ok(None);
    }
    let mut rejected = network.clone();
    if let Some(observed) = rejected.image_points.get_mut(place) {
        observed.accepted = false;
    }
    let by_rejection = adjust(&rejected, choice, &round.solution.state)?.cost;
    let mut best: Option<(usize, f64)> = None;
    for (point, _) in candidates {
        let mut without = network.clone();
        release(&mut without, point);
        let Ok(solution) = adjust(&without, choice, &round.solution.state) else {
            continue;
        };
        let advantage = (by_rejection - solution.cost) / solution.sigma0().powi(2);
        if advantage > LEAST_ADVANTAGE && best.is_none_or(|(_, most)| advantage > most) {
            best = Some((point, advantage));
        }
    }
    Ok(best.map(|(point, _)| point))
}
