//! The status of a camera, for users and programs.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::time::Duration;

use fmc_camera::flight::clock_drift::ClockDrift;
use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::disciplined_clock::WORST_RATE_PPM;
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::findings::LastFinding;
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::io::instruments::counters::{
    AutopilotCounters, InstrumentCounters, ReceiverCounters,
};
use fmc_camera::io::link::after_reset::{AfterReset, FlightAfterReset, WithoutEyes};
use fmc_camera::io::link::message::Status;
use fmc_camera::io::link::records_in_flash::RecordsInFlash;
use serde::Serialize;

use crate::calibration_identity::CalibrationIdentity;
use crate::terminal;

/// Columns of the names in the block of lines.
const NAMES: u16 = 17;

/// Writes the status as a block of lines.
///
/// # Errors
/// Those of the sink.
pub fn write_text(
    status: &Status,
    instruments: Option<&InstrumentCounters>,
    sink: &mut dyn Write,
) -> io::Result<()> {
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
    let mut pairs = vec![
        ("state", status.state.to_string()),
        ("place of stage", place.to_owned()),
        ("calibration", calibration),
        ("encoder", offset),
        (
            "following error",
            format!("{:.2} µm RMS", status.following_rms_um),
        ),
        ("index mark", index_line(status)),
        (
            "triggers",
            format!(
                "{}: {} exposed, {} refused",
                counts.triggers, counts.exposed, counts.refused
            ),
        ),
        ("records", records_line(status)),
        (
            "irregular",
            format!(
                "{} late rounds, {} encoder glitches, {} unexpected edges of the shutter, {} events lost",
                counts.late_ticks, counts.glitches, counts.unexpected_edges, counts.lost_events
            ),
        ),
        ("found", found),
    ];
    if let Some(LastFinding { flag, age_s }) = status.last_finding {
        let last = format!("{}, {age_s:.1} s ago", flag.name());
        pairs.push(("found last", last));
    }
    pairs.push(("clock", clock_line(status.clock_drift)));
    pairs.push(("start", start_line(&status.after_reset)));
    if let Some(counters) = instruments {
        pairs.push(("receiver", receiver_line(&counters.receiver)));
        pairs.push(("autopilot", autopilot_line(&counters.autopilot)));
        if counters.crowded_out > 0 {
            let crowded_out = format!("{} of both without a place", counters.crowded_out);
            pairs.push(("events", crowded_out));
        }
    }
    writeln!(sink, "{}", terminal::pairs(NAMES, pairs))
}

/// Describes the records that are to be fetched.
fn records_line(status: &Status) -> String {
    let kept = format!("{} to be fetched", status.kept);
    match status.in_flash {
        RecordsInFlash::NotKept => kept,
        RecordsInFlash::AllBut(0) => format!("{kept}, all of them in the flash"),
        RecordsInFlash::AllBut(behind) => {
            format!("{kept}, {behind} of them not in the flash yet")
        }
        RecordsInFlash::Worn => {
            format!("{kept}; the flash takes no more, and a loss of the supply would lose them")
        }
    }
}

/// Describes the camera's start after a reset.
fn start_line(start: &AfterReset) -> String {
    let number = format!("number {}: {}", start.boot, start.outcome);
    if start.outcome == FlightAfterReset::Nothing {
        return number;
    }
    let last_round = start.last_round.map(|last| {
        let seconds = Duration::from_micros(last.us()).as_secs_f64();
        format!("last round before it at {seconds:.3} s")
    });
    let records = format!(
        "{} records, {} of frames that it ended, {} damaged",
        start.records, start.unfinished, start.damaged
    );
    let without_eyes = without_eyes(start.without_eyes);
    let parts: Vec<_> = [Some(number), last_round, Some(records), without_eyes]
        .into_iter()
        .flatten()
        .collect();
    parts.join("; ")
}

/// Describes the time in which triggers have left no record; `None` if there was none.
#[must_use]
pub fn without_eyes(time: WithoutEyes) -> Option<String> {
    Some(match time {
        WithoutEyes::NoFlight => return None,
        WithoutEyes::Unknown => {
            "triggers left no record for a time that the camera cannot tell".to_owned()
        }
        WithoutEyes::GoesOn { before_clock_ms } => format!(
            "triggers leave no record: for at most {before_clock_ms} ms until its clock ran, and since then, until the first round"
        ),
        WithoutEyes::AtMost {
            before_clock_ms,
            start_up_ms,
        } => format!(
            "triggers left no record for at most {} ms: {before_clock_ms} ms until its clock ran, {start_up_ms} ms until the first round",
            u64::from(before_clock_ms) + u64::from(start_up_ms)
        ),
    })
}

/// Describes the drift of the clock.
pub(crate) fn clock_line(drift: Option<ClockDrift>) -> String {
    let Some(drift) = drift else {
        return "not measured: no two time pulses a second apart have come".to_owned();
    };
    let ClockDrift {
        drift_ppm,
        corrected_ppm,
    } = drift;
    let corrected_ppm = corrected_ppm.abs();
    let side = if drift_ppm < 0.0 { "slow" } else { "fast" };
    let by_pulses = format!("{:.1} ppm {side} by the time pulses", drift_ppm.abs());
    if drift_ppm.abs() > WORST_RATE_PPM {
        format!(
            "{by_pulses}: above {WORST_RATE_PPM:.0} ppm nothing is corrected, and UTC is missing"
        )
    } else {
        format!("{by_pulses}, {corrected_ppm:.1} ppm corrected")
    }
}

