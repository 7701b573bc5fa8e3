//! Scenario that repeats a run.

use std::fmt::Write;

use super::plan::Run;
use super::run::{injections, last_trigger_us};
use crate::mission::clock::{microseconds, seconds};
use crate::mission::file::VhQuantity;

/// Returns the scenario of a run of the campaign with a seed, for `host-sim mission`; it names its
/// camera file `camera`.
#[must_use]
pub fn scenario_text(run: &Run, seed: u64, camera: &str) -> String {
    let injections = injections(run.tick, &run.faults);
    let last_s = seconds(last_trigger_us(&injections, &run.faults));
    let text = run.world.scenario_text();
    let mut out = String::new();
    for line in text.lines() {
        // Writing to a string does not fail.
        let _ = if line.starts_with("exposures = ") {
            writeln!(out, "exposures = {}", exposures(&text, last_s))
        } else if line.starts_with("camera = ") {
            writeln!(out, "camera = \"{camera}\"")
        } else if line.starts_with("seed = ") {
            writeln!(out, "seed = {seed}")
        } else {
            writeln!(out, "{line}")
        };
    }
    for injection in &injections {
        let _ = write!(
            out,
            "\n[[fault]]\nname = \"{}\"\nonset_s = {:.6}\nsize = {:?}\n",
            injection.fault, injection.onset_s, injection.size
        );
        if injection.duration_s.is_finite() {
            let _ = writeln!(out, "duration_s = {:?}", injection.duration_s);
        }
        if let Some(source) = injection.source {
            let _ = writeln!(out, "source = \"{}\"", source.name());
        }
        if injection.quantity == Some(VhQuantity::Height) {
            let _ = writeln!(out, "of = \"height\"");
        }
    }
    out
}

/// Returns the number of triggers of a scenario up to a time, s.
fn exposures(text: &str, last_s: f64) -> u64 {
    let value = |key: &str| {
        let mut lines = text.lines();
        let value = lines.find_map(|line| line.strip_prefix(key)?.trim().strip_prefix('='));
        value.and_then(|value| value.trim().parse::<f64>().ok())
    };
    match (value("first_trigger_s"), value("interval_s")) {
        (Some(first_s), Some(interval_s)) => {
            let since_us = microseconds(last_s - first_s);
            since_us / microseconds(interval_s).max(1) + 1
        }
        _ => 1,
    }
}
