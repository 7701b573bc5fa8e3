//! `statistics`: the coverage of σ over random missions.

use std::io;

use fmc_report::figure::FigureError;
use fmc_report::limits;
use fmc_report::mission::{coverage_plot, smear_plot};
use fmc_report::statistics::summary::Summary;
use fmc_report::statistics::{html, missions_csv, text};
use fmc_simulation::judge::quantity::Quantity;
use fmc_simulation::mechanics::Mechanics;
use fmc_simulation::mission::flight_loop::{FlightOptions, fly};
use fmc_simulation::mission::flown::Flown;
use fmc_simulation::statistics::draw::DrawnMission;
use fmc_simulation::statistics::summary::{Request, Statistics, StatisticsError};
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::StatisticsArgs;
use crate::device::{FlyingDevice as _, InProcess};
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &StatisticsArgs) -> Result<(), Failure> {
    let request = Request {
        missions: args.missions,
        seed: args.seed,
        faults: args.faults.number(),
    };
    let bar = ProgressBar::new(u64::from(args.missions));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} missions, {eta}") {
        bar.set_style(style);
    }
    let statistics = Statistics::run(request, flown, || bar.inc(1));
    bar.finish_and_clear();
    let statistics = statistics.map_err(|error| match error {
        StatisticsError::Flight { .. } => Failure::device_or_io(error.to_string()),
        StatisticsError::Draw { .. } => Failure::bad_input(error.to_string()),
    })?;
    let summary = Summary::of(&statistics);
    if let Some(out) = &args.out {
        write(&OutputFolder::create(out)?, &statistics, &summary)?;
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

/// Flies a mission in this process.
fn flown(mission: &DrawnMission) -> Result<Flown, String> {
    let scenario = &mission.scenario;
    let seed = scenario.seed();
    let mechanics = Mechanics::seeded(scenario.written.mechanics, seed)?;
    let mut device = InProcess::default();
    device
        .prepare(&scenario.camera.parameters(), &scenario.flight_settings())
        .map_err(|error| error.to_string())?;
    let options = FlightOptions { seed, frame: None };
    fly(scenario, options, mechanics, &mut device, |_| {}).map_err(|error| error.to_string())
}

/// Writes the report, and the files that repeat the cases.
fn write(folder: &OutputFolder, statistics: &Statistics, summary: &Summary) -> Result<(), Failure> {
    let drawing = |error: FigureError| Failure::device_or_io(format!("figure: {error}"));
    let mut figures = Vec::new();
    for quantity in Quantity::ALL {
        let ratios = statistics.ratios(quantity);
        if !ratios.is_empty() {
            let figure = coverage_plot::coverage(quantity.name(), &ratios).map_err(drawing)?;
            figures.push((quantity.file_name(), figure));
        }
    }
    let smears = statistics.smears();
    if !smears.is_empty() {
        figures.push(("smear.svg", smear_plot::smear(&smears).map_err(drawing)?));
    }
    let inlined = figures.iter().map(|(_, figure)| figure.clone()).collect();
    let page = html::page(summary, inlined)
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    figures.push(("report.html", page));
    for (name, text) in figures {
        folder.write(name, |sink| sink.write_all(text.as_bytes()))?;
    }
    folder.write("summary.json", |sink| {
        serde_json::to_writer_pretty(&mut *sink, summary)?;
        writeln!(sink)
    })?;
    folder.write("missions.csv", |sink| {
        missions_csv::write(statistics, sink).map_err(io::Error::other)
    })?;
    for mission in &statistics.files {
        let number = mission.number;
        folder.write(&DrawnMission::scenario_name(number), |sink| {
            sink.write_all(mission.scenario_text.as_bytes())
        })?;
        folder.write(&DrawnMission::camera_name(number), |sink| {
            sink.write_all(mission.camera_text.as_bytes())
        })?;
    }
    Ok(())
}
