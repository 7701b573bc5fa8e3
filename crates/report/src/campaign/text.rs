//! The campaign as text for a terminal or a pipe, at most 80 columns wide.

use std::fmt::Write;

use super::summary::Summary;
use crate::{limits, wording};

/// Writes limits and findings.
#[must_use]
pub fn text(summary: &Summary) -> String {
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(out, "{}", headline(summary));
    out += &limits::table(&summary.checks);
    let _ = writeln!(
        out,
        "{} without an effect; digest {}",
        wording::counted(
            usize::try_from(summary.runs_without_effect).unwrap_or(usize::MAX),
            "run"
        ),
        summary.digest
    );
    if !summary.findings.is_empty() {
        let _ = writeln!(out, "findings, of each fault the first:");
    }
    for finding in &summary.findings {
        let mut what: String = finding.what.chars().take(60).collect();
        if what != finding.what {
            what.pop();
            what.push('…');
        }
        let _ = writeln!(out, "{what:<62}{}", finding.scenario);
    }
    out
}

/// Writes the result in one line.
#[must_use]
pub fn headline(summary: &Summary) -> String {
    let verdict = if summary.passed { "passed" } else { "FAILED" };
    let part = if summary.request.quick {
        ", a twentieth"
    } else {
        ""
    };
    format!(
        "{verdict}: {} with one fault, {} with two{part}, seed {}",
        wording::counted(usize::try_from(summary.runs).unwrap_or(usize::MAX), "run"),
        wording::count(u64::from(summary.pairs)),
        summary.request.seed
    )
}
