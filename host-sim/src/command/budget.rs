//! `budget`: the cost of each source of error for a camera.

use fmc_report::budget::{dots, page, summary, table};
use fmc_simulation::budget::assumptions::Assumptions;
use fmc_simulation::budget::result::Budget;
use fmc_simulation::budget::run;

use crate::cli::BudgetArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &BudgetArgs) -> Result<(), Failure> {
    let (camera, _) = super::read_camera(
        &args.camera,
        "its shares are those of the polynomial's terms, and a grid has none among them",
    )?;
    let budget = run::budget(&camera, assumptions(args))
        .map_err(|error| Failure::bad_input(format!("{}: {error}", args.camera.display())))?;
    if let Some(out) = &args.out {
        let folder = OutputFolder::create(out)?;
        write_report(&folder, &budget)?;
        note(format_args!(
            "report: {}",
            folder.path().join("report.html").display()
        ));
    }
    output::write(None, |sink| sink.write_all(table::text(&budget).as_bytes()))
}

fn assumptions(args: &BudgetArgs) -> Assumptions {
    Assumptions {
        height_m: args.height_m,
        focus_mm: args.focus_um / 1000.0,
        vh_error: args.vh_error_percent / 100.0,
        relief: args.relief_percent / 100.0,
        drift_deg: args.drift_deg,
        rate_deg_s: args.rate_deg_s,
        encoder_mm: args.encoder_um / 1000.0,
        timing_s: args.timing_ms / 1000.0,
    }
}

/// Writes report.html, summary.json and the figure.
fn write_report(folder: &OutputFolder, budget: &Budget) -> Result<(), Failure> {
    let failed = |what: &str, error: &dyn std::fmt::Display| {
        Failure::device_or_io(format!("{what}: {error}"))
    };
    folder.write_json("summary.json", &summary::Summary::of(budget))?;
    let svg = dots::svg(budget).map_err(|error| failed("budget.svg", &error))?;
    let png = dots::png(budget).map_err(|error| failed("budget.png", &error))?;
    folder.write("budget.svg", |sink| sink.write_all(svg.as_bytes()))?;
    folder.write("budget.png", |sink| sink.write_all(&png))?;
    let page = page::page(budget).map_err(|error| failed("report.html", &error))?;
    folder.write("report.html", |sink| sink.write_all(page.as_bytes()))
}
