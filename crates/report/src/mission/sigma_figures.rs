//! Figures of error/σ and of the smear against the predicted one.

use fmc_simulation::judge::quantity::Quantity;

use super::{MissionReport, coverage_plot, smear_plot};
use crate::figure::FigureError;

/// Draws the figures of a mission, in SVG, each with the name of its file; none without an exposed
/// frame.
///
/// # Errors
/// [`FigureError`] if a drawing fails.
pub fn of(report: &MissionReport<'_>) -> Result<Vec<(&'static str, String)>, FigureError> {
    let verdicts = || report.judgement.verdicts.iter().flatten();
    let mut figures = Vec::new();
    for quantity in Quantity::ALL {
        let ratios: Vec<f64> = verdicts()
            .filter_map(|verdict| Some(verdict.of_quantity(quantity)?.ratio()))
            .collect();
        if !ratios.is_empty() {
            let figure = coverage_plot::coverage(quantity.name(), &ratios)?;
            figures.push((quantity.file_name(), figure));
        }
    }
    let smears: Vec<(f64, f64)> = verdicts()
        .map(|verdict| (verdict.predicted_px, verdict.smear_px))
        .collect();
    if !smears.is_empty() {
        figures.push(("smear.svg", smear_plot::smear(&smears)?));
    }
    Ok(figures)
}
