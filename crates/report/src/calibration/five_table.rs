//! A five-coefficient calibration for a terminal or a pipe.

use comfy_table::{CellAlignment, Table, presets::UTF8_FULL_CONDENSED};
use fmc_adjustment::calibration::five::FiveCalibration;
use fmc_camera::geometry::estimation::options::StaticDecentring;
use fmc_camera::geometry::estimation::parameter::Parameter;

use super::five_summary::{FiveSummary, estimated, is_along_x, name};
use crate::wording;

/// Number of rejected observations that are printed; `residuals.csv` has all.
const MOST_REJECTED: usize = 50;

/// Writes coefficients with σ, correlations, residuals and rejected observations.
#[must_use]
pub fn text(calibration: &FiveCalibration) -> String {
    let summary = FiveSummary::of(calibration);
    let mut lines = vec![
        format!("camera        {}", summary.camera),
        format!(
            "observations  {}: {} of {}, {} in the fit, {} rejected",
            summary.observations,
            wording::counted(summary.points, "point"),
            wording::counted(summary.exposures, "exposure"),
            wording::count(summary.accepted.into()),
            wording::count(summary.rejected.len() as u64),
        ),
        format!(
            "model         K_d1 and P_m1 per mm of {}{}; static decentring {}",
            match summary.regress_on {
                "centroid" => "centroid offset c̄",
                _ => "travel δ",
            },
            if summary.tied { ", K_d1 = 2 P_m1" } else { "" },
            match calibration.fit.options.decentring {
                StaticDecentring::Hold => "held",
                StaticDecentring::Estimate => "estimated",
                StaticDecentring::Known => "held, believed without error",
            }
        ),
        coefficients(calibration).trim_fmt(),
        "correlations".to_owned(),
        correlations(calibration).trim_fmt(),
        sigma0(&summary),
    ];
    for (statistics, component) in summary.residuals.iter().zip(["dx", "dy"]) {
        lines.push(format!(
            "residuals     {component}: mean {:+.4} µm, rms {:.4} µm, largest {:.4} µm",
            statistics.mean_um, statistics.rms_um, statistics.max_um
        ));
    }
    lines.push(format!(
        "condition     {:.1} (normalised design)",
        summary.condition
    ));
    if calibration.centred {
        lines.push(
            "note          the centroid offset is zero in every exposure: K_d1 and P_m1 are zero within their σ, \
             and per mm of centroid offset they do not exist"
                .to_owned(),
        );
    }
    lines.extend(rejected(&summary));
    lines.join("\n") + "\n"
}

fn sigma0(summary: &FiveSummary) -> String {
    let unit = if summary.has_sigma {
        " times sigma_um"
    } else {
        " µm"
    };
    let printed = summary.sigma0_as_printed.map_or_else(String::new, |sigma| {
        format!(
            "; with n - {} as printed {sigma:.4}{unit}",
            summary.unknowns
        )
    });
    format!(
        "σ0            {:.4}{unit}, 2n - {} = {} degrees of freedom{printed}",
        summary.sigma0, summary.unknowns, summary.redundancy
    )
}

const fn unit(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Km0 => "",
        Parameter::Km1 | Parameter::Kd1 | Parameter::Pm1 => "mm⁻²",
        Parameter::Km2 => "mm⁻⁴",
        Parameter::Decentring => "mm⁻¹",
    }
}

fn coefficients(calibration: &FiveCalibration) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["", "value", "σ", "unit"]);
    let along_x = is_along_x(calibration);
    for parameter in estimated(calibration) {
        table.add_row([
            name(parameter, along_x).to_owned(),
            format!("{:.7e}", calibration.fit.value(parameter)),
            format!("{:.2e}", calibration.fit.standard_deviation(parameter)),
            unit(parameter).to_owned(),
        ]);
    }
    for column in table.column_iter_mut().skip(1).take(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn correlations(calibration: &FiveCalibration) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    let along_x = is_along_x(calibration);
    let parameters = estimated(calibration);
    let mut header = vec![String::new()];
    header.extend(
        parameters
            .iter()
            .map(|parameter| name(*parameter, along_x).to_owned()),
    );
    table.set_header(header);
    for parameter in &parameters {
        let mut row = vec![name(*parameter, along_x).to_owned()];
        row.extend(
            parameters
                .iter()
                .map(|other| format!("{:+.3}", calibration.fit.correlation(*parameter, *other))),
        );
        table.add_row(row);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn rejected(summary: &FiveSummary) -> Vec<String> {
    let mut lines: Vec<String> = summary
        .rejected
        .iter()
        .take(MOST_REJECTED)
        .map(|rejected| {
            let id = rejected
                .id
                .as_ref()
                .map_or_else(String::new, |id| format!(" ({id})"));
            let [x, y] = rejected.residual_um;
            format!(
                "rejected      line {}{id}: residual dx {x:.3} µm, dy {y:.3} µm; test value {:.1} > {:.2}",
                rejected.line, rejected.test_value, summary.critical_value
            )
        })
        .collect();
    let more = summary.rejected.len().saturating_sub(MOST_REJECTED);
    if more > 0 {
        lines.push(format!(
            "rejected      {} more: residuals.csv of --out has all",
            wording::count(more as u64)
        ));
    }
    lines
}
