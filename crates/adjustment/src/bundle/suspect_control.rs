//! Control point that does not fit, found by leaving out one after the other.

use nalgebra::Vector3;

use super::error::{BundleError, Misfit};
use super::interior::Interior;
use super::network_of_tables::Unknowns;
use super::solution::DatumChoice;
use super::tables::{NetworkTables, ObjectPointRow, RowRole};
use super::trial;

/// Most control points that are left out in turn.
const MOST_TRIED: usize = 60;

/// Factor of σ0 within which leaving out another point explains the misfit as well.
const AS_WELL: f64 = 1.1;

/// Factor of the σ0 that the search for gross errors has reached within which one point explains
/// as much.
const AS_GOOD: f64 = 1.2;

/// Returns the error of control that does not fit with the single point whose release explains it
/// best, oriented anew without it; the error as it was if no single point does, and for a block too
/// large to be adjusted as often.
///
/// The search for gross errors starts from an orientation that the wrong point has bent, and from
/// there another one may seem wrong.
#[must_use]
pub fn refined(
    tables: &NetworkTables,
    start: Interior,
    unknowns: &Unknowns,
    choice: DatumChoice,
    error: BundleError,
) -> BundleError {
    let BundleError::Control {
        sigma0, without, ..
    } = error
    else {
        return error;
    };
    let control = |row: &&ObjectPointRow| row.role == RowRole::Control;
    let points = tables.object_points.rows.iter().filter(control).count();
    if points > MOST_TRIED || !trial::allows(tables, points) {
        return error;
    }
    let mut explained: Vec<(Misfit, f64)> = Vec::new();
    for row in tables.object_points.rows.iter().filter(control) {
        let Some((network, solution)) = trial::without(&row.point, tables, start, unknowns, choice)
        else {
            continue;
        };
        let number = network
            .points
            .iter()
            .position(|point| *point.name == *row.point);
        if let Some(number) = number {
            let misfit = Misfit {
                point: row.point.to_string(),
                difference_m: solution.state.point(number) - Vector3::from(row.position_m),
            };
            explained.push((misfit, solution.sigma0()));
        }
    }
    explained.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let Some(least) = explained.first().map(|(_, sigma0)| *sigma0) else {
        return error;
    };
    if least > AS_GOOD * without {
        return error;
    }
    let mut points = explained
        .into_iter()
        .filter(|(_, sigma0)| *sigma0 <= AS_WELL * least)
        .map(|(misfit, _)| misfit);
    BundleError::Control {
        points: points.next().into_iter().collect(),
        or: points.collect(),
        sigma0,
        without: least,
    }
}
