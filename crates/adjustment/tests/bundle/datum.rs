//! Datum: inner constraints, minimal control and scale bars.

use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::free_cofactors::{DatumTransformation, point_blocks};
use fmc_adjustment::bundle::network::{Network, PointRole, ScaleBar};
use fmc_adjustment::bundle::solution::{DatumChoice, Solution, adjust};
use fmc_adjustment::bundle::state::State;
use fmc_adjustment::bundle::tested::Tests;
use nalgebra::DMatrix;

use crate::simulated::{Shape, Simulated};

fn solved(network: &Network) -> (Solution, Cofactors) {
    let solution = adjust(network, DatumChoice::Auto, &State::initial(network)).unwrap();
    let cofactors = Cofactors::of(network, &solution).unwrap();
    (solution, cofactors)
}

#[test]
fn interior_orientation_does_not_depend_on_the_datum() {
    let free = Simulated::new(Shape::BUNDLE, 3).network;
    let mut minimal = free.clone();
    // Seven coordinates of three points.
    for (point, sigmas) in [
        (0, [Some(0.0); 3]),
        (9, [Some(0.0); 3]),
        (50, [None, None, Some(0.0)]),
    ] {
        minimal.points[point].role = PointRole::Control;
        minimal.points[point].sigmas_m = sigmas;
    }
    let mut scaled = free.clone();
    scaled.scale_bars.push(ScaleBar {
        ends: [0, 59],
        length_m: (scaled.points[59].given_m - scaled.points[0].given_m).norm(),
        sigma_m: 1e-4,
    });
    let (first, first_cofactors) = solved(&free);
    assert_eq!(first.datum.defects(), 7);
    for (network, defects) in [(minimal, 0), (scaled, 6)] {
        let (second, second_cofactors) = solved(&network);
        assert_eq!(second.datum.defects(), defects);
        assert_eq!(second.redundancy(), first.redundancy());
        for (index, parameter) in first.layout.border.iter().enumerate() {
            let sigma = first_cofactors.border[(index, index)].sqrt();
            let other = second_cofactors.border[(index, index)].sqrt();
            let difference = first.state.parameters.value(*parameter)
                - second.state.parameters.value(*parameter);
            assert!(
                difference.abs() < 1e-6 * sigma,
                "{parameter:?} {}",
                difference / sigma
            );
            assert!(
                (sigma - other).abs() < 1e-6 * sigma,
                "{parameter:?} {sigma} {other}"
            );
        }
    }
}

#[test]
fn inner_constraints_leave_no_similarity_in_the_corrections_and_the_least_trace() {
    let network = Simulated::new(Shape::BUNDLE, 4).network;
    let (solution, cofactors) = solved(&network);
    // No part of the corrections is a similarity transformation.
    let mut part = DMatrix::zeros(7, 1);
    let mut size = 0.0;
    for (number, point) in network.points.iter().enumerate() {
        let position = solution.state.point(number);
        let change = position - point.given_m;
        part += solution.datum.of_point(&position).transpose() * change;
        size += change.norm();
    }
    assert!(part.amax() < 1e-9 * size, "{part} {size}");
    let transformation = DatumTransformation::new(&network, &solution, &cofactors).unwrap();
    let blocks = point_blocks(&network, &solution);
    let mut trace = 0.0;
    let mut before = 0.0;
    for (number, block) in blocks.iter().enumerate() {
        let own = cofactors
            .point(&solution.layout, number, block.as_ref(), &[])
            .unwrap()
            .own;
        before += own.trace();
        trace += transformation
            .point(&solution.state.point(number), number, &own)
            .trace();
    }
    assert!(trace > 0.0 && trace < before);
}

#[test]
fn datum_that_is_asked_for_but_not_there_is_an_error() {
    let network = Simulated::new(Shape::BUNDLE, 5).network;
    let error = adjust(&network, DatumChoice::Held, &State::initial(&network)).unwrap_err();
    assert!(
        error.to_string().contains("7 of the 7 parameters"),
        "{error}"
    );
}

#[test]
fn points_of_a_free_network_are_covered_by_their_sigma() {
    let (mut inside, mut all) = (0_u32, 0_u32);
    for seed in 0..40 {
        let simulated = Simulated::new(Shape::BUNDLE, 100 + seed);
        let (network, truth) = (&simulated.network, &simulated.points_m);
        let (solution, cofactors) = solved(network);
        let transformation = DatumTransformation::new(network, &solution, &cofactors).unwrap();
        let blocks = point_blocks(network, &solution);
        for (number, truth) in truth.iter().enumerate() {
            let own = cofactors
                .point(&solution.layout, number, blocks[number].as_ref(), &[])
                .unwrap()
                .own;
            let position = solution.state.point(number);
            let own = transformation.point(&position, number, &own);
            for axis in 0..3 {
                all += 1;
                let error = (position - truth)[axis].abs();
                inside += u32::from(error < own[(axis, axis)].sqrt());
            }
        }
    }
    // Coordinates of one network are correlated: 2 % instead of the 0.5 % of 7200 independent ones.
    let share = f64::from(inside) / f64::from(all);
    assert!((share - 0.6827).abs() < 0.02, "{share}");
}

#[test]
fn scale_bar_with_an_end_that_is_not_determined_takes_no_part() {
    let mut network = Simulated::new(Shape::BUNDLE, 5).network;
    let mut rays = 0;
    for observed in &mut network.image_points {
        if observed.point == 59 {
            observed.accepted = rays == 0;
            rays += 1;
        }
    }
    let (without, _) = solved(&network);
    network.scale_bars.push(ScaleBar {
        ends: [0, 59],
        length_m: 2.0 * (network.points[59].given_m - network.points[0].given_m).norm(),
        sigma_m: 1e-4,
    });
    let (with, cofactors) = solved(&network);
    assert_eq!(with.datum.defects(), 7);
    assert_eq!(with.redundancy(), without.redundancy());
    assert!((with.sigma0() / without.sigma0() - 1.0).abs() < 1e-9);
    let tested = Tests::of(&network, &with, &cofactors);
    assert!(tested.others.is_empty());
}
