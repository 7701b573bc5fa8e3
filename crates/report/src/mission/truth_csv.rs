//! True values of each frame beside the camera's: `truth.csv`.

use std::io::Write;

use fmc_simulation::judge::quantity::Quantity;

use super::MissionReport;

/// Writes the table: one row per record.
///
/// # Errors
/// Those of the sink.
pub fn write(report: &MissionReport<'_>, sink: impl Write) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(sink);
    writer.write_record([
        "sequence",
        "true_opened_s",
        "true_exposure_s",
        "true_centroid_s",
        "true_centroid_offset_mm",
        "true_opening_offset_mm",
        "true_travel_mm",
        "true_vh_per_s",
        "pp_error_px",
        "smear_px",
        "compensation_smear_px",
        "predicted_smear_px",
        "without_fault_or_flag",
        "principal_point_error_per_sigma",
        "vh_error_per_sigma",
        "utc_error_per_sigma",
        "centroid_error_us",
    ])?;
    let judgement = report.judgement;
    let judged = judgement.errors.iter().zip(&judgement.verdicts);
    for (frame, (errors, verdict)) in report.flown.frames.iter().zip(judged) {
        let mut row = vec![frame.record.sequence.to_string()];
        match &frame.truth {
            None => row.extend(std::iter::repeat_n(String::new(), 7)),
            Some(truth) => row.extend([
                format!("{:.6}", truth.opened_s),
                format!("{:.6}", truth.exposure_s),
                format!("{:.7}", truth.centroid_s),
                format!("{:.7}", truth.centroid_offset_mm),
                format!("{:.7}", truth.opening_offset_mm),
                format!("{:.7}", truth.travel_mm),
                format!("{:.7}", truth.vh_per_s),
            ]),
        }
        match errors {
            None => row.extend(std::iter::repeat_n(String::new(), 5)),
            Some(errors) => row.extend([
                format!("{:.5}", errors.pp_error_px),
                format!("{:.5}", errors.smear_px),
                format!("{:.5}", errors.compensation_px),
                format!("{:.5}", errors.predicted_px),
                errors.is_clean.to_string(),
            ]),
        }
        let ratio = |quantity| {
            let stated = verdict.as_ref()?.of_quantity(quantity)?;
            Some(format!("{:.4}", stated.ratio()))
        };
        row.extend(Quantity::ALL.map(|quantity| ratio(quantity).unwrap_or_default()));
        row.push(verdict.map_or(String::new(), |verdict| {
            format!("{:.3}", verdict.centroid_us)
        }));
        writer.write_record(row)?;
    }
    writer.flush()?;
    Ok(())
}
