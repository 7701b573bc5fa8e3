//! One row per run: `runs.csv`.

use std::io::Write;

use fmc_simulation::campaign::outcome::Outcome;
use fmc_simulation::campaign::plan::Plan;

/// Writes the table, block by block.
///
/// # Errors
/// Those of the sink.
pub fn write(plan: &Plan, outcomes: &[Vec<Outcome>], sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::WriterBuilder::new()
        .has_headers(false)
        .from_writer(sink);
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
        "first_silent",
        "unrecorded",
        "unanswered",
    ])?;
    for (block, outcomes) in plan.blocks().into_iter().zip(outcomes) {
        for (run, outcome) in plan.runs(block).into_iter().zip(outcomes) {
            writer.serialize((run.tick, run.description(), outcome))?;
        }
    }
    writer.flush()?;
    Ok(())
}
