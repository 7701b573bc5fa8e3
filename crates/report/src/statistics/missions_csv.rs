//! One row per mission: `missions.csv`.

use std::io::Write;

use fmc_simulation::judge::coverage::Coverage;
use fmc_simulation::judge::quantity::Quantity;
use fmc_simulation::mechanics::EncoderSide;
use fmc_simulation::statistics::summary::Statistics;

/// Writes the table.
///
/// # Errors
/// Those of the sink.
pub fn write(statistics: &Statistics, sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record([
        "mission",
        "mechanism",
        "encoder_step_um",
        "play_um",
        "encoder_side",
        "direction",
        "triggers",
        "exposed",
        "refused",
        "unanswered",
        "spurious_faults",
        "silent_frames",
        "checks_over_nothing",
        "principal_point_rms",
        "principal_point_largest",
        "vh_rms",
        "vh_largest",
        "utc_rms",
        "utc_largest",
        "smear_above_px",
    ])?;
    for mission in &statistics.missions {
        let setup = &mission.setup;
        let side = match setup.encoder_side {
            EncoderSide::Screw => "screw",
            EncoderSide::Stage => "stage",
        };
        let mut row = vec![
            mission.number.to_string(),
            (if setup.is_tdi { "tdi" } else { "stage" }).to_owned(),
            setup.encoder_step_um.to_string(),
            setup.play_um.to_string(),
            side.to_owned(),
            (if setup.is_reversed {
                "reverse"
            } else {
                "forward"
            })
            .to_owned(),
            mission.triggers.to_string(),
            mission.verdicts.len().to_string(),
            mission.refused.to_string(),
            mission.unanswered.to_string(),
            mission.spurious.join("; "),
            mission.silent.len().to_string(),
            mission.vacuous.len().to_string(),
        ];
        for quantity in Quantity::ALL {
            let ratios: Vec<f64> = mission.ratios(quantity).map(|(_, ratio)| ratio).collect();
            let coverage = Coverage::of_independent(&ratios);
            row.extend(coverage.map_or([String::new(), String::new()], |coverage| {
                [coverage.rms, coverage.largest].map(|value| format!("{value:.3}"))
            }));
        }
        let excess = mission.worst_smear();
        row.push(excess.map_or(String::new(), |(_, excess)| format!("{excess:.4}")));
        writer.write_record(row)?;
    }
    writer.flush()?;
    Ok(())
}
