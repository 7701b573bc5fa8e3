//! Doubts about residual grids that a reader must know of.

use std::collections::BTreeSet;

use super::design::Place;
use super::fit::GridFit;
use super::polynomial::COEFFICIENT_NAMES;
use super::request::GridRequest;
use crate::calibration::failure::listed;
use crate::calibration::result::CalibrationResult;
use crate::calibration::snooping::count;

/// Residual from which on a row that fails its test is warned of, mm: 50 nm.
const LEAST_RESIDUAL_MM: f64 = 50e-6;

/// Share of empty cells that is warned of.
const LARGEST_EMPTY: f64 = 0.05;

/// Share of the observations that residuals keep, below which they do not judge the grid.
const LEAST_REDUNDANT: f64 = 0.2;

/// Rows that a warning names.
const NAMED: usize = 3;

/// Returns the warnings of a result.
pub(super) fn warnings(
    result: &CalibrationResult,
    question: &GridRequest<'_>,
    found: &GridFit,
) -> Vec<String> {
    let mut warnings: Vec<String> = result.coverage().warning().into_iter().collect();
    warnings.extend(undetermined(found));
    warnings.extend(empty_cells(result, question));
    warnings.extend(redundancy(result));
    warnings.extend(rows(result));
    warnings
}

fn undetermined(found: &GridFit) -> Option<String> {
    let names: Vec<String> = found
        .undetermined
        .iter()
        .filter_map(|index| COEFFICIENT_NAMES.get(*index).map(|name| (*name).to_owned()))
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "the table does not determine {} beside the grid: what they share stays as in the camera file",
            listed(&names)
        )
    })
}

/// Returns a warning of cells on the sensor without a row.
fn empty_cells(result: &CalibrationResult, question: &GridRequest<'_>) -> Option<String> {
    let (_, lattice) = question.grids.first()?;
    let rows = question.observations.iter();
    let occupied: BTreeSet<usize> = rows
        .filter_map(|row| lattice.cell_at(Place::new(question, row).of_lens_mm))
        .collect();
    let [half_x, half_y] = result.camera.half_format_mm();
    let on_sensor: BTreeSet<usize> = lattice
        .cell_centres_mm()
        .filter(|[x, y]| x.abs() < half_x && y.abs() < half_y)
        .filter_map(|centre| lattice.cell_at(centre))
        .collect();
    let empty = on_sensor.difference(&occupied).count();
    (count(empty) > LARGEST_EMPTY * count(on_sensor.len())).then(|| {
        format!(
            "{empty} of {} cells of {} mm on the sensor hold no row of the table: structure there is drawn from their neighbours",
            on_sensor.len(),
            lattice.pitch_mm()
        )
    })
}

fn redundancy(result: &CalibrationResult) -> Option<String> {
    let share = count(result.redundancy()) / count(result.observations);
    (share < LEAST_REDUNDANT).then(|| {
        format!(
            "the grid follows {:.0} % of the observations: σ0 and tests say little; take a longer pitch or more points",
            100.0 * (1.0 - share)
        )
    })
}

/// Returns a warning of rows that do not fit their neighbours.
fn rows(result: &CalibrationResult) -> Option<String> {
    let critical = result.critical_value?;
    let mut wrong: Vec<_> = result
        .image_residuals
        .iter()
        .filter(|one| {
            let [x, y] = one.vector_mm();
            one.test_value() > critical && x.abs().max(y.abs()) > LEAST_RESIDUAL_MM
        })
        .collect();
    wrong.sort_by(|a, b| b.test_value().total_cmp(&a.test_value()));
    let named: Vec<String> = wrong
        .iter()
        .take(NAMED)
        .map(|one| {
            let [x, y] = one.vector_mm().map(|mm| 1e3 * mm);
            format!("line {} ({x:+.3}, {y:+.3}) µm", one.line)
        })
        .collect();
    (!wrong.is_empty()).then(|| {
        format!(
            "{} of {} rows do not fit their neighbours (τ above {critical:.2}), the worst {}: a wrong row bends the grid by its share",
            wrong.len(),
            result.image_residuals.len(),
            named.join(", ")
        )
    })
}
