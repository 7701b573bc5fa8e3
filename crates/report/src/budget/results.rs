//! The results of a budget in words, for terminal and page alike.

use fmc_simulation::budget::result::{Budget, Exposures, Kind, Source, Term};

use crate::wording;

/// Distortion from which on a correction is worthwhile, pixels.
pub(super) const WORTH_PX: f64 = 0.1;

/// Table row of one term.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Row {
    pub(super) term: String,
    pub(super) kind: &'static str,
    pub(super) removed: &'static str,
    pub(super) paper_um: String,
    pub(super) limits_um: String,
    pub(super) limits_px: String,
    pub(super) ground_cm: String,
}

/// Results of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct BudgetResults {
    pub(super) camera: String,
    pub(super) exposures: String,
    pub(super) rows: Vec<Row>,
    pub(super) advice: String,
}

impl BudgetResults {
    pub(super) fn of(budget: &Budget) -> Self {
        let [slowest, fastest] = budget.vh_per_s;
        let [shortest, longest] = budget.exposure_s;
        let height_m = budget.assumptions.height_m;
        Self {
            camera: format!(
                "{}: f = {} mm, pixel {} µm, {}; {} m above the ground, {} to {} m/s",
                budget.camera,
                wording::decimals(budget.principal_distance_mm, 4),
                wording::decimals(1e3 * budget.pixel_mm, 3),
                wording::strategy(budget.strategy),
                wording::decimals(height_m, 1),
                wording::decimals(slowest * height_m, 1),
                wording::decimals(fastest * height_m, 1),
            ),
            exposures: format!(
                "limits: V/H {} to {} 1/s, {} to {}, {}; paper: V/H 0.05 to 0.17 1/s, 1/700 to 1/100 s, {}",
                wording::decimals(slowest, 4),
                wording::decimals(fastest, 4),
                wording::exposure(shortest),
                wording::exposure(longest),
                taken(&budget.limits),
                taken(&budget.paper),
            ),
            rows: budget.terms.iter().map(|term| row(budget, term)).collect(),
            advice: advice(budget),
        }
    }
}

fn taken(exposures: &Exposures) -> String {
    if exposures.accepted == 0 {
        return "which this camera cannot take".to_owned();
    }
    let refused = if exposures.refused > 0 {
        format!(
            " ({} of {} outside limits or stroke)",
            exposures.refused,
            exposures.accepted + exposures.refused
        )
    } else {
        String::new()
    };
    format!(
        "δ up to {:.0} µm{refused}",
        1e3 * exposures.longest_travel_mm
    )
}

fn row(budget: &Budget, term: &Term) -> Row {
    let um = |mm: f64| three_digits(1e3 * mm);
    Row {
        term: assumed(budget, term.source),
        kind: term.source.kind().name(),
        removed: if term.source.is_removed() {
            "removes it"
        } else {
            ""
        },
        paper_um: term.paper_mm.map_or_else(|| "–".to_owned(), um),
        limits_um: um(term.limits_mm),
        limits_px: three_digits(budget.pixels(term.limits_mm)),
        ground_cm: three_digits(100.0 * budget.ground_m(term.limits_mm)),
    }
}

/// Returns the label of a source with the value assumed for it.
pub(super) fn assumed(budget: &Budget, source: Source) -> String {
    let assumed = &budget.assumptions;
    let number = |value: f64| wording::decimals(value, 3);
    let what = match source {
        Source::FocusShift => {
            format!("{} µm", number(1e3 * assumed.focus_mm))
        }
        Source::Encoder => format!("{} µm", number(1e3 * assumed.encoder_mm)),
        Source::Timing => format!("{} ms", number(1e3 * assumed.timing_s)),
        Source::VhError => format!("{} %", number(100.0 * assumed.vh_error)),
        Source::Relief => format!("{} % of H", number(100.0 * assumed.relief)),
        Source::Drift => format!("{}°", number(assumed.drift_deg)),
        Source::TiltRate | Source::YawRate => {
            format!("{}°/s", number(assumed.rate_deg_s))
        }
        _ => return source.label().to_owned(),
    };
    format!("{}: {what}", source.label())
}

/// Returns the advice, in one sentence.
fn advice(budget: &Budget) -> String {
    let cm = |source| {
        let ground_m = budget.ground_m(budget.effect_mm(source));
        format!("{} cm", three_digits(100.0 * ground_m))
    };
    let distortion_px = budget.pixels(budget.effect_mm(Source::StaticDistortion));
    let run_out_px = budget.pixels(budget.effect_mm(Source::RunOut));
    let focus_px = budget.pixels(budget.effect_mm(Source::FocusShift));
    let distortion = if distortion_px >= WORTH_PX {
        "correct the distortion that the motion changes, too"
    } else {
        "the distortion that the motion changes matters less"
    };
    let focus = if focus_px >= WORTH_PX {
        "find out how far the detector is out of its calibrated plane, which no correction removes unless it is known"
    } else if run_out_px >= WORTH_PX {
        "keep the calibration of the run-out"
    } else {
        "detector and plane matter less"
    };
    let smear = budget
        .terms
        .iter()
        .find(|term| term.source.kind() == Kind::Smear);
    let smear = smear.map_or_else(String::new, |term| {
        format!(
            "; no correction removes the smear, most of it by {} ({} px)",
            assumed(budget, term.source),
            three_digits(budget.pixels(term.limits_mm))
        )
    });
    format!(
        "Take principal point and time of every frame from its record (else up to {} by the time and {} by the principal point on the ground); {distortion} ({} px); {focus} ({} px){smear}.",
        cm(Source::OpeningTime),
        cm(Source::CalibratedPoint),
        three_digits(distortion_px),
        three_digits(focus_px.max(run_out_px)),
    )
}

/// Writes a number with about three digits, and no more than four decimals.
pub(super) fn three_digits(number: f64) -> String {
    let decimals = match number.abs() {
        size if size >= 99.95 => 0,
        size if size >= 9.995 => 1,
        size if size >= 0.9995 => 2,
        size if size >= 0.09995 => 3,
        _ => 4,
    };
    let text = format!("{number:.decimals$}");
    if number > 0.0 && text.bytes().all(|byte| matches!(byte, b'0' | b'.')) {
        "<0.0001".to_owned()
    } else if number > 0.0 {
        text
    } else {
        "0".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_are_enough() {
        let texts = [0.0, 1e-7, 0.05713, 0.2112, 2.851, 37.49, 314.5].map(three_digits);
        assert_eq!(
            texts,
            ["0", "<0.0001", "0.0571", "0.211", "2.85", "37.5", "314"]
        );
    }
}
