//! A five-coefficient calibration for a terminal or a pipe.

use fmc_adjustment::calibration::five::FiveCalibration;
use fmc_camera::geometry::estimation::options::StaticDecentring;
use fmc_camera::geometry::estimation::parameter::Parameter;

use super::five_summary::{FiveSummary, estimated, is_along_x, name};
use crate::terminal::{self, numbers, words};
use crate::wording;

/// Number of rejected observations that are printed; `residuals.csv` has all.
const MOST_REJECTED: usize = 50;

/// Columns of the names before and after the tables.
const NAMES: u16 = 14;

/// Writes coefficients with σ, correlations, residuals and rejected observations.
#[must_use]
pub fn text(calibration: &FiveCalibration) -> String {
    let summary = FiveSummary::of(calibration);
    let head = [
        ("camera", summary.camera.clone()),
        ("observations", observations(&summary)),
        ("model", model(&summary, calibration.fit.options.decentring)),
    ];
    let mut found = vec![("σ0", sigma0(&summary))];
    for (statistics, component) in summary.residuals.iter().zip(["dx", "dy"]) {
        let residuals = format!(
            "{component}: mean {:+.4} µm, rms {:.4} µm, largest {:.4} µm",
            statistics.mean_um, statistics.rms_um, statistics.max_um
        );
        found.push(("residuals", residuals));
    }
    let condition = format!("{:.1} (normalised design)", summary.condition);
    found.push(("condition", condition));
    if calibration.centred {
        let note = "the centroid offset is zero in every exposure: K_d1 and P_m1 are zero within \
                    their σ, and per mm of centroid offset they do not exist";
        found.push(("note", note.to_owned()));
    }
    let mut lines = vec![
        terminal::pairs(NAMES, head),
        coefficients(calibration),
        "correlations".to_owned(),
        correlations(calibration),
        terminal::pairs(NAMES, found),
    ];
    // A rejected observation has one line, however long, which other programs can look for.
    lines.extend(rejected(&summary));
    lines.join("\n") + "\n"
}

fn observations(summary: &FiveSummary) -> String {
    format!(
        "{}: {} of {}, {} in the fit, {} rejected",
        summary.observations,
        wording::counted(summary.points, "point"),
        wording::counted(summary.exposures, "exposure"),
        wording::count(summary.accepted.into()),
        wording::count(summary.rejected.len() as u64),
    )
}

fn model(summary: &FiveSummary, decentring: StaticDecentring) -> String {
    format!(
        "K_d1 and P_m1 per mm of {}{}; static decentring {}",
        match summary.regress_on {
            "centroid" => "centroid offset c̄",
            _ => "travel δ",
        },
        if summary.tied { ", K_d1 = 2 P_m1" } else { "" },
        match decentring {
            StaticDecentring::Hold => "held",
            StaticDecentring::Estimate => "estimated",
            StaticDecentring::Known => "held, believed without error",
        }
    )
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
        "{:.4}{unit}, 2n - {} = {} degrees of freedom{printed}",
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

fn coefficients(calibration: &FiveCalibration) -> String {
    let along_x = is_along_x(calibration);
    let columns = [words(""), numbers("value"), numbers("σ"), words("unit")];
    let rows = estimated(calibration).into_iter().map(|parameter| {
        [
            name(parameter, along_x).to_owned(),
            format!("{:.7e}", calibration.fit.value(parameter)),
            format!("{:.2e}", calibration.fit.standard_deviation(parameter)),
            unit(parameter).to_owned(),
        ]
    });
    terminal::table(columns, rows)
}

fn correlations(calibration: &FiveCalibration) -> String {
    let along_x = is_along_x(calibration);
    let parameters = estimated(calibration);
    let names = parameters.iter().map(|parameter| name(*parameter, along_x));
    let columns = std::iter::once(words("")).chain(names.map(numbers));
    let rows = parameters.iter().map(|parameter| {
        let correlations = parameters
            .iter()
            .map(|other| format!("{:+.3}", calibration.fit.correlation(*parameter, *other)));
        std::iter::once(name(*parameter, along_x).to_owned())
            .chain(correlations)
            .collect()
    });
    terminal::lines(columns, rows)
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
