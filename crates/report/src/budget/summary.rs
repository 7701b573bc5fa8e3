//! The budget for programs: `summary.json`.

use fmc_simulation::budget::result::Budget;
use serde::Serialize;

/// The numbers of a budget. Keys are only ever added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Name of the camera.
    pub camera: String,
    /// Height above the ground.
    pub height_m: f64,
    /// The terms, the largest first.
    pub terms: Vec<TermSummary>,
}

/// One term.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TermSummary {
    /// Source of the error.
    pub source: &'static str,
    /// `position` or `smear`.
    pub kind: &'static str,
    /// `true` if frame record and correction remove it.
    pub removed: bool,
    /// Largest effect over the exposures of the paper; null if the camera takes none of them.
    pub paper_um: Option<f64>,
    /// Largest effect over the exposures of the limits.
    pub limits_um: f64,
    /// `limits_um` in pixels.
    pub limits_px: f64,
    /// `limits_um` on the ground.
    pub limits_ground_cm: f64,
}

impl Summary {
    /// Returns the summary of a budget.
    #[must_use]
    pub fn of(budget: &Budget) -> Self {
        Self {
            camera: budget.camera.clone(),
            height_m: budget.assumptions.height_m,
            terms: budget
                .terms
                .iter()
                .map(|term| TermSummary {
                    source: term.source.key(),
                    kind: term.source.kind().name(),
                    removed: term.source.is_removed(),
                    paper_um: term.paper_mm.map(|mm| 1e3 * mm),
                    limits_um: 1e3 * term.limits_mm,
                    limits_px: budget.pixels(term.limits_mm),
                    limits_ground_cm: 100.0 * budget.ground_m(term.limits_mm),
                })
                .collect(),
        }
    }
}
