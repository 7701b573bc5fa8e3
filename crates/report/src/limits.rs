//! Numbers and their limits, as statistics, campaigns and experiments with blocks state them.

use std::fmt::Write;

use serde::Serialize;

/// A number and its limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitCheck {
    /// Name of the number.
    pub what: String,
    /// The number.
    pub found: String,
    /// Limit, in words.
    pub limit: String,
    /// `true` if it is within its limit.
    pub passed: bool,
}

/// Writes a table for a terminal or a pipe, at most 80 columns wide.
#[must_use]
pub fn table(checks: &[LimitCheck]) -> String {
    let mut out = format!("{:<8}{:<36}{:>14}  limit\n", "", "", "found");
    for check in checks {
        let mark = if check.passed { "passed" } else { "FAILED" };
        let (what, found, limit) = (&check.what, &check.found, &check.limit);
        // Writing to a string does not fail.
        let _ = writeln!(out, "{mark:<8}{what:<36}{found:>14}  {limit}");
    }
    out
}

/// Returns the names of the numbers that are beyond their limits, with commas between them; `None`
/// if there are none.
#[must_use]
pub fn exceeded(checks: &[LimitCheck]) -> Option<String> {
    let failed = checks.iter().filter(|check| !check.passed);
    let failed: Vec<&str> = failed.map(|check| check.what.as_str()).collect();
    (!failed.is_empty()).then(|| failed.join(", "))
}
