//! The strip experiment as a self-contained page: `report.html`.

use askama::Template;
use fmc_simulation::strip_experiment::experiment::Experiment;

use super::rows::{Row, rows};
use super::verdict;
use super::{convergence_plot, ground_error_plot, plan, text};
use crate::page::{PageError, inline};

#[derive(Template)]
#[template(path = "strip.html")]
struct Page {
    scenario: String,
    camera: String,
    headline: String,
    setting: String,
    rows: Vec<Row>,
    verdicts: Vec<String>,
    comparisons: Vec<String>,
    noise_floor: String,
    without_shift: Vec<String>,
    without_shift_rows: Vec<Row>,
    pure_noise: String,
    coverage: Vec<String>,
    observations: String,
    convergence: String,
    ground_errors: String,
    plan: String,
}

/// Writes the whole experiment as one HTML page, with the figures in it; beside it the flight
/// without focus shift, if the flight has one.
///
/// # Errors
/// [`PageError`] if a figure cannot be drawn.
pub fn page(
    experiment: &Experiment,
    without_shift: Option<&Experiment>,
) -> Result<String, PageError> {
    let page = Page {
        scenario: experiment.scenario.written.name.clone(),
        camera: experiment.scenario.camera.name.clone(),
        headline: verdict::headline(experiment),
        setting: text::setting(experiment),
        rows: rows(experiment),
        verdicts: verdict::verdicts(experiment)
            .into_iter()
            .map(|verdict| verdict.sentence)
            .collect(),
        comparisons: verdict::comparisons(experiment),
        noise_floor: verdict::noise_floor(experiment),
        without_shift: without_shift.map_or_else(Vec::new, |without| {
            verdict::without_focus_shift(experiment, without)
        }),
        without_shift_rows: without_shift.map_or_else(Vec::new, rows),
        pure_noise: verdict::pure_noise(experiment),
        coverage: verdict::coverage(experiment),
        observations: observations(experiment),
        convergence: inline(convergence_plot::convergence(experiment)?),
        ground_errors: inline(ground_error_plot::ground_errors(experiment)?),
        plan: inline(plan::plan(experiment)?),
    };
    Ok(page.render()?)
}

/// Lists the standard deviations of all observations.
fn observations(experiment: &Experiment) -> String {
    let written = &experiment.scenario.written;
    let each = |sigmas: [Option<f64>; 3], unit: &str| match sigmas {
        [Some(a), Some(b), Some(c)] => format!("{a}, {b}, {c} {unit}"),
        _ => "free".to_owned(),
    };
    format!(
        "image coordinates {} µm; control and check points {} m; position {}; pitch, roll, yaw {}",
        written.image.sigma_um,
        written.control.sigma_m,
        each(written.pos.position_sigma_m.each(), "m"),
        each(written.pos.attitude_sigma_deg.each(), "°"),
    )
}
