//! Time offset, lever arm, boresight and shifts of strips: without bias, covered by their σ, or
//! named where a flight cannot tell them apart.

use fmc_adjustment::bundle::calibration::{BundleCalibration, CalibrationOptions};
use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::state::State;

use crate::aerial::{CROSSED, F_MM, Flight, Platform, strip};
use crate::data::ideal;

const SEEDS: u32 = 300;

/// Largest distance of a count from 68.27 % of [`SEEDS`] with 99.9 % probability:
/// 3.29·√(300·0.6827·0.3173).
const COUNT: f64 = 26.6;

const SHIFT: Parameter = Parameter::Shift { strip: 0, axis: 0 };
const ARM: [Parameter; 3] = [
    Parameter::LeverArm(0),
    Parameter::LeverArm(1),
    Parameter::LeverArm(2),
];
const BORESIGHT: [Parameter; 3] = [
    Parameter::Boresight(0),
    Parameter::Boresight(1),
    Parameter::Boresight(2),
];

fn crossed(platform: Platform) -> Flight {
    Flight {
        strips: CROSSED.to_vec(),
        platform,
        tilt_rad: 0.02,
        control: 6,
        stage: None,
    }
}

/// Estimates the unknowns from many flights; checks mean error and coverage of each.
fn check(flight: &Flight, estimated: &[Parameter]) {
    let mut errors: Vec<(Parameter, Vec<f64>, u32)> = Vec::new();
    for seed in 1..=u64::from(SEEDS) {
        let network = flight.network(seed, estimated);
        let start = State::initial(&network);
        let solution = adjust(&network, DatumChoice::Auto, &start).unwrap();
        let cofactors = Cofactors::of(&network, &solution).unwrap();
        errors.resize(solution.layout.border.len(), (SHIFT, Vec::new(), 0));
        let columns = solution.layout.border.iter().enumerate();
        for ((column, parameter), (name, list, inside)) in columns.zip(&mut errors) {
            let values = &solution.state.parameters;
            let error = values.value(*parameter) - flight.platform.value(*parameter);
            let sigma = cofactors.border[(column, column)].sqrt();
            *name = *parameter;
            list.push(error / sigma);
            *inside += u32::from(error.abs() < sigma);
        }
    }
    assert!(!errors.is_empty());
    let seeds = f64::from(SEEDS);
    for (parameter, list, inside) in errors {
        // Errors in units of their σ: the standard error of their mean is 1/√n.
        let mean = list.iter().sum::<f64>() / seeds;
        assert!(mean.abs() * seeds.sqrt() < 4.0, "{parameter:?}: {mean} σ");
        let expected = 0.6827 * seeds;
        assert!(
            (f64::from(inside) - expected).abs() <= COUNT,
            "{parameter:?}: {inside} of {SEEDS}"
        );
    }
}

#[test]
fn time_offset_lever_arm_and_boresight_are_found_without_bias() {
    let flight = crossed(Platform {
        time_offset_s: 0.004,
        lever_arm_m: [0.31, -0.82, 1.24],
        boresight_rad: [1.2e-3, -2.1e-3, 0.8e-3],
        shift_m: [0.0; 3],
    });
    check(
        &flight,
        &[&[Parameter::TimeOffset], &ARM[..], &BORESIGHT[..]].concat(),
    );
}

#[test]
fn shifts_of_strips_are_found_without_bias() {
    let flight = crossed(Platform {
        boresight_rad: [-0.9e-3, 0.4e-3, 1.7e-3],
        shift_m: [0.21, -0.14, 0.33],
        ..Platform::default()
    });
    check(&flight, &[&[SHIFT], &BORESIGHT[..]].concat());
}

#[test]
fn principal_distance_and_platform_are_found_together() {
    let flight = Flight {
        control: 12,
        ..crossed(Platform {
            time_offset_s: -0.003,
            boresight_rad: [1.2e-3, -2.1e-3, 0.8e-3],
            ..Platform::default()
        })
    };
    let f = Parameter::Interior(InteriorElement::PrincipalDistance);
    let with_boresight = [&[f, Parameter::TimeOffset], &BORESIGHT[..]].concat();
    check(&flight, &with_boresight);
    // A boresight that is not estimated does not stay unseen.
    let network = flight.network(7, &[f, Parameter::TimeOffset]);
    let solution = adjust(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    assert!(solution.sigma0() > 5.0, "{}", solution.sigma0());
}

/// Checks that a calibration ends in an error with all words.
fn refused(flight: &Flight, estimated: &[Parameter], words: &[&str]) {
    let options = CalibrationOptions {
        unknowns: Unknowns {
            estimated: estimated.to_vec(),
            priors: Vec::new(),
        },
        ..CalibrationOptions::default()
    };
    let error = BundleCalibration::new(&flight.tables(3), ideal(F_MM), &options)
        .unwrap_err()
        .to_string();
    for word in [&["cannot tell"], words].concat() {
        assert!(error.contains(word), "{word} not in: {error}");
    }
}

/// Strips side by side in one direction at one speed, the camera kept level.
fn one_direction() -> Flight {
    Flight {
        strips: vec![strip(0.0, 70.0); 3],
        platform: Platform::default(),
        tilt_rad: 0.0,
        control: 8,
        stage: None,
    }
}

#[test]
fn combinations_that_a_flight_cannot_separate_are_named() {
    let with_offset = [&[Parameter::TimeOffset], &ARM[..]].concat();
    refused(
        &one_direction(),
        &with_offset,
        &["time_offset_s", "lever_arm_y_m"],
    );
    let with_shift = [&[SHIFT], &ARM[..]].concat();
    refused(&one_direction(), &with_shift, &["lever_arm", "shift"]);
    // The velocity of a strip is constant: its shift is a time offset, whatever the directions.
    let level = Flight {
        tilt_rad: 0.0,
        ..crossed(Platform::default())
    };
    refused(
        &level,
        &[SHIFT, Parameter::TimeOffset],
        &["time_offset_s", "shift"],
    );
    // Without shifts, strips of several directions and speeds tell them apart.
    let separate = [&[Parameter::TimeOffset], &ARM[..2]].concat();
    let network = level.network(3, &separate);
    assert!(adjust(&network, DatumChoice::Auto, &State::initial(&network)).is_ok());
}

#[test]
fn shift_without_control_is_named() {
    let flight = Flight {
        control: 0,
        ..crossed(Platform::default())
    };
    let mut tables = flight.tables(3);
    // A file of object points has a row at least.
    tables.object_points.rows.clear();
    let options = CalibrationOptions {
        unknowns: Unknowns {
            estimated: vec![SHIFT],
            priors: Vec::new(),
        },
        ..CalibrationOptions::default()
    };
    let error = BundleCalibration::new(&tables, ideal(F_MM), &options).unwrap_err();
    assert!(error.to_string().contains("shift"), "{error}");
}
