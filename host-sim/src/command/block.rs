//! `block`: a block of aerial images, adjusted with and without the records of its flight.

use std::io;

use fmc_report::block_experiment::summary::Summary;
use fmc_report::block_experiment::{check_point_plot, html, runs_csv, text};
use fmc_report::figure::FigureError;
use fmc_report::limits;
use fmc_simulation::block_experiment::experiment::{BlockError, BlockExperiment, Request};
use fmc_simulation::block_experiment::scenario::Scenario;
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::SimulatedBlockArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &SimulatedBlockArgs) -> Result<(), Failure> {
    let scenario = Scenario::read(&args.scenario)?;
    super::warn_of_distortion(&scenario.written.camera, &scenario.camera);
    let request = Request {
        runs: args.runs,
        seed: args.seed,
    };
    let bar = ProgressBar::new(u64::from(args.runs));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} runs, {eta}") {
        bar.set_style(style);
    }
    let experiment = BlockExperiment::run(scenario, request, || bar.inc(1));
    bar.finish_and_clear();
    let experiment = experiment?;
    let summary = Summary::of(&experiment);
    if let Some(out) = &args.out {
        write(&OutputFolder::create(out)?, &experiment, &summary)?;
    }
    output::write(None, |sink| sink.write_all(text::text(&summary).as_bytes()))?;
    if let Some(out) = &args.out {
        note(format_args!(
            "report: {}",
            out.join("report.html").display()
        ));
    }
    match limits::exceeded(&summary.checks) {
        None => Ok(()),
        Some(names) => Err(Failure::check(format!("beyond its limit: {names}"))),
    }
}

/// Writes report.html, summary.json, runs.csv and the figure.
fn write(
    folder: &OutputFolder,
    experiment: &BlockExperiment,
    summary: &Summary,
) -> Result<(), Failure> {
    let drawing = |error: FigureError| Failure::device_or_io(format!("figure: {error}"));
    let figure = check_point_plot::check_points(experiment).map_err(drawing)?;
    let page = html::page(summary, figure.clone())
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    folder.write("report.html", |sink| sink.write_all(page.as_bytes()))?;
    folder.write("check-points.svg", |sink| sink.write_all(figure.as_bytes()))?;
    folder.write("runs.csv", |sink| {
        runs_csv::write(experiment, sink).map_err(io::Error::other)
    })?;
    folder.write_json("summary.json", summary)
}

impl From<BlockError> for Failure {
    fn from(error: BlockError) -> Self {
        let failure = Self::bad_input(error.to_string());
        match error {
            BlockError::Adjustment { .. } => failure.with_help(
                "more image points, frames or overlap, or smaller standard deviations in [sigma]",
            ),
            BlockError::Exposure { .. } => failure,
        }
    }
}
