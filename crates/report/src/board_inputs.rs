//! The lines of a board, for its bring-up.

use std::io::{self, Write};

use fmc_camera::flight::bring_up::{EdgeCounts, LineLevels, Trial, TrialReport};
use fmc_camera::io::link::message::Inputs;

use crate::camera_status::clock_line;
use crate::terminal;

/// Columns of the names in the block of lines.
const NAMES: u16 = 17;

/// Writes everything as a block of lines.
///
/// # Errors
/// Those of the sink.
pub fn write_text(inputs: &Inputs, sink: &mut dyn Write) -> io::Result<()> {
    let mut pairs = Vec::new();
    if let Some(lines) = &inputs.lines {
        pairs.push(("high", levels(lines, true)));
        pairs.push(("low", levels(lines, false)));
    }
    let closed = match (inputs.limit_low, inputs.limit_high) {
        (false, false) => "none is closed",
        (true, false) => "the one at the negative end is closed, or its wire is broken",
        (false, true) => "the one at the positive end is closed, or its wire is broken",
        (true, true) => "both are closed, or their wires are broken",
    };
    pairs.push(("limit switches", closed.to_owned()));
    let supply = if inputs.supply_low { "low" } else { "good" };
    pairs.push(("supply", supply.to_owned()));
    pairs.push(("edges", edges(&inputs.edges)));
    pairs.push(("encoder", position(inputs.offset_mm)));
    pairs.push(("clock", clock_line(inputs.clock_drift)));
    if let Some(trial) = &inputs.trial {
        pairs.push(("last trial", trial_line(trial)));
    }
    writeln!(sink, "{}", terminal::pairs(NAMES, pairs))
}

/// Writes everything as JSON, by the names of the link's fields.
///
/// # Errors
/// Those of the sink.
pub fn write_json(inputs: &Inputs, sink: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *sink, inputs)?;
    writeln!(sink)
}

/// Writes what a trial has led to.
///
/// # Errors
/// Those of the sink.
pub fn write_trial(before: &Inputs, after: &Inputs, sink: &mut dyn Write) -> io::Result<()> {
    if let Some(trial) = &after.trial {
        writeln!(sink, "{}", trial_line(trial))?;
    }
    let since = |of: fn(&EdgeCounts) -> u32| of(&after.edges).wrapping_sub(of(&before.edges));
    let new = EdgeCounts {
        trigger: since(|edges| edges.trigger),
        time_pulse: since(|edges| edges.time_pulse),
        shutter_opened: since(|edges| edges.shutter_opened),
        shutter_closed: since(|edges| edges.shutter_closed),
        index: since(|edges| edges.index),
        lost: since(|edges| edges.lost),
    };
    writeln!(sink, "edges meanwhile: {}", edges(&new))
}

/// Names of the lines that are high, or low.
fn levels(lines: &LineLevels, high: bool) -> String {
    let names: Vec<&str> = [
        (lines.trigger, "trigger"),
        (lines.time_pulse, "time pulse"),
        (lines.shutter_opened, "shutter opened"),
        (lines.shutter_closed, "shutter closed"),
        (lines.index, "index mark"),
        (lines.encoder_a, "encoder A"),
        (lines.encoder_b, "encoder B"),
        (lines.limit_low, "limit switch -"),
        (lines.limit_high, "limit switch +"),
        (lines.brake, "brake"),
    ]
    .into_iter()
    .filter_map(|(level, name)| (level == high).then_some(name))
    .collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}

fn edges(edges: &EdgeCounts) -> String {
    format!(
        "{} trigger, {} time pulse, {} shutter opened, {} shutter closed, {} index mark, {} lost",
        edges.trigger,
        edges.time_pulse,
        edges.shutter_opened,
        edges.shutter_closed,
        edges.index,
        edges.lost
    )
}

fn position(offset_mm: Option<f32>) -> String {
    offset_mm.map_or_else(
        || "not read".to_owned(),
        |offset_mm| format!("{offset_mm:.4} mm from its zero"),
    )
}

/// A trial in a line.
fn trial_line(report: &TrialReport) -> String {
    let trial = match report.trial {
        Trial::Jog { way_um } => format!(
            "jog of {way_um} µm, {:.1} µm behind at most",
            report.largest_error_um
        ),
        Trial::Duty { duty, time_s } => format!("duty {duty} for {time_s} s"),
        Trial::Shutter { exposure_s } => format!("shutter open for {exposure_s} s"),
    };
    let end = report
        .end
        .map_or_else(|| "under way".to_owned(), |end| end.to_string());
    let moved = match (report.from_mm, report.to_mm) {
        (Some(from_mm), Some(to_mm)) => {
            format!(", moved by {:+.1} µm", 1e3 * (to_mm - from_mm))
        }
        _ => String::new(),
    };
    format!("{trial}: {end}{moved}")
}
