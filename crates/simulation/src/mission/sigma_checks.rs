//! Checks of a flight by the σ that its records state.

use super::check::Check;
use super::scenario::MissionScenario;
use crate::judge::coverage::{Coverage, can_be_chance, independent};
use crate::judge::quantity::Quantity;
use crate::judge::verdict::Verdict;
use crate::wording;

/// Largest share of frames whose true smear is above the predicted one.
const LARGEST_SMEAR_SHARE: f64 = 0.05;

/// Largest error of the principal point across the FMC axis, along which alone the stage moves,
/// mm: ten roundings of a number of f32 up to 64 mm.
const LARGEST_ACROSS_MM: f64 = 4e-5;

/// Judges a flight. Principal point and UTC are judged in all flights, over frames with flags and
/// faults, too; V/H and smear where no fault is injected.
pub(super) fn of(scenario: &MissionScenario, verdicts: &[Option<Verdict>]) -> Vec<Check> {
    let verdicts: Vec<&Verdict> = verdicts.iter().flatten().collect();
    let mut checks = vec![
        stated(Quantity::PrincipalPoint, &verdicts),
        across(&verdicts),
    ];
    if scenario.written.gnss.is_some() {
        checks.push(stated(Quantity::Utc, &verdicts));
    }
    if scenario.faults.is_empty() {
        checks.push(stated(Quantity::Vh, &verdicts));
        checks.push(predicted(&verdicts));
    }
    checks
}

/// Checks the distribution of a quantity's errors in units of the σ that the records state.
fn stated(quantity: Quantity, verdicts: &[&Verdict]) -> Check {
    let ratios: Vec<f64> = verdicts
        .iter()
        .filter_map(|verdict| Some(verdict.of_quantity(quantity)?.ratio()))
        .collect();
    let what = |bound: &str| format!("{}: error/σ of all exposed frames{bound}", quantity.name());
    let Some(coverage) = Coverage::of(&ratios) else {
        return Check::over((0, "frame"), what(""), String::new(), false);
    };
    let rms = quantity.largest_rms();
    let shares = quantity.largest_shares();
    Check::over(
        (coverage.frames, "frame"),
        what(&format!(
            " at most {:.2} RMS, with tails of a normal distribution",
            coverage.largest_rms(rms)
        )),
        format!(
            "{}, {:.2} RMS, {:.1} at most, {} beyond 3 σ, {} beyond 5 σ",
            wording::counted(coverage.frames, "frame"),
            coverage.rms,
            coverage.largest,
            coverage.beyond_3,
            coverage.beyond_5
        ),
        coverage.is_credible(rms, shares),
    )
}

/// Checks the principal point across the FMC axis.
fn across(verdicts: &[&Verdict]) -> Check {
    let largest_mm = verdicts
        .iter()
        .map(|verdict| verdict.across_mm.abs())
        .fold(0.0, f64::max);
    Check::over(
        (verdicts.len(), "frame"),
        "principal point across the FMC axis where it was calibrated".to_owned(),
        format!("at most {:.4} µm off", 1e3 * largest_mm),
        largest_mm <= LARGEST_ACROSS_MM,
    )
}

/// Checks that the true smear is seldom above the predicted one.
fn predicted(verdicts: &[&Verdict]) -> Check {
    let excess: Vec<f64> = verdicts
        .iter()
        .map(|verdict| verdict.smear_px - verdict.predicted_px)
        .collect();
    let above = excess.iter().filter(|excess| **excess > 0.0).count();
    let [frames, above_number] = [excess.len(), above].map(number);
    // The frames of a gust share its smear.
    let departures: Vec<f64> = excess
        .iter()
        .map(|excess| f64::from(u8::from(*excess > 0.0)) - above_number / frames)
        .collect();
    let independent = independent(&departures);
    Check::over(
        (excess.len(), "frame"),
        format!(
            "smear: above the predicted one in {} % of the frames, or more by chance",
            100.0 * LARGEST_SMEAR_SHARE
        ),
        format!(
            "above it in {} of {}, by {:.4} px at most",
            wording::count(above as u64),
            wording::counted(excess.len(), "frame"),
            excess.iter().copied().fold(f64::NEG_INFINITY, f64::max)
        ),
        can_be_chance(
            above_number * independent / frames,
            independent,
            LARGEST_SMEAR_SHARE,
        ),
    )
}

fn number(count: usize) -> f64 {
    u32::try_from(count).map_or(f64::INFINITY, f64::from)
}
