//! The statistics as text for a terminal or a pipe, at most 80 columns wide.

use std::fmt::Write;

use super::summary::Summary;
use crate::{limits, wording};

/// Writes the table of limits and the worst cases.
#[must_use]
pub fn text(summary: &Summary) -> String {
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(out, "{}", headline(summary));
    out += &limits::table(&summary.checks);
    if !summary.cases.is_empty() {
        let _ = writeln!(out, "worst cases:");
    }
    for case in &summary.cases {
        let size = case.size.map_or(String::new(), |size| format!("{size:.2}"));
        let trigger = case
            .trigger
            .map_or(String::new(), |trigger| format!("trigger {trigger}"));
        let what: String = case.what.chars().take(38).collect();
        let _ = writeln!(out, "{what:<38}{size:>9}  {trigger:<11} {}", case.scenario);
    }
    out
}

/// Writes the result in one line.
#[must_use]
pub fn headline(summary: &Summary) -> String {
    let verdict = if summary.passed { "passed" } else { "FAILED" };
    let faults = match summary.request.faults {
        0 => "no faults".to_owned(),
        faults => wording::counted(usize::try_from(faults).unwrap_or(0), "fault") + " each",
    };
    format!(
        "{verdict}: {}, {faults}, seed {}; {}, {} refused",
        wording::counted(
            usize::try_from(summary.request.missions).unwrap_or(0),
            "mission"
        ),
        summary.request.seed,
        wording::counted(summary.exposed, "frame"),
        wording::count(summary.refused as u64)
    )
}
