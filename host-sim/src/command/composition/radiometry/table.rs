//! Table of the figures of all detectors.

use std::io::Write;

use fmc_composition::radiometry::{Correction, DetectorFigures};
use fmc_composition::rig::Rig;

/// Figures with names and units of EMVA 1288, a line each, a column per sub-image.
pub(super) fn write(
    rig: &Rig,
    detectors: &[(Correction, DetectorFigures)],
    sink: &mut dyn Write,
) -> std::io::Result<()> {
    type Figure = fn(&DetectorFigures) -> Option<f64>;
    let lines: [(&str, usize, Figure); 14] = [
        ("system gain K, DN/e-", 4, |one| Some(one.gain_dn_per_e)),
        ("temporal dark noise σ_y.dark, DN", 2, |one| {
            Some(one.temporal_dark_noise_dn)
        }),
        ("temporal dark noise σ_d, e-", 1, |one| {
            Some(one.temporal_dark_noise_e)
        }),
        ("DSNU1288, DN", 2, |one| Some(one.dsnu_dn)),
        ("DSNU1288, e-", 1, |one| Some(one.dsnu_e)),
        ("PRNU1288, %", 3, |one| Some(one.prnu_percent)),
        ("saturation capacity μ_e.sat, e-", 0, |one| {
            Some(one.saturation_capacity_e)
        }),
        ("SNR_max, dB", 1, |one| Some(one.snr_max_db)),
        ("sensitivity threshold μ_e.min, e-", 1, |one| {
            Some(one.absolute_sensitivity_threshold_e)
        }),
        ("dynamic range DR, dB", 1, |one| Some(one.dynamic_range_db)),
        ("linearity error LE, %", 3, |one| {
            Some(one.linearity?.error_percent)
        }),
        ("LE_min, %", 3, |one| Some(one.linearity?.least_percent)),
        ("LE_max, %", 3, |one| Some(one.linearity?.largest_percent)),
        ("defects", 0, |one| {
            u32::try_from(one.defects).ok().map(f64::from)
        }),
    ];
    write!(sink, "{:<34}", "sub-image")?;
    for sub in &rig.sub {
        write!(sink, " {:>8}", sub.id)?;
    }
    writeln!(sink)?;
    for (name, digits, figure) in lines {
        write!(sink, "{name:<34}")?;
        for (_, figures) in detectors {
            match figure(figures) {
                Some(value) => write!(sink, " {value:>8.digits$}")?,
                None => write!(sink, " {:>8}", "-")?,
            }
        }
        writeln!(sink)?;
    }
    Ok(())
}