/// Describes the last crossing of the index mark.
fn index_line(status: &Status) -> String {
    let place = status.index_mm.map_or_else(
        || "not crossed".to_owned(),
        |index_mm| format!("last crossed at {index_mm:.4} mm"),
    );
    match status.in_doubt {
        Some(exposures) => format!(
            "{place}; the encoder was {:.2} µm off: principal points in doubt of records {} to {}",
            1e3 * exposures.off_mm,
            exposures.from_sequence,
            exposures.through_sequence()
        ),
        None => place,
    }
}

/// Describes the receiver's wire.
fn receiver_line(counters: &ReceiverCounters) -> String {
    let refused = [
        (counters.truncated, "truncated"),
        (counters.oversized, "oversized"),
        (counters.checksum, "with a wrong checksum"),
        (counters.malformed, "malformed"),
        (counters.no_fix, "without a fix"),
        (counters.simulated_fix, "simulated"),
        (counters.invalid_time, "with an invalid date or time"),
        (counters.before_year_2000, "before the year 2000"),
        (counters.out_of_range, "out of range"),
        (counters.other_talker, "of another talker"),
        (counters.other_position, "of another position"),
    ];
    let bytes = [
        (counters.unexplained_bytes, "in no sentence"),
        (counters.flooded_bytes, "in a flood"),
        (counters.lost_bytes, "lost"),
    ];
    let two = if counters.has_two_receivers() {
        "; two receivers are on the wire"
    } else {
        ""
    };
    format!(
        "{} bytes{}; {} sentences read{}{two}",
        counters.bytes,
        listed(&bytes),
        counters.read,
        listed(&refused)
    )
}

/// Describes the autopilot's wire.
fn autopilot_line(counters: &AutopilotCounters) -> String {
    let refused = [
        (counters.checksum, "with a wrong checksum"),
        (counters.malformed, "malformed"),
        (counters.no_fix, "without a fix"),
        (counters.no_distance, "without a distance"),
        (counters.out_of_range, "out of range"),
        (counters.other_system, "of another system"),
    ];
    let bytes = [
        (counters.unexplained_bytes, "in no message"),
        (counters.flooded_bytes, "in a flood"),
        (counters.lost_bytes, "lost"),
    ];
    let system = counters
        .system
        .map_or(String::new(), |system| format!("; system {system} in use"));
    format!(
        "{} bytes{}; {} messages read{}{system}",
        counters.bytes,
        listed(&bytes),
        counters.read,
        listed(&refused)
    )
}

/// Lists the counts that are not 0, each behind a comma.
fn listed(counts: &[(u32, &str)]) -> String {
    let counts = counts.iter().filter(|(count, _)| *count > 0);
    counts.fold(String::new(), |list, (count, what)| {
        list + &format!(", {count} {what}")
    })
}

/// Writes the status as JSON.
///
/// # Errors
/// Those of the sink.
pub fn write_json(
    status: &Status,
    instruments: Option<&InstrumentCounters>,
    sink: &mut dyn Write,
) -> io::Result<()> {
    let report = StatusReport {
        instruments: instruments.copied(),
        ..StatusReport::of(status)
    };
    serde_json::to_writer_pretty(&mut *sink, &report)?;
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
    /// Number of times each finding was made of the aircraft's instruments, by the name of its
    /// flag.
    findings: BTreeMap<&'static str, u32>,
    /// Name of the last finding, and the time since then.
    last_finding: Option<&'static str>,
    last_finding_age_s: Option<f32>,
    /// Error of the clock's rate by the time pulses, positive if it runs fast; null before it is
    /// measured.
    clock_drift_ppm: Option<f32>,
    /// The part of it by which camera time is corrected.
    clock_corrected_ppm: Option<f32>,
    /// The calibration it was prepared with.
    calibration: Option<CalibrationIdentity>,
    /// Place of the index mark by its last crossing.
    index_mm: Option<f32>,
    /// Exposures in doubt, since the encoder was found wrong at the index mark.
    in_doubt: Option<InDoubt>,
    /// Number of the start, and what it has made of a flight that the reset has ended.
    after_reset: AfterReset,
    /// Copies of the records in flash, which a loss of the supply leaves.
    in_flash: RecordsInFlash,
    /// Counts of the wires of receiver and autopilot; null for a camera without them.
    instruments: Option<InstrumentCounters>,
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
            last_finding: status.last_finding.map(|last| last.flag.name()),
            last_finding_age_s: status.last_finding.map(|last| last.age_s),
            clock_drift_ppm: status.clock_drift.map(|clock| clock.drift_ppm),
            clock_corrected_ppm: status.clock_drift.map(|clock| clock.corrected_ppm),
            calibration: status.calibration.as_ref().map(CalibrationIdentity::of),
            index_mm: status.index_mm,
            in_doubt: status.in_doubt,
            after_reset: status.after_reset,
            in_flash: status.in_flash,
            instruments: None,
        }
    }
}
