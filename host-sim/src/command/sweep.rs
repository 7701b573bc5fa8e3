//! `sweep`: the five coefficients over V/H and exposure time.

use std::io;

use fmc_camera::flight::camera::FrameError;
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::{MechanismName, Per, Strategy};
use fmc_reference::exposure::FocusFormula;
use fmc_reference::strict::{Reading, Weight};
use fmc_report::sweep::{coefficient_plot, coefficients_csv, page, summary, table};
use fmc_report::wording;
use fmc_simulation::sweep::options::SweepOptions;
use fmc_simulation::sweep::result::Sweep;
use fmc_simulation::sweep::run::{Plan, SweepError, steps};
use indicatif::{ProgressBar, ProgressStyle};

use crate::cli::{FocusSignName, ReadingName, RegressOn, StrategyName, SweepArgs, WeightName};
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &SweepArgs) -> Result<(), Failure> {
    let (mut camera, _) = super::read_camera(&args.camera, super::FIVE_KNOW_NO_GRIDS)?;
    if let Some(strategy) = args.strategy {
        if camera.fmc.mechanism == MechanismName::Tdi {
            return Err(Failure::bad_input(format!(
                "--strategy: {} has mechanism = \"tdi\", which has no run-up",
                args.camera.display()
            )));
        }
        camera.fmc.strategy = Some(match strategy {
            StrategyName::Centred => Strategy::Centred,
            StrategyName::FromRest => Strategy::FromRest,
        });
    }
    // An exposure that the camera refuses must leave no folder behind.
    let plan = Plan::new(&camera, options(args)).map_err(|error| refused(&error, args))?;
    let folder = OutputFolder::create(&args.out)?;
    let bar = progress();
    let sweep = plan
        .sweep(|| bar.inc(1))
        .map_err(|error| refused(&error, args))?;
    bar.finish_and_clear();
    write_report(&folder, &sweep)?;
    output::write(None, |sink| sink.write_all(table::text(&sweep).as_bytes()))?;
    note(format_args!(
        "report: {}",
        folder.path().join("report.html").display()
    ));
    Ok(())
}

fn options(args: &SweepArgs) -> SweepOptions {
    SweepOptions {
        noise_mm: args.noise_um / 1000.0,
        focus_shift_mm: args.focus_shift_um / 1000.0,
        focus_formula: match args.focus_sign {
            FocusSignName::Physical => FocusFormula::Physical,
            FocusSignName::Printed => FocusFormula::Printed,
        },
        seed: args.seed,
        weight: match args.weight {
            WeightName::Exposure => Weight::Exposure,
            WeightName::ArcLength => Weight::ArcLength,
        },
        reading: match args.reading {
            ReadingName::Consistent => Reading::Consistent,
            ReadingName::Literal => Reading::Literal,
        },
        tied: args.tie,
        regressor: match args.regress_on {
            RegressOn::Travel => Per::Travel,
            RegressOn::Centroid => Per::Centroid,
        },
    }
}

fn progress() -> ProgressBar {
    let bar = ProgressBar::new(steps() as u64);
    if let Ok(style) =
        ProgressStyle::with_template("simulating {wide_bar} {pos}/{len} exposures, {eta}")
    {
        bar.set_style(style);
    }
    bar
}

/// Turns a refusal of the camera into a failure, with the option or the key that caused it.
fn refused(error: &SweepError, args: &SweepArgs) -> Failure {
    let file = args.camera.display();
    let SweepError::Frame { exposure, error } = error else {
        return Failure::bad_input(format!("{file}: {error}"));
    };
    let grid = format!(
        "the sweep takes V/H 0.05 to 0.17 1/s and 1/700 to 1/100 s; at V/H {} 1/s, {}: {error}",
        exposure.vh_per_s,
        wording::exposure(exposure.exposure_s)
    );
    Failure::bad_input(match error {
        FrameError::OutOfRange(range) => match range.quantity {
            Quantity::VhPerS => format!("{file}: [limits] vh_per_s: {grid}"),
            Quantity::ExposureS => format!("{file}: [limits] exposure_s: {grid}"),
            Quantity::FocusShiftUm => {
                format!(
                    "--focus-shift-um with the run-out: {range} (1 % of the distances of {file})"
                )
            }
            _ => format!("{file}: {grid}"),
        },
        FrameError::Stroke(_) => format!("{file}: [fmc] stroke_mm is too short: {grid}"),
        FrameError::Speed { .. } => format!("{file}: [fmc] max_speed_mm_s is too small: {grid}"),
        FrameError::NotFitted => format!("{file}: {error}"),
        FrameError::Time { .. } => format!("{file}: {grid}"),
    })
}

/// Writes report.html, summary.json, coefficients.csv and the figure.
fn write_report(folder: &OutputFolder, sweep: &Sweep) -> Result<(), Failure> {
    let failed = |what: &str, error: &dyn std::fmt::Display| {
        Failure::device_or_io(format!("{what}: {error}"))
    };
    folder.write_json("summary.json", &summary::Summary::of(sweep))?;
    folder.write("coefficients.csv", |sink| {
        coefficients_csv::write(sweep, sink).map_err(io::Error::other)
    })?;
    let svg = coefficient_plot::svg(sweep).map_err(|error| failed("coefficients.svg", &error))?;
    let png = coefficient_plot::png(sweep).map_err(|error| failed("coefficients.png", &error))?;
    folder.write("coefficients.svg", |sink| sink.write_all(svg.as_bytes()))?;
    folder.write("coefficients.png", |sink| sink.write_all(&png))?;
    let page = page::page(sweep).map_err(|error| failed("report.html", &error))?;
    folder.write("report.html", |sink| sink.write_all(page.as_bytes()))
}
