//! Gross errors in simulated networks.

use fastrand::Rng;
use fmc_adjustment::bundle::cofactors::Cofactors;
use fmc_adjustment::bundle::snooping::{Snooped, snooped};
use fmc_adjustment::bundle::solution::{DatumChoice, adjust};
use fmc_adjustment::bundle::state::State;

use crate::simulated::{SIGMA_MM, Shape, Simulated};

#[test]
fn one_percent_of_gross_errors_over_20_seeds() {
    let (mut above, mut found_above) = (0, 0);
    let (mut between, mut found_between) = (0, 0);
    let (mut good, mut lost) = (0, 0);
    for seed in 0..20 {
        let mut network = Simulated::new(Shape::BUNDLE, 500 + seed).network;
        let mut random = Rng::with_seed(900 + seed);
        let count = network.image_points.len() / 100;
        let mut wrong = vec![None; network.image_points.len()];
        for _ in 0..count {
            let place = random.usize(0..network.image_points.len());
            if wrong[place].is_some() {
                continue;
            }
            let size = 5.0 + 15.0 * random.f64();
            let sign = if random.bool() { 1.0 } else { -1.0 };
            let axis = random.usize(0..2);
            network.image_points[place].measured_mm[axis] += sign * size * SIGMA_MM;
            wrong[place] = Some(size);
        }
        let result = snooped(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
        // Not those of a round with more observations.
        let own = Cofactors::of(&result.network, &result.solution).unwrap();
        assert_eq!(result.cofactors.border, own.border, "seed {seed}");
        for (observed, wrong) in result.network.image_points.iter().zip(wrong) {
            match wrong {
                Some(size) if size > 7.0 => {
                    above += 1;
                    found_above += i32::from(!observed.accepted);
                }
                Some(_) => {
                    between += 1;
                    found_between += i32::from(!observed.accepted);
                }
                None => {
                    good += 1;
                    lost += i32::from(!observed.accepted);
                }
            }
        }
    }
    assert!(above > 80 && found_above == above);
    assert!(between > 10 && 10 * found_between >= 6 * between);
    assert!(good > 12_000);
    assert_eq!(lost, 0);
}

/// Without noise σ0 is that of the roundings, against which the largest of them looks wrong.
#[test]
fn network_without_noise_loses_no_image_point_but_the_wrong_one() {
    let mut exact = Simulated::new(Shape::BUNDLE, 7).network;
    // Distortion is a function of the measured point, so that one correction leaves some of it.
    for _ in 0..5 {
        let adjusted = adjust(&exact, DatumChoice::Auto, &State::initial(&exact)).unwrap();
        let residuals = Snooped::unrejected(&exact, &adjusted).unwrap().tests;
        let pairs = exact.image_points.iter_mut().zip(&residuals.image_points);
        for (observed, tested) in pairs {
            for (measured, tested) in observed.measured_mm.iter_mut().zip(tested) {
                *measured -= tested.residual;
            }
        }
    }
    // All digits, but one in a hundred has nine decimals.
    let rounded = exact.image_points.iter_mut().step_by(100);
    for measured in rounded.flat_map(|observed| &mut observed.measured_mm) {
        *measured = (*measured * 1e9).round() / 1e9;
    }
    let start = State::initial(&exact);
    let result = snooped(&exact, DatumChoice::Auto, &start).unwrap();
    assert!(
        result.solution.sigma0() * SIGMA_MM < 1e-9,
        "{}",
        result.solution.sigma0()
    );
    let lost = result
        .network
        .image_points
        .iter()
        .filter(|it| !it.accepted)
        .count();
    assert_eq!(lost, 0, "σ0 {}", result.solution.sigma0());
    exact.image_points[77].measured_mm[0] += 1e-6;
    let result = snooped(&exact, DatumChoice::Auto, &start).unwrap();
    let rejected = result.network.image_points.iter().enumerate();
    let rejected: Vec<usize> = rejected
        .filter(|(_, it)| !it.accepted)
        .map(|(place, _)| place)
        .collect();
    assert_eq!(rejected, [77]);
}

#[test]
fn wrong_control_point_is_named_and_its_image_points_stay() {
    let mut network = Simulated::new(
        Shape {
            images: 6,
            ..Shape::RESECTION
        },
        11,
    )
    .network;
    network.points[23].given_m.x += 0.002;
    let result = snooped(&network, DatumChoice::Auto, &State::initial(&network)).unwrap();
    let [misfit] = &result.misfits[..] else {
        panic!("{:?}", result.misfits)
    };
    assert_eq!(misfit.point, 23);
    assert!((misfit.difference_m.x + 0.002).abs() < 1e-4);
    assert!(
        result
            .network
            .image_points
            .iter()
            .all(|observed| observed.accepted)
    );
}
