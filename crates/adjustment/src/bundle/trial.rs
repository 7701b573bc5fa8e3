//! Adjustment of changed tables, on trial: how well would they fit?

use super::interior::{Interior, InteriorElement};
use super::network::{Network, PointRole};
use super::network_of_tables::Unknowns;
use super::orientation::network_orientation::orient;
use super::parameters::Parameter;
use super::part_of_block::part_of_block;
use super::solution::{DatumChoice, Solution, adjust, with_datum};
use super::state::State;
use super::tables::{NetworkTables, RowRole};

/// Most image points of all trials together, some tens of seconds: a small network is tried as
/// often as its files could be read otherwise, a block of 10,000 images only in part.
const MOST_ADJUSTED: usize = 2_000_000;

/// Returns the tables, or a part of them that can be adjusted so many times.
#[must_use]
pub fn part_for(tables: &NetworkTables, trials: usize) -> NetworkTables {
    part_of_block(tables, MOST_ADJUSTED / trials.max(1))
}

/// Returns true if whole tables can be adjusted so many times.
#[must_use]
pub const fn allows(tables: &NetworkTables, trials: usize) -> bool {
    tables.image_points.rows.len().saturating_mul(trials) <= MOST_ADJUSTED
}

/// Adjusts tables from a new orientation; `None` if they cannot be oriented or do not converge.
///
/// With `keeps_pinhole`, principal distance and principal point are held: estimated, they imitate
/// another unit of heights.
#[must_use]
pub fn adjusted(
    tables: &NetworkTables,
    start: Interior,
    unknowns: &Unknowns,
    choice: DatumChoice,
    keeps_pinhole: bool,
) -> Option<(Network, Solution)> {
    let network = with_datum(&oriented(tables, start, unknowns)?, choice);
    adjusted_network(network, choice, keeps_pinhole)
}

/// Adjusts tables without a control point as control: from an orientation without it, or, where the
/// other points are too few for one, with it.
#[must_use]
pub fn without(
    point: &str,
    tables: &NetworkTables,
    start: Interior,
    unknowns: &Unknowns,
    choice: DatumChoice,
) -> Option<(Network, Solution)> {
    let mut others = tables.clone();
    let rows = others.object_points.rows.iter_mut();
    for row in rows.filter(|row| &*row.point == point) {
        row.role = RowRole::Check;
    }
    let network = oriented(&others, start, unknowns).or_else(|| {
        let mut network = oriented(tables, start, unknowns)?;
        for object in &mut network.points {
            if object.name == point {
                object.role = PointRole::Check;
            }
        }
        Some(network)
    })?;
    adjusted_network(with_datum(&network, choice), choice, false)
}

fn oriented(tables: &NetworkTables, start: Interior, unknowns: &Unknowns) -> Option<Network> {
    let mut tabled = tables.network(start, unknowns).ok()?;
    let unoriented = orient(&mut tabled.network, tabled.known.clone());
    (unoriented.images.is_empty() && unoriented.points.is_empty()).then_some(tabled.network)
}

fn adjusted_network(
    network: Network,
    choice: DatumChoice,
    keeps_pinhole: bool,
) -> Option<(Network, Solution)> {
    let mut first = network.clone();
    first.estimated.clear();
    first.priors.clear();
    let held = adjust(&first, choice, &State::initial(&first)).ok()?;
    let mut second = network;
    if keeps_pinhole {
        let pinhole = [
            InteriorElement::PrincipalDistance,
            InteriorElement::X0,
            InteriorElement::Y0,
        ];
        let is_kept = |parameter: &Parameter| !pinhole.map(Parameter::Interior).contains(parameter);
        second.estimated.retain(is_kept);
        second.priors.retain(|prior| is_kept(&prior.parameter));
    }
    match adjust(&second, choice, &held.state) {
        Ok(solution) => Some((second, solution)),
        Err(_) => Some((first, held)),
    }
}
