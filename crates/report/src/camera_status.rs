//! The status of a camera, for users and programs.

use std::collections::BTreeMap;
use std::io::{self, Write};

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::fault::Fault;
use fmc_camera::io::link::message::Status;
use serde::Serialize;

use crate::calibration_identity::CalibrationIdentity;
use crate::terminal;

/// Columns of the names in the block of lines.
const NAMES: u16 = 17;

/// Writes the status as a block of lines.
///
/// # Errors
/// Those of the sink.
pub fn write_text(status: &Status, sink: &mut dyn Write) -> io::Result<()> {
    let counts = status.counts;
    let place = if status.is_place_lost {
        "lost: in standby, say with `host-sim camera referenced` where the stage stands"
    } else {
        "known"
    };
    let calibration = status.calibration.map_or_else(
        || "not named".to_owned(),
        |calibration| calibration.to_string(),
    );
    let offset = status.offset_mm.map_or_else(
        || "not read".to_owned(),
        |offset_mm| format!("{offset_mm:.4} mm from its zero"),
    );
    let found: Vec<String> = status
        .findings
        .iter()
        .filter(|(_, count)| *count > 0)
        .map(|(flag, count)| format!("{} {}", count, flag.name()))
        .collect();
    let found = if found.is_empty() {
        "nothing about the instruments".to_owned()
    } else {
        found.join(", ")
    };
    let pairs = [
        ("state", status.state.to_string()),
        ("place of stage", place.to_owned()),
        ("calibration", calibration),
        ("encoder", offset),
        (
            "following error",
            format!("{:.2} µm RMS", status.following_rms_um),
        ),
        (
            "triggers",
            format!(
                "{}: {} exposed, {} refused",
                counts.triggers, counts.exposed, counts.refused
            ),
        ),
        ("records", format!("{} to be fetched", status.kept)),
        (
            "irregular",
            format!(
                "{} late rounds, {} encoder glitches, {} unexpected edges of the shutter, {} events lost",
                counts.late_ticks, counts.glitches, counts.unexpected_edges, counts.lost_events
            ),
        ),
        ("found", found),
    ];
    writeln!(sink, "{}", terminal::pairs(NAMES, pairs))
}

/// Writes the status as JSON.
///
/// # Errors
/// Those of the sink.
pub fn write_json(status: &Status, sink: &mut dyn Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *sink, &StatusReport::of(status))?;
    writeln!(sink)
}

/// Status of a camera; units are in the names.
#[derive(Debug, Serialize)]
struct StatusReport {
    state: &'static str,
    fault_code: Option<u8>,
    fault: Option<&'static str>,
    is_place_lost: bool,
    offset_mm: Option<f32>,
    following_rms_um: f32,
    records_kept: u32,
    triggers: u32,
    exposed: u32,
    refused: u32,
    late_rounds: u32,
    encoder_glitches: u32,
    unexpected_edges: u32,
    lost_events: u32,
    /// How often each was found of the aircraft's instruments, by the name of its flag.
    findings: BTreeMap<&'static str, u32>,
    /// The calibration it was prepared with.
    calibration: Option<CalibrationIdentity>,
}

impl StatusReport {
    fn of(status: &Status) -> Self {
        let fault = match status.state {
            State::Degraded(fault) | State::Fault(fault) => Some(fault),
            _ => None,
        };
        let counts = status.counts;
        Self {
            state: status.state.name(),
            fault_code: fault.map(Fault::code),
            fault: fault.map(Fault::name),
            is_place_lost: status.is_place_lost,
            offset_mm: status.offset_mm,
            following_rms_um: status.following_rms_um,
            records_kept: status.kept,
            triggers: counts.triggers,
            exposed: counts.exposed,
            refused: counts.refused,
            late_rounds: counts.late_ticks,
            encoder_glitches: counts.glitches,
            unexpected_edges: counts.unexpected_edges,
            lost_events: counts.lost_events,
            findings: status
                .findings
                .iter()
                .map(|(flag, count)| (flag.name(), count))
                .collect(),
            calibration: status.calibration.as_ref().map(CalibrationIdentity::of),
        }
    }
}
