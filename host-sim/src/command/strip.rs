//! `strip`: a simulated strip of frames over ground control.

use std::io;

use fmc_report::figure::FigureError;
use fmc_report::strip_experiment::summary::Summary;
use fmc_report::strip_experiment::{
    convergence_plot, ground_error_plot, html, plan, repetitions_csv, text,
};
use fmc_simulation::strip_experiment::experiment::Experiment;
use fmc_simulation::strip_experiment::scenario::Scenario;
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::StripArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &StripArgs) -> Result<(), Failure> {
    let scenario = Scenario::read(&args.scenario)?;
    super::warn_of_distortion(&scenario.written.camera, &scenario.camera);
    let folder = OutputFolder::create(&args.out)?;
    let without_shift = scenario.without_focus_shift();
    let flights = if without_shift.is_some() { 2 } else { 1 };
    let bar = ProgressBar::new(flights * u64::from(args.repetitions));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} repetitions, {eta}") {
        bar.set_style(style);
    }
    let run = |scenario| Experiment::run(scenario, args.seed, args.repetitions, || bar.inc(1));
    let flights = run(scenario).and_then(|experiment| {
        let without_shift = without_shift.map(run).transpose()?;
        Ok((experiment, without_shift))
    });
    bar.finish_and_clear();
    let (experiment, without_shift) = flights?;
    write_report(&folder, &experiment, without_shift.as_ref())?;
    output::write(None, |sink| {
        sink.write_all(text::text(&experiment, without_shift.as_ref()).as_bytes())
    })?;
    note(format_args!(
        "report: {}",
        folder.path().join("report.html").display()
    ));
    Ok(())
}

/// Writes report.html, summary.json, repetitions.csv and the figures.
fn write_report(
    folder: &OutputFolder,
    experiment: &Experiment,
    without_shift: Option<&Experiment>,
) -> Result<(), Failure> {
    let drawing = |error: FigureError| Failure::device_or_io(format!("figure: {error}"));
    let page = html::page(experiment, without_shift)
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    folder.write("report.html", |sink| sink.write_all(page.as_bytes()))?;
    for (name, svg) in [
        ("convergence.svg", convergence_plot::convergence(experiment)),
        (
            "ground-error.svg",
            ground_error_plot::ground_errors(experiment),
        ),
        ("plan.svg", plan::plan(experiment)),
    ] {
        let svg = svg.map_err(drawing)?;
        folder.write(name, |sink| sink.write_all(svg.as_bytes()))?;
    }
    folder.write("repetitions.csv", |sink| {
        repetitions_csv::write(experiment, sink).map_err(io::Error::other)
    })?;
    folder.write_json("summary.json", &Summary::of(experiment, without_shift))
}
