//! The comparison as text for a terminal or a pipe, at most 80 columns wide in a pipe.

use fmc_adjustment::statistics::Estimate;

use super::summary::Summary;
use crate::terminal::{numbers, pairs, table, words};
use crate::wording;

/// Writes the table of the variants, the findings and the checks.
#[must_use]
pub fn text(summary: &Summary) -> String {
    let rows = summary.variants.iter().map(|variant| {
        [
            variant.label.to_owned(),
            centimetres(variant.along_m),
            centimetres(variant.across_m),
            centimetres(variant.height_m),
            plus_minus(variant.sigma0, 3),
            share(variant.sigma0_beyond),
        ]
    });
    let columns = [
        words("check points, cm"),
        numbers("along"),
        numbers("across"),
        numbers("height"),
        numbers("σ0"),
        numbers("beyond"),
    ];
    let findings = summary.findings.iter();
    let checks = summary.checks.iter().map(|check| {
        let mark = if check.passed { "passed" } else { "FAILED" };
        let (what, found, limit) = (&check.what, &check.found, &check.limit);
        (mark, format!("{what}: {found} ({limit})"))
    });
    format!(
        "{}\n{}\n± 95 % interval of the mean; beyond: runs with σ0 above its 5 % limit\n{}\n{}\n",
        headline(summary),
        table(columns, rows),
        pairs(2, findings.map(|finding| ("-", finding.clone()))),
        pairs(8, checks)
    )
}

/// Writes the result in one line.
#[must_use]
pub fn headline(summary: &Summary) -> String {
    let verdict = if summary.passed { "passed" } else { "FAILED" };
    let runs = usize::try_from(summary.request.runs).unwrap_or(0);
    format!(
        "{verdict}: {}, {}, {}, seed {}",
        summary.scenario,
        wording::counted(summary.frames, "frame"),
        wording::counted(runs, "run"),
        summary.request.seed
    )
}

/// Writes a length with its interval, cm.
pub(super) fn centimetres(metres: Estimate) -> String {
    let scaled = Estimate {
        value: 100.0 * metres.value,
        lower: 100.0 * metres.lower,
        upper: 100.0 * metres.upper,
    };
    plus_minus(scaled, 2)
}

/// Writes a mean with half of its interval, which is symmetric.
pub(super) fn plus_minus(mean: Estimate, digits: usize) -> String {
    let half = (mean.upper - mean.lower) / 2.0;
    format!("{:.digits$} ±{half:.digits$}", mean.value)
}

/// Writes a share in per cent.
pub(super) fn share(share: Estimate) -> String {
    format!("{:.0} %", 100.0 * share.value)
}
