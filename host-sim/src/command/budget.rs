//! `budget`: the cost of each source of error for a camera.

use fmc_report::budget::{dots, page, summary, table};
use fmc_simulation::budget::assumptions::{Assumptions, Stated};
use fmc_simulation::budget::result::Budget;
use fmc_simulation::budget::run;

use crate::cli::BudgetArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &BudgetArgs) -> Result<(), Failure> {
    let (camera, _) = super::read_camera(&args.camera, run::WITHOUT_GRIDS)?;
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
    let stated = Stated {
        height_m: args.height_m,
        focus_um: args.focus_um,
        vh_error_percent: args.vh_error_percent,
        relief_percent: args.relief_percent,
        drift_deg: args.drift_deg,
        rate_deg_s: args.rate_deg_s,
        encoder_um: args.encoder_um,
        timing_ms: args.timing_ms,
    };
    stated.into()
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
