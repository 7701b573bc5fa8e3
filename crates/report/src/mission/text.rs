//! The mission as text for a terminal or a pipe.

use std::fmt::Write;

use super::MissionReport;
use super::summary::Summary;
use crate::wording;

/// Writes the mission in a few lines.
#[must_use]
pub fn text(report: &MissionReport<'_>) -> String {
    let summary = Summary::of(report);
    let mut out = String::new();
    let mut line = |text: String| {
        // Writing to a string does not fail.
        let _ = writeln!(out, "{text}");
    };
    line(format!("{}: {}", summary.scenario, headline(&summary)));
    line(setting(report, &summary));
    for check in &summary.checks {
        let mark = if check.passed { "passed" } else { "FAILED" };
        line(format!("{mark}: {}: {}", check.what, check.found));
    }
    line(format!(
        "principal point {:.4} px RMS, {:.4} px at most; smear {:.4} px RMS, {:.4} px at most, of which compensation {:.4} px RMS",
        summary.pp_error_px.rms,
        summary.pp_error_px.max,
        summary.smear_px.rms,
        summary.smear_px.max,
        summary.compensation_smear_px.rms
    ));
    let flags = summary.flags.iter().map(|flag| {
        let frames = wording::counted(flag.frames, "frame");
        format!("{} in {frames}", flag.name)
    });
    let flags: Vec<String> = flags.collect();
    if !flags.is_empty() {
        line(format!("flags: {}", flags.join(", ")));
    }
    if let Some(calibration) = report.calibration() {
        line(format!("calibration {calibration}"));
    }
    line(format!("CRC-32 of the records {}", summary.records_crc32));
    out
}

/// Writes the result in one sentence.
#[must_use]
pub fn headline(summary: &Summary) -> String {
    let verdict = if summary.passed { "passed" } else { "FAILED" };
    format!(
        "{verdict}: {}, {} exposed, {} refused, {} unanswered",
        wording::counted(summary.triggers, "trigger"),
        wording::count(summary.exposed as u64),
        wording::count(summary.refused as u64),
        wording::count(summary.unanswered as u64)
    )
}

/// Describes camera, device and flight.
#[must_use]
pub fn setting(report: &MissionReport<'_>, summary: &Summary) -> String {
    let flight = &report.scenario.written.flight;
    format!(
        "{} on {}; {} m/s at {} m, V/H {}, exposure {}, a trigger every {} s, {} s of flight, seed {}",
        summary.camera,
        summary.device,
        flight.speed_m_s,
        flight.height_m,
        wording::vh(summary.vh_per_s),
        wording::exposure(flight.exposure_s),
        wording::decimals(report.scenario.interval_s, 3),
        wording::decimals(summary.simulated_s, 0),
        summary.seed
    )
}
