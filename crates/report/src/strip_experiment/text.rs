//! The flight as text for a terminal or a pipe.

use comfy_table::{CellAlignment, Table, presets::UTF8_FULL_CONDENSED};
use fmc_simulation::strip_experiment::experiment::Experiment;

use super::rows::{Row, rows};
use super::verdict;

/// Writes the scenario, a row per model, and the conclusions from the intervals.
#[must_use]
pub fn text(experiment: &Experiment) -> String {
    let mut lines = vec![
        format!("scenario: {}", experiment.scenario.written.name),
        setting(experiment),
        table(&rows(experiment)).trim_fmt(),
        "ground errors: planimetric RMS (X and Y together), mean over the flights with its 95 % interval; ratio flight by flight".to_owned(),
    ];
    lines.extend(
        verdict::verdicts(experiment)
            .into_iter()
            .map(|verdict| verdict.sentence),
    );
    lines.extend(verdict::comparisons(experiment));
    lines.push(verdict::pure_noise(experiment));
    lines.extend(verdict::coverage(experiment));
    lines.push(verdict::headline(experiment));
    lines.join("\n") + "\n"
}

/// Describes the flight and its camera.
pub(super) fn setting(experiment: &Experiment) -> String {
    let flight = &experiment.scenario.written.flight;
    let interior = experiment.strip.corrections.interior();
    format!(
        "{} flights of {} frames, seed {}; {} control and {} check points in each; V/H {:.4} 1/s, exposure {} s, travel of the principal point {:.1} µm, its offset at the centroid {:.1} µm; focus shift {} µm, of which the camera is told {} µm",
        experiment.repetitions.len(),
        experiment.strip.frames.len(),
        experiment.seed,
        experiment.control_observations() / 2,
        experiment.check_points(),
        experiment.scenario.vh_per_s(),
        flight.exposure_s,
        1e3 * interior.travel_mm,
        1e3 * interior.centroid_mm,
        experiment.scenario.written.truth.focus_shift_um,
        experiment.scenario.known_focus_shift_um(),
    )
}

fn table(rows: &[Row]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "model",
        "control points\nm",
        "check points\nm",
        "control\nratio to static",
        "check\nratio to static",
        "image RMS\nµm",
        "iterations\nat most",
        "σ0",
    ]);
    for row in rows {
        table.add_row([
            row.label,
            &row.control_m,
            &row.check_m,
            &row.control_ratio,
            &row.check_ratio,
            &row.image_um,
            &row.iterations,
            &row.sigma0,
        ]);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}
