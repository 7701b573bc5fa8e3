//! One row per run and variant: `runs.csv`.

use std::io::Write;

use fmc_simulation::block_experiment::experiment::BlockExperiment;

/// Writes the table.
///
/// # Errors
/// Those of the sink.
pub fn write(experiment: &BlockExperiment, sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record([
        "run",
        "variant",
        "check_x_m",
        "check_y_m",
        "check_z_m",
        "sigma0",
        "sigma0_limit",
        "redundancy",
        "named_records",
    ])?;
    for (number, run) in (1..).zip(&experiment.runs) {
        for (variant, outcome) in experiment.variants.iter().zip(&run.outcomes) {
            let [x, y, z] = outcome.check_m.map(|metres| format!("{metres:.6}"));
            writer.write_record([
                u64::to_string(&number),
                variant.key().to_owned(),
                x,
                y,
                z,
                format!("{:.6}", outcome.sigma0),
                format!("{:.6}", outcome.sigma0_limit),
                outcome.redundancy.to_string(),
                outcome.named.join(" "),
            ])?;
        }
    }
    writer.flush()?;
    Ok(())
}
