//! `mission`: a simulated flight with the camera in the loop.

use std::io::{self, Write};

use fmc_camera::io::link::message::Counters;
use fmc_camera_file::flight_settings::FlightSettingsFile;
use fmc_report::figure::FigureError;
use fmc_report::mission::summary::Summary;
use fmc_report::mission::{
    MissionReport, frames_plot, histogram, html, sigma_figures, text, timeline, truth_csv,
};
use fmc_report::records;
use fmc_simulation::mechanics::Mechanics;
use fmc_simulation::mission::flight_loop::{FlightOptions, Status, fly};
use fmc_simulation::mission::judgement::Judgement;
use fmc_simulation::mission::scenario::MissionScenario;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::cli::MissionArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder, OutputSet};

pub(super) fn run(args: &MissionArgs) -> Result<(), Failure> {
    let settings = args
        .settings
        .as_deref()
        .map(FlightSettingsFile::read)
        .transpose()?;
    let scenario = match &args.scenario {
        Some(path) => MissionScenario::read_with(path, args.exposures, settings)?,
        None => MissionScenario::nominal_with(args.exposures, settings)?,
    };
    super::warn_of_distortion(&scenario.written.camera, &scenario.camera);
    let seed = args.seed.unwrap_or(scenario.seed());
    if let Some(frame) = args.frame
        && frame > scenario.exposures()
    {
        return Err(Failure::bad_input(format!(
            "--frame {frame}: the mission has {} exposures",
            scenario.exposures()
        )));
    }
    let mechanics = Mechanics::seeded(scenario.written.mechanics, seed)
        .map_err(|fault| scenario.fault("mechanics", fault))?;
    let mut device = args.device.open_flying()?;
    device.load_grids(&scenario.grids)?;
    device.prepare(&scenario.camera.parameters(), &scenario.flight_settings())?;
    let options = FlightOptions {
        seed,
        frame: args.frame,
    };
    let line = StatusLine::new(&scenario);
    let flown = fly(&scenario, options, mechanics, device.as_mut(), |status| {
        line.show(status);
    });
    line.bar.finish_and_clear();
    let flown = flown?;
    let link = device.link_counters()?;
    let judgement = Judgement::of(&scenario, &flown);
    let report = MissionReport {
        scenario: &scenario,
        seed,
        flown: &flown,
        judgement: &judgement,
    };
    write(&args.out, &report, link)?;
    output::write(None, |sink| sink.write_all(text::text(&report).as_bytes()))?;
    note(format_args!(
        "report: {}",
        args.out.join("report.html").display()
    ));
    if judgement.passed() {
        Ok(())
    } else {
        let failed: Vec<String> = judgement
            .checks
            .iter()
            .filter(|check| !check.passed)
            .map(|check| format!("{}: {}", check.what, check.found))
            .collect();
        Err(Failure::check(format!(
            "{}: {}",
            scenario.file,
            failed.join("; ")
        )))
    }
}

/// The summary with the counts of the camera's end of its link, if it has one.
#[derive(Serialize)]
struct LinkedSummary {
    #[serde(flatten)]
    summary: Summary,
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<Counters>,
}

/// Writes the report. Figures and summaries are complete before the first file is written.
fn write(
    out: &std::path::Path,
    report: &MissionReport<'_>,
    link: Option<Counters>,
) -> Result<(), Failure> {
    let drawing = |error: FigureError| Failure::device_or_io(format!("figure: {error}"));
    let page = html::page(report)
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    let recorded = report.records();
    let (mut csv, mut json, mut truth) = (Vec::new(), Vec::new(), Vec::new());
    let writing = |name: &str, error: &dyn std::fmt::Display| {
        Failure::device_or_io(format!("{name}: {error}"))
    };
    records::write_csv(&recorded, &mut csv).map_err(|error| writing("records.csv", &error))?;
    let camera = Some(report.scenario.camera.name.as_str());
    records::write_json(camera, &recorded, report.flown.in_doubt, &mut json)
        .map_err(|error| writing("records.json", &error))?;
    truth_csv::write(report, &mut truth).map_err(|error| writing("truth.csv", &error))?;
    let summary = LinkedSummary {
        summary: Summary::of(report),
        link,
    };
    let mut summary =
        serde_json::to_vec_pretty(&summary).map_err(|error| writing("summary.json", &error))?;
    summary.push(b'\n');
    let mut files: Vec<(&str, Vec<u8>)> = vec![
        ("report.html", page.into_bytes()),
        ("records.csv", csv),
        ("records.json", json),
        ("truth.csv", truth),
        ("summary.json", summary),
        (
            "frames.svg",
            frames_plot::frames(report).map_err(drawing)?.into_bytes(),
        ),
        (
            "histogram.svg",
            histogram::histograms(report).map_err(drawing)?.into_bytes(),
        ),
    ];
    if report.flown.trace.is_some() {
        let figure = timeline::timeline(report).map_err(drawing)?;
        files.push(("timeline.svg", figure.into_bytes()));
    }
    for (name, figure) in sigma_figures::of(report).map_err(drawing)? {
        files.push((name, figure.into_bytes()));
    }
    let folder = OutputFolder::create(out)?;
    let mut set = OutputSet::new(&folder);
    for (name, bytes) in files {
        set.write(name, |sink: &mut dyn Write| -> io::Result<()> {
            sink.write_all(&bytes)
        })?;
    }
    set.complete()
}

/// Status line on a terminal: frame, state, V/H, smear, time.
struct StatusLine {
    bar: ProgressBar,
    pixel_mm: f64,
}

impl StatusLine {
    fn new(scenario: &MissionScenario) -> Self {
        let bar = ProgressBar::new(u64::from(scenario.exposures()));
        // A line that is too long for the terminal is cut off at its end, not wrapped.
        if let Ok(style) = ProgressStyle::with_template("{bar:10} {pos}/{len} {wide_msg}") {
            bar.set_style(style);
        }
        Self {
            bar,
            pixel_mm: scenario.camera.sensor.pixel_um / 1000.0,
        }
    }

    fn show(&self, status: &Status) {
        if self.bar.is_hidden() {
            return;
        }
        let smear = status.last_smear_mm.map_or(String::new(), |smear_mm| {
            format!(", smear {:.3} px", smear_mm / self.pixel_mm)
        });
        let left = match self.bar.eta().as_secs() {
            0 => String::new(),
            left_s => format!(", {left_s} s left"),
        };
        self.bar.set_position(status.frames as u64);
        self.bar.set_message(format!(
            "{}, V/H {:.4} 1/s{smear}, {:.1} s flown{left}",
            status.state, status.told_vh_per_s, status.time_s
        ));
    }
}
