//! Blocks with and without records: what each of the shipped scenarios shows, over the twenty runs
//! of which `docs/calibration-by-images.md` has the numbers.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use fmc_simulation::block_experiment::experiment::{BlockExperiment, Request};
use fmc_simulation::block_experiment::scenario::Scenario;
use fmc_simulation::block_experiment::variant::Variant;

const REQUEST: Request = Request { runs: 20, seed: 1 };

/// The numbers of the docs along the strips, cm, in the order of [`COMPARED`].
const IXM_CM: [f64; 5] = [17.8, 12.2, 1.7, 1.4, 1.5];
const CENTRED_CM: [f64; 5] = [1.4, 1.3, 1.5, 1.4, 1.5];
const RC30_CM: [f64; 5] = [24.3, 20.3, 2.8, 2.2, 2.6];
const SMALL_CM: [f64; 5] = [18.1, 12.5, 3.3, 3.1, 3.2];
const LARGE_CM: [f64; 5] = [18.8, 13.0, 3.2, 2.9, 3.1];

/// Columns of the table in the docs.
const COMPARED: [Variant; 5] = [
    Variant::Static,
    Variant::StaticControl,
    Variant::StaticShift,
    Variant::Records,
    Variant::RecordsShift,
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-sim/scenarios/block")
}

fn experiment(name: &str) -> BlockExperiment {
    let scenario = Scenario::read(&folder().join(name)).unwrap();
    BlockExperiment::run(scenario, REQUEST, || {}).unwrap()
}

// Simulated once for all tests.
static IXM_50: LazyLock<BlockExperiment> = LazyLock::new(|| experiment("ixm-50.toml"));
static CENTRED: LazyLock<BlockExperiment> = LazyLock::new(|| experiment("ixm-50-centred.toml"));
static RC30: LazyLock<BlockExperiment> = LazyLock::new(|| experiment("rc30.toml"));
static SMALL: LazyLock<BlockExperiment> = LazyLock::new(|| experiment("lens-0.03-percent.toml"));
static LARGE: LazyLock<BlockExperiment> = LazyLock::new(|| experiment("lens-1.2-percent.toml"));

fn along_cm(experiment: &BlockExperiment, variant: Variant) -> f64 {
    100.0 * experiment.check_m(variant)[0].value
}

/// Compares with the numbers of the docs, which have one decimal.
fn assert_along(experiment: &BlockExperiment, stated_cm: [f64; 5]) {
    for (variant, stated) in COMPARED.into_iter().zip(stated_cm) {
        let found = along_cm(experiment, variant);
        assert!(
            (found - stated).abs() < 0.051,
            "{}: {found}",
            variant.label()
        );
    }
}

/// Compares σ0 of the static bundle and of that with records with the docs.
fn assert_sigma0(experiment: &BlockExperiment, stated: [f64; 2]) {
    for (variant, stated) in [Variant::Static, Variant::Records].into_iter().zip(stated) {
        let found = experiment.sigma0(variant).value;
        assert!(
            (found - stated).abs() < 0.000_51,
            "{}: {found}",
            variant.label()
        );
    }
}

fn named(experiment: &BlockExperiment) -> Vec<&[String]> {
    let outcomes = experiment.outcomes(Variant::Records);
    outcomes.map(|outcome| outcome.named.as_slice()).collect()
}

#[test]
fn static_bundle_from_rest_in_wind_is_18_cm_off_and_does_not_show_it() {
    let experiment = &*IXM_50;
    assert_along(experiment, IXM_CM);
    assert_sigma0(experiment, [1.009, 1.009]);
    // By hand: half of 65.8 - 39.0 µm on 700 m/51.37 mm is 18.2 cm.
    assert!((along_cm(experiment, Variant::Static) - 18.0).abs() < 1.0);
    assert!(along_cm(experiment, Variant::Records) <= 2.0);
    for variant in [Variant::Static, Variant::Records] {
        let sigma0 = experiment.sigma0(variant);
        assert!((0.97..1.03).contains(&sigma0.value), "{sigma0:?}");
    }
    assert!(experiment.beyond(Variant::Static).value < 0.5);
    // Five control points show it, but do not repair it.
    assert!(experiment.beyond(Variant::StaticControl).value > 0.5);
    let control = experiment.sigma0(Variant::StaticControl).value;
    assert!((control - 1.043).abs() < 0.000_51, "{control}");
    // Shifts of the strips do, at the price of the heights.
    assert!(along_cm(experiment, Variant::StaticShift) < 2.0);
    assert!(experiment.difference_m(Variant::StaticShift, Variant::Records)[2].lower > 0.0);
}

