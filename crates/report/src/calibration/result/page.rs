//! The laboratory's part of a certificate as a self-contained page: `certificate.html`.

use askama::Template;
use fmc_adjustment::calibration::result::CalibrationResult;

use super::of_method::{Figure, PageTable};
use super::summary::ResultSummary;
use crate::page::{PageError, inline};
use crate::wording;

/// Content of the page.
#[derive(Template)]
#[template(path = "calibration.html")]
struct Page<'a> {
    summary: &'a ResultSummary,
    serial: String,
    date: String,
    program: String,
    sigma0: String,
    coverage: String,
    parameters: Vec<[String; 7]>,
    correlation_names: Vec<String>,
    correlations: Vec<(String, Vec<String>)>,
    groups: Vec<[String; 5]>,
    images: Vec<Vec<String>>,
    rejected: Vec<[String; 4]>,
    check_points: Vec<Vec<String>>,
    profile: Vec<[String; 7]>,
    balanced: String,
    tables: &'a [PageTable],
    figures: Vec<(String, String)>,
}

/// Writes the page.
pub(super) fn page(
    result: &CalibrationResult,
    summary: &ResultSummary,
    date: Option<&str>,
    tables: &[PageTable],
    figures: &[Figure],
) -> Result<String, PageError> {
    let camera = &result.camera;
    let stated = |text: &str| {
        if text.is_empty() {
            "not stated".to_owned()
        } else {
            text.to_owned()
        }
    };
    let coverage = result.coverage();
    let names: Vec<&str> = result.estimated().map(|one| one.name.as_str()).collect();
    let page = Page {
        summary,
        serial: stated(&camera.serial),
        date: stated(date.unwrap_or_default()),
        program: format!("host-sim {}", env!("CARGO_PKG_VERSION")),
        sigma0: match (result.redundancy(), result.has_sigma) {
            (0, _) => "none, there is no redundancy".to_owned(),
            (_, true) => format!("{:.5} times the given σ", result.sigma0),
            (_, false) => format!(
                "{:.5} µm, {:.6} px",
                result.sigma0,
                result.sigma0 / camera.sensor.pixel_um
            ),
        },
        coverage: if coverage.points == 0 {
            "no image points".to_owned()
        } else {
            format!(
                "{} reach {:.2} mm, {:.0} % of the format radius of {:.2} mm; {:.0} % of the cells of the format hold one",
                wording::counted(coverage.points, "image point"),
                coverage.radius_mm,
                100.0 * coverage.radius_share(),
                coverage.format_radius_mm,
                100.0 * coverage.cells
            )
        },
        parameters: parameters(summary),
        correlation_names: names.iter().map(|name| (*name).to_owned()).collect(),
        correlations: names
            .iter()
            .map(|a| {
                let row = names.iter().map(|b| {
                    result
                        .correlation(a, b)
                        .map_or_else(String::new, |value| format!("{value:+.3}"))
                });
                ((*a).to_owned(), row.collect())
            })
            .collect(),
        groups: groups(summary),
        images: images(summary),
        rejected: rejected(summary),
        check_points: check_points(summary),
        profile: profile(summary),
        balanced: format!("{:.6}", summary.profile.balanced_distance_mm),
        tables,
        figures: figures
            .iter()
            .map(|figure| (inline(figure.svg.clone()), figure.caption.clone()))
            .collect(),
    };
    Ok(page.render()?)
}

fn parameters(summary: &ResultSummary) -> Vec<[String; 7]> {
    let rows = summary.parameters.iter();
    rows.map(|one| {
        let number = |value: f64| {
            if one.unit == "mm" {
                format!("{value:.6}")
            } else {
                format!("{value:.7e}")
            }
        };
        let sigma = |value: f64| {
            if one.sigma > 0.0 {
                format!("{value:.2e}")
            } else {
                "held".to_owned()
            }
        };
        [
            one.name.clone(),
            number(one.value),
            one.unit.to_owned(),
            sigma(one.sigma),
            sigma(one.sigma_a_priori),
            one.start
                .map_or_else(String::new, |start| format!("{:+.3e}", one.value - start)),
            one.significance
                .map_or_else(String::new, |ratio| format!("{ratio:.1}")),
        ]
    })
    .collect()
}

fn groups(summary: &ResultSummary) -> Vec<[String; 5]> {
    let rows = summary.groups.iter();
    rows.map(|group| {
        [
            group.name.to_owned(),
            group.observations.to_string(),
            format!("{:.2}", group.redundancy),
            group
                .sigma0
                .map_or_else(|| "none".to_owned(), |sigma0| format!("{sigma0:.4}")),
            group.rejected.to_string(),
        ]
    })
    .collect()
}

fn images(summary: &ResultSummary) -> Vec<Vec<String>> {
    let rows = summary.images.iter();
    rows.map(|one| {
        let mut row = vec![one.image.clone()];
        let with_sigma = |value: f64, sigma: Option<f64>, decimals: usize| match sigma {
            Some(sigma) => format!("{value:.decimals$} ± {sigma:.1e}"),
            None => format!("{value:.decimals$}"),
        };
        for (index, metres) in one.position_m.into_iter().enumerate() {
            let sigma = one.position_sigma_m.and_then(|all| all.get(index).copied());
            row.push(with_sigma(metres, sigma, 5));
        }
        for (index, degrees) in one.attitude_deg.into_iter().enumerate() {
            let sigma = one
                .attitude_sigma_deg
                .and_then(|all| all.get(index).copied());
            row.push(with_sigma(degrees, sigma, 5));
        }
        row.push(one.points.to_string());
        row.push(format!("{:.4}", one.residual_rms_um));
        row
    })
    .collect()
}

fn rejected(summary: &ResultSummary) -> Vec<[String; 4]> {
    let rows = summary.rejected.iter();
    rows.map(|one| {
        let names: Vec<&str> = [&one.image, &one.point]
            .into_iter()
            .filter_map(|name| name.as_deref())
            .collect();
        [
            one.group.to_owned(),
            names.join(", "),
            one.residual_um
                .map_or_else(String::new, |[x, y]| format!("{x:.3}, {y:.3} µm")),
            format!("{:.2}", one.test_value),
        ]
    })
    .collect()
}

fn check_points(summary: &ResultSummary) -> Vec<Vec<String>> {
    let rows = summary.check_points.iter();
    rows.map(|one| {
        let mut row = vec![one.point.clone()];
        let differences = one.difference_m.into_iter().zip(one.sigma_m);
        row.extend(differences.map(|(metres, sigma)| format!("{metres:+.4} ± {sigma:.4}")));
        row.push(
            one.test_value
                .map_or_else(String::new, |value| format!("{value:.1}")),
        );
        row
    })
    .collect()
}

fn profile(summary: &ResultSummary) -> Vec<[String; 7]> {
    let rows = summary.profile.rows.iter();
    rows.map(|row| {
        [
            format!("{:.2}", row.angle_deg),
            format!("{:.3}", row.radius_mm),
            format!("{:.3}", row.gaussian_um),
            format!("{:.3}", row.balanced_um),
            format!("{:.3}", row.sigma_um),
            format!("{:.3}", row.decentring_um),
            format!("{:.3}", row.decentring_sigma_um),
        ]
    })
    .collect()
}
