//! `campaign`: every fault in every round of a frame cycle, and pairs of faults.

use std::io;
use std::sync::{Mutex, PoisonError};

use fmc_report::campaign::summary::{Summary, scenario_name};
use fmc_report::campaign::{html, rows_csv, runs_csv, text};
use fmc_report::limits;
use fmc_simulation::campaign::outcome::Outcome;
use fmc_simulation::campaign::plan::{Block, Plan, Request};
use fmc_simulation::campaign::repeat;
use fmc_simulation::campaign::results::Results;
use fmc_simulation::campaign::run;
use fmc_simulation::campaign::world::{CAMERA_TEXT, OriginalFlight, World};
use fmc_simulation::mission::fault::InjectedFault;
use fmc_simulation::mission::rig_camera::RigCamera;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::prelude::*;

use self::progress::{Header, Progress};
use crate::cli::CampaignArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder, OutputSet};

mod progress;

/// Name of the camera file that the scenarios of the findings name.
const CAMERA: &str = "campaign-camera.toml";

pub(super) fn run(args: &CampaignArgs) -> Result<(), Failure> {
    let request = Request {
        seed: args.seed,
        pairs: args.pairs,
        quick: args.quick,
        allowed: args.allowed,
    };
    let mut faults = args.fault.clone();
    faults.sort_unstable();
    faults.dedup();
    let plan = Plan::new(request, &faults);
    let folder = OutputFolder::create(&args.out)?;
    let progress = Progress::open(folder.path(), &header(&plan, &faults)?)?;
    let outcomes = flown(&plan, progress)?;
    let results =
        Results::of(&plan, &outcomes).map_err(|error| Failure::device_or_io(error.to_string()))?;
    let summary = Summary::of(request, &results);
    write(&folder, &plan, &outcomes, &results, &summary)?;
    output::write(None, |sink| sink.write_all(text::text(&summary).as_bytes()))?;
    note(format_args!(
        "report: {}",
        args.out.join("report.html").display()
    ));
    match limits::exceeded(&summary.checks) {
        None => Ok(()),
        Some(names) => Err(Failure::check(format!("beyond its limit: {names}"))),
    }
}

/// Returns what the results depend on: a campaign goes on only where all of it is the same.
fn header(plan: &Plan, faults: &[InjectedFault]) -> Result<Header, Failure> {
    let names: Vec<&str> = faults.iter().map(|fault| fault.name()).collect();
    let faults = if names.is_empty() {
        "all".to_owned()
    } else {
        names.join(" ")
    };
    Ok(Header(vec![
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("program", program()?),
        ("cases", format!("{:08x}", plan.check_sum())),
        ("seed", plan.request.seed.to_string()),
        ("pairs", plan.request.pairs.to_string()),
        ("quick", plan.request.quick.to_string()),
        ("allowed", plan.request.allowed.to_string()),
        ("faults", faults),
    ]))
}

/// Returns the check sum of this program: what another build has found is not mixed with its own.
fn program() -> Result<String, Failure> {
    let read = || std::fs::read(std::env::current_exe()?);
    let bytes = read().map_err(|error| {
        Failure::device_or_io(format!("this program's own file cannot be read: {error}"))
    })?;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    Ok(format!("{:08x}", crc.checksum(&bytes)))
}

/// Flies the blocks that are not there yet, on all cores. Returns the outcomes of all, in order.
fn flown(plan: &Plan, progress: Progress) -> Result<Vec<Vec<Outcome>>, Failure> {
    let blocks = plan.blocks();
    let bar = ProgressBar::new(blocks.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} blocks, {eta}") {
        bar.set_style(style);
    }
    let starts = World::ALL
        .into_par_iter()
        .map(|world| {
            OriginalFlight::fly(world, plan.request.seed, RigCamera::default())
                .map_err(|error| Failure::device_or_io(error.to_string()))
        })
        .collect::<Result<Vec<_>, Failure>>()?;
    let missing: Vec<Block> = blocks
        .iter()
        .copied()
        .filter(|block| !progress.has(*block, plan.runs(*block).len()))
        .collect();
    bar.inc((blocks.len() - missing.len()) as u64);
    let progress = Mutex::new(progress);
    let done = missing.into_par_iter().try_for_each(|block| {
        let outcomes = block_flown(plan, block, &starts)?;
        let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
        bar.inc(1);
        progress.add(block, outcomes)
    });
    bar.finish_and_clear();
    done?;
    let mut progress = progress
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    Ok(blocks
        .into_iter()
        .map(|block| progress.take(block))
        .collect())
}

fn block_flown(
    plan: &Plan,
    block: Block,
    starts: &[OriginalFlight<RigCamera>],
) -> Result<Vec<Outcome>, Failure> {
    let mut outcomes = Vec::new();
    for one in plan.runs(block) {
        let start = World::ALL.iter().zip(starts);
        let mut start = start.filter(|(world, _)| **world == one.world);
        if let Some((_, start)) = start.next() {
            let flown = run::fly(start, one.tick, &one.faults, plan.request.allowed);
            let outcome = flown.map_err(|error| {
                Failure::device_or_io(format!("{}: {error}", one.description()))
            })?;
            outcomes.extend(outcome);
        }
    }
    Ok(outcomes)
}

/// Writes the report, and the files that repeat the findings; they appear together.
fn write(
    folder: &OutputFolder,
    plan: &Plan,
    outcomes: &[Vec<Outcome>],
    results: &Results,
    summary: &Summary,
) -> Result<(), Failure> {
    let page = html::page(summary)
        .map_err(|error| Failure::device_or_io(format!("report.html: {error}")))?;
    let mut files = OutputSet::new(folder);
    files.write("report.html", |sink| sink.write_all(page.as_bytes()))?;
    files.write_json("summary.json", summary)?;
    files.write("heat-map.csv", |sink| {
        rows_csv::write(results, sink).map_err(io::Error::other)
    })?;
    files.write("runs.csv", |sink| {
        runs_csv::write(plan, outcomes, sink).map_err(io::Error::other)
    })?;
    if !results.findings.is_empty() {
        files.write(CAMERA, |sink| sink.write_all(CAMERA_TEXT.as_bytes()))?;
    }
    for (finding, number) in results.findings.iter().zip(1..) {
        let text = repeat::scenario_text(&finding.run, plan.request.seed, CAMERA);
        files.write(&scenario_name(number), |sink| {
            sink.write_all(text.as_bytes())
        })?;
    }
    files.complete()
}
