//! Summary of a composition: seams, and registration to green.

use fmc_composition::radiometry::Method;
use fmc_composition::rig::{Heights, Rig};
use fmc_composition::{real, rms};
use fmc_report::composition::page::Section;
use serde::Serialize;

use super::composed::{Choices, Composed};
use crate::cli::OrderName;

/// Distance of a head from the other, m, for which the parallax is stated.
const HEAD_DISTANCE_M: f64 = 0.15;
/// Height, m, and part of it that relief has, for the same.
const HEAD_HEIGHT_M: f64 = 1000.0;
const HEAD_RELIEF: f64 = 0.03;

/// Content of summary.json.
#[derive(Debug, Clone, Serialize)]
pub(in crate::command::composition) struct Summary {
    order: &'static str,
    kernel: &'static str,
    feather_px: usize,
    heights: Option<Heights>,
    radiometry: Option<Method>,
    content_percent: f64,
    pub(in crate::command::composition) seam_step_px: Option<f64>,
    seam_grey_percent: f64,
    seams: Vec<Seam>,
    green: Option<GreenSummary>,
}

#[derive(Debug, Clone, Serialize)]
struct Seam {
    between: [String; 2],
    windows: usize,
    matched: usize,
    step_px: Option<f64>,
    grey_percent: f64,
}

#[derive(Debug, Clone, Serialize)]
struct GreenSummary {
    windows: usize,
    kept: usize,
    outliers: usize,
    residual_px: f64,
    sigma_px: f64,
    /// Root mean square and largest displacement of the polynomial from no displacement.
    displacement_rms_px: f64,
    displacement_largest_px: f64,
    pixel_ratio: f64,
    /// Largest parallax of heads 0.15 m apart, of relief of 3 % of a height of 1000 m.
    parallax_bound_px: f64,
}

impl Summary {
    pub(in crate::command::composition) fn of(
        rig: &Rig,
        composed: &Composed,
        choices: Choices,
        radiometry: Option<Method>,
    ) -> Self {
        let id = |number: usize| {
            rig.sub
                .get(number)
                .map_or_else(String::new, |sub| sub.id.clone())
        };
        let seams = composed.steps.iter().map(|step| Seam {
            between: step.layers.map(id),
            windows: step.windows,
            matched: step.ties.len(),
            step_px: step.step_px,
            grey_percent: 100.0 * step.grey_part,
        });
        let ways = composed
            .steps
            .iter()
            .flat_map(|step| &step.ties)
            .flat_map(|[one, other]| [other[0] - one[0], other[1] - one[1]]);
        let labels = &composed.composite.labels;
        let content = labels.iter().filter(|label| **label > 0).count();
        Self {
            order: match choices.order {
                OrderName::RectifyFirst => "rectify-first",
                OrderName::MosaicFirst => "mosaic-first",
            },
            kernel: choices.kernel.name(),
            feather_px: choices.feather_px,
            heights: rig.calibration.map(|table| table.heights),
            radiometry,
            content_percent: 100.0 * real(content) / real(labels.len()),
            seam_step_px: rms(ways),
            seam_grey_percent: rms(composed.steps.iter().map(|step| 100.0 * step.grey_part))
                .unwrap_or(0.0),
            seams: seams.collect(),
            green: composed.green.as_ref().map(|(matched, registration)| {
                let ways = matched.pairs.iter().map(|pair| {
                    let [u, v] = registration.at(pair.from_px);
                    (u - pair.from_px[0]).hypot(v - pair.from_px[1])
                });
                GreenSummary {
                    windows: matched.windows,
                    kept: registration.kept,
                    outliers: registration.outliers,
                    residual_px: registration.residual_px,
                    sigma_px: registration.polynomial.sigma_px,
                    displacement_rms_px: rms(ways.clone()).unwrap_or(0.0),
                    displacement_largest_px: ways.fold(0.0, f64::max),
                    pixel_ratio: matched.ratio,
                    parallax_bound_px: HEAD_DISTANCE_M / HEAD_HEIGHT_M * HEAD_RELIEF
                        / (1.0 - HEAD_RELIEF)
                        * rig.principal_distance_px(),
                }
            }),
        }
    }

    /// Findings, a line each.
    pub(in crate::command::composition) fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.heights == Some(Heights::Ignore) {
            lines.push(
                "Zhao et al. 2013: polynomials of the ground without heights, virtual image by registration to green."
                    .to_owned(),
            );
        }
        let step = self.seam_step_px.map_or_else(
            || "no window matched".to_owned(),
            |step| format!("{step:.3} px of a coordinate"),
        );
        lines.push(format!(
            "Steps at the seams: {step}, {:.2} % of the grey value (root mean square).",
            self.seam_grey_percent
        ));
        lines.push(format!(
            "{:.2} % of the virtual image have content.",
            self.content_percent
        ));
        if let Some(green) = &self.green {
            lines.push(format!(
                "Green: {} of {} windows, {} rejected, residual {:.3} px of the virtual image ({:.3} of green); displaced by {:.2} px, largest {:.2} px, σ {:.3} px.",
                green.kept,
                green.windows,
                green.outliers,
                green.residual_px,
                green.residual_px / green.pixel_ratio,
                green.displacement_rms_px,
                green.displacement_largest_px,
                green.sigma_px
            ));
            lines.push(format!(
                "Parallax of a head {HEAD_DISTANCE_M} m away, at {HEAD_HEIGHT_M} m over relief of {:.0} % of it: at most {:.3} px; it grows with relief and distance, and with 1/height.",
                100.0 * HEAD_RELIEF,
                green.parallax_bound_px
            ));
        }
        lines
    }

    /// Table of the seams.
    pub(in crate::command::composition) fn section(&self) -> Section {
        let rows = self.seams.iter().map(|seam| {
            vec![
                seam.between.join(", "),
                format!("{} of {}", seam.matched, seam.windows),
                seam.step_px
                    .map_or("none".to_owned(), |step| format!("{step:.3}")),
                format!("{:.3}", seam.grey_percent),
            ]
        });
        Section {
            heading: "Seams".to_owned(),
            columns: ["sub-images", "windows matched", "step, px", "grey, %"]
                .map(str::to_owned)
                .to_vec(),
            rows: rows.collect(),
            caption: "Least-squares matching of the two sub-images where they overlap, in the virtual image: root mean square of a coordinate; grey: second less first sub-image.".to_owned(),
            ..Section::default()
        }
    }
}
