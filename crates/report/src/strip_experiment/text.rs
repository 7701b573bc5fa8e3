//! The strip experiment as text for a terminal or a pipe.

use fmc_simulation::strip_experiment::experiment::Experiment;

use super::rows::{Row, rows};
use super::verdict;
use crate::terminal::{self, numbers, words};

/// Writes the scenario, a row per model, and the conclusions from the intervals; beside them those
/// of the flight without focus shift, if the flight has one.
#[must_use]
pub fn text(experiment: &Experiment, without_shift: Option<&Experiment>) -> String {
    let mut lines = vec![
        format!("scenario: {}", experiment.scenario.written.name),
        setting(experiment),
        table(rows(experiment)),
        "ground errors: planimetric RMS (X and Y together), mean over the repetitions ± half of its 95 % interval; ratio repetition by repetition".to_owned(),
    ];
    lines.extend(
        verdict::verdicts(experiment)
            .into_iter()
            .map(|verdict| verdict.sentence),
    );
    lines.extend(verdict::comparisons(experiment));
    lines.push(verdict::noise_floor(experiment));
    if let Some(without) = without_shift {
        lines.extend(verdict::without_focus_shift(experiment, without));
    }
    lines.push(verdict::pure_noise(experiment));
    lines.extend(verdict::coverage(experiment));
    lines.push(verdict::headline(experiment));
    lines.join("\n") + "\n"
}

/// Describes the strip and its camera.
pub(super) fn setting(experiment: &Experiment) -> String {
    let flight = &experiment.scenario.written.flight;
    let interior = experiment.strip.corrections.interior();
    format!(
        "{} repetitions of {} frames, seed {}; {} control and {} check points in each; V/H {:.4} 1/s, exposure {} s, travel of the principal point {:.1} µm, its offset at the centroid {:.1} µm; focus shift {} µm, of which the camera is told {} µm",
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

/// Writes a row per model: errors and image residuals, below the errors their ratios.
fn table(rows: Vec<Row>) -> String {
    let columns = [
        words("model"),
        numbers("control points\nm\nratio to static"),
        numbers("check points\nm\nratio to static"),
        numbers("image\nRMS\nµm"),
        numbers("iterations\nat most"),
        numbers("σ0"),
    ];
    let rows = rows.into_iter().map(|row| {
        [
            row.label.to_owned(),
            format!("{}\n{}", row.control_m.short, row.control_ratio.short),
            format!("{}\n{}", row.check_m.short, row.check_ratio.short),
            row.image_um,
            row.iterations,
            row.sigma0,
        ]
    });
    terminal::table(columns, rows)
}
