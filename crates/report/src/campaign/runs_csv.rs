//! One row per run: `runs.csv`.

use std::io::Write;

use fmc_simulation::campaign::outcome::Outcome;
use fmc_simulation::campaign::plan::Plan;

/// Writes the table, block by block.
///
/// # Errors
/// Those of the sink.
pub fn write(plan: &Plan, outcomes: &[Vec<Outcome>], sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record([
        "tick_ms",
        "faults",
        "arrived_ms",
        "effect",
        "effect_ms",
        "worst_of",
        "worst",
        "exposed",
        "silent",
        "unrecorded",
        "unanswered",
    ])?;
    for (block, outcomes) in plan.blocks().into_iter().zip(outcomes) {
        for (run, outcome) in plan.runs(block).into_iter().zip(outcomes) {
            let optional =
                |value: Option<u32>| value.map_or(String::new(), |value| value.to_string());
            let (name, used) = outcome.worst.map_or(("", String::new()), |worst| {
                (worst.name, format!("{:.6}", worst.used))
            });
            writer.write_record([
                &run.tick.to_string(),
                &run.description(),
                &optional(outcome.arrived_ms),
                &outcome.effect,
                &optional(outcome.effect_ms),
                name,
                &used,
                &outcome.exposed.to_string(),
                &outcome.silent.to_string(),
                &outcome.unrecorded.to_string(),
                &outcome.unanswered.to_string(),
            ])?;
        }
    }
    writer.flush()?;
    Ok(())
}
