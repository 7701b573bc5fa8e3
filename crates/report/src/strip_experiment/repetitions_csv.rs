//! Table of every repetition and model: `repetitions.csv`.

use std::io::Write;

use fmc_adjustment::model::Model;
use fmc_simulation::strip_experiment::experiment::Experiment;

/// Writes the table.
///
/// # Errors
/// Those of the sink.
pub fn write(experiment: &Experiment, sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record([
        "repetition",
        "model",
        "control_m",
        "check_m",
        "image_rms_um",
        "iterations",
        "sigma0",
        "km0",
        "km1",
        "km2",
        "kd1",
        "pm1",
    ])?;
    for (index, outcomes) in experiment.repetitions.iter().enumerate() {
        for (model, outcome) in Model::ALL.into_iter().zip(outcomes) {
            let rms_um = 1e3 * outcome.rms_mm.last().copied().unwrap_or(f64::NAN);
            let mut row = vec![
                (index + 1).to_string(),
                model.key().to_owned(),
                format!("{:.6}", outcome.control_m),
                format!("{:.6}", outcome.check_m),
                format!("{rms_um:.5}"),
                outcome.iterations.to_string(),
                format!("{:.5}", outcome.sigma0),
            ];
            // Coefficients that are not fitted are left empty.
            for (value, is_fitted) in outcome.coefficients.iter().zip(model.estimated()) {
                row.push(if is_fitted {
                    format!("{value:.9e}")
                } else {
                    String::new()
                });
            }
            writer.write_record(row)?;
        }
    }
    writer.flush()?;
    Ok(())
}
