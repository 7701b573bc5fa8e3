//! Findings of the comparison, in words.

use fmc_adjustment::statistics::Estimate;
use fmc_simulation::block_experiment::experiment::BlockExperiment;
use fmc_simulation::block_experiment::scenario_file::WrongRecordTable;
use fmc_simulation::block_experiment::variant::Variant;

/// Change of the check points, m, below which it counts as none.
pub(super) const NOTHING_M: f64 = 0.001;

/// Returns the findings of an experiment.
pub(super) fn of(experiment: &BlockExperiment) -> Vec<String> {
    let [gain, ..] = experiment.difference_m(Variant::Static, Variant::Records);
    let mut findings = vec![gained(experiment, gain)];
    if gain.lower > NOTHING_M {
        let beyond = experiment.beyond(Variant::Static);
        let shows = if beyond.value < 0.5 {
            "does not show it"
        } else {
            "shows it"
        };
        findings.push(format!(
            "the static bundle {shows}: σ0 is {:.3}, and beyond its 5 % limit in {}",
            experiment.sigma0(Variant::Static).value,
            runs(experiment, beyond.value)
        ));
    }
    findings.push(recentred(experiment));
    if let Some(wrong) = &experiment.scenario.written.wrong_record {
        findings.push(format!(
            "the wrong record of frame {}, {} µm, is named in {}, and no other in {}",
            wrong.frame,
            wrong.by_um,
            runs(experiment, names_it(experiment, wrong).value),
            runs(experiment, names_no_other(experiment, wrong).value)
        ));
    }
    findings
}

/// Returns the finding about what the records move.
fn gained(experiment: &BlockExperiment, gain: Estimate) -> String {
    let [fixed, ..] = experiment.check_m(Variant::Static);
    let [with, ..] = experiment.check_m(Variant::Records);
    let from_to = format!(
        "along the strips check points are off by {:.2} cm without and {:.2} cm with them, {} cm less",
        100.0 * fixed.value,
        100.0 * with.value,
        interval(100.0, gain)
    );
    if gain.lower.abs().max(gain.upper.abs()) <= NOTHING_M {
        format!("the records buy nothing here: {from_to}")
    } else if gain.holds(0.0) {
        format!("these runs do not show that the records buy anything: {from_to}")
    } else if gain.value < 0.0 {
        format!("the records make it worse: {from_to}")
    } else {
        format!("the records buy {:.1} cm: {from_to}", 100.0 * gain.value)
    }
}

/// Returns the finding about distortion that is recentred or not.
fn recentred(experiment: &BlockExperiment) -> String {
    let variants = (Variant::NotRecentred, Variant::Records);
    let place = experiment.ratio_of_places(variants.0, variants.1);
    let [along, across, height] = experiment.ratio(variants.0, variants.1);
    let [x, y, z] = experiment
        .from_records_m(Variant::NotRecentred)
        .map(|metres| 100.0 * metres.value);
    let change = |ratio: Estimate| {
        format!(
            "{:+.2} % ({:+.2} to {:+.2})",
            percent(ratio.value),
            percent(ratio.lower),
            percent(ratio.upper)
        )
    };
    format!(
        "distortion recentred or not changes the error of check points by {:.1} %: not recentred {}, along {}, across {}, \
         height {}; it moves points by {x:.2}, {y:.2}, {z:.2} cm",
        percent(place.value).abs(),
        change(place),
        change(along),
        change(across),
        change(height)
    )
}

fn percent(ratio: f64) -> f64 {
    100.0 * (ratio - 1.0)
}

/// Writes an estimate with its interval, multiplied by a factor.
fn interval(factor: f64, estimate: Estimate) -> String {
    format!(
        "{:.2} ({:.2} to {:.2})",
        factor * estimate.value,
        factor * estimate.lower,
        factor * estimate.upper
    )
}

/// Writes a share of the runs as their number.
pub(super) fn runs(experiment: &BlockExperiment, share: f64) -> String {
    let runs = experiment.request.runs;
    format!("{:.0} of {runs} runs", share * f64::from(runs))
}

/// Returns the share of runs in which a wrong record is named.
pub(super) fn names_it(experiment: &BlockExperiment, wrong: &WrongRecordTable) -> Estimate {
    let frame = wrong.frame.to_string();
    experiment.share(Variant::Records, |outcome| outcome.named.contains(&frame))
}

/// Returns the share of runs in which no good record is named.
pub(super) fn names_no_other(experiment: &BlockExperiment, wrong: &WrongRecordTable) -> Estimate {
    let frame = wrong.frame.to_string();
    experiment.share(Variant::Records, |outcome| {
        outcome.named.iter().all(|named| *named == frame)
    })
}