#[test]
fn centred_exposures_are_equal_with_and_without_records_within_a_millimetre() {
    let experiment = &*CENTRED;
    for axis in experiment.difference_m(Variant::Static, Variant::Records) {
        assert!(axis.lower.abs().max(axis.upper.abs()) < 1e-3, "{axis:?}");
    }
    assert_along(experiment, CENTRED_CM);
    assert_sigma0(experiment, [1.006, 1.006]);
    // V/H and exposure time vary from frame to frame, c̄ does not.
    let written = &experiment.scenario.written.flight;
    assert!(written.follows_terrain && written.exposure_s[1] > 9.0 * written.exposure_s[0]);
}

#[test]
fn static_bundle_of_an_rc30_from_rest_is_24_cm_off() {
    let experiment = &*RC30;
    assert_along(experiment, RC30_CM);
    assert_sigma0(experiment, [0.997, 0.997]);
    assert!((along_cm(experiment, Variant::Static) - 24.9).abs() < 1.0);
    assert!(along_cm(experiment, Variant::Records) <= 3.5);
    let sigma0 = experiment.sigma0(Variant::Static);
    assert!(sigma0.value <= 1.03, "{sigma0:?}");
}

#[test]
fn lenses_of_small_and_large_distortion_gain_the_same() {
    assert_along(&SMALL, SMALL_CM);
    assert_along(&LARGE, LARGE_CM);
    assert_sigma0(&SMALL, [1.001, 1.001]);
    assert_sigma0(&LARGE, [0.991, 0.991]);
    let gains = [&SMALL, &LARGE].map(|one| one.difference_m(Variant::Static, Variant::Records)[0]);
    for gain in gains {
        assert!(gain.lower > 0.14 && gain.upper < 0.17, "{gain:?}");
    }
}

#[test]
fn recentred_distortion_is_worth_nothing_with_little_and_millimetres_with_much() {
    let not = |experiment: &BlockExperiment| {
        let variants = (Variant::NotRecentred, Variant::Records);
        (
            experiment.ratio_of_places(variants.0, variants.1),
            experiment.difference_m(variants.0, variants.1),
        )
    };
    for experiment in [&RC30, &SMALL, &CENTRED] {
        let (ratio, _) = not(experiment);
        assert!(ratio.lower > 0.999 && ratio.upper < 1.001, "{ratio:?}");
    }
    for (experiment, [least, stated, most]) in [
        (&IXM_50, [1.013, 1.022, 1.032]),
        (&LARGE, [1.002, 1.006, 1.009]),
    ] {
        let (ratio, [along, ..]) = not(experiment);
        let found = [ratio.lower, ratio.value, ratio.upper];
        for (found, stated) in found.into_iter().zip([least, stated, most]) {
            assert!((found - stated).abs() < 0.000_51, "{ratio:?}");
        }
        assert!(along.lower > 0.0 && along.upper < 3e-3, "{along:?}");
    }
}

#[test]
fn wrong_record_of_one_frame_is_named_in_every_run_and_no_other() {
    let experiment = experiment("ixm-50-wrong-record.toml");
    let named = named(&experiment);
    assert_eq!(named.len(), 20);
    assert!(named.iter().all(|names| *names == ["18"]), "{named:?}");
}

#[test]
fn no_good_record_is_named_in_a_hundred_flights() {
    let runs = [&IXM_50, &CENTRED, &RC30, &SMALL, &LARGE];
    let all: Vec<&[String]> = runs.into_iter().flat_map(|one| named(one)).collect();
    assert_eq!(all.len(), 100);
    assert!(all.iter().all(|names| names.is_empty()), "{all:?}");
}

#[test]
fn same_seed_gives_the_same_numbers_and_another_seed_others() {
    let run = |seed| {
        let scenario = Scenario::read(&folder().join("ixm-50.toml")).unwrap();
        let request = Request { runs: 2, seed };
        let runs = BlockExperiment::run(scenario, request, || {}).unwrap().runs;
        format!("{runs:?}")
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}
