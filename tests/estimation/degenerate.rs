//! Observations that do not determine the coefficients, in both precisions.

use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::fit::FitError;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::FmcAxis;

use crate::estimation::simulated::{
    Noise, TRUTH, adjusted, distortion, lens, observations, rounded, single_lens, travels,
};

/// Returns the error of a fit, which is the same in both precisions except for the numbers in it.
fn error(axis: FmcAxis, options: FitOptions, observations: &[Observation<f64>]) -> FitError {
    let double = adjusted(lens(axis), options, observations)
        .fit()
        .unwrap_err();
    let mut adjustment = Adjustment::new(single_lens(axis), options);
    for observation in observations {
        adjustment.observe(rounded(observation)).unwrap();
    }
    let single = adjustment.fit().unwrap_err();
    assert_eq!(
        std::mem::discriminant(&single),
        std::mem::discriminant(&double)
    );
    single
}

fn at_points(points: &[[f64; 2]], travels_mm: &[f64]) -> Vec<Observation<f64>> {
    let lens = lens(FmcAxis::PlusY);
    let mut observations = Vec::new();
    for travel_mm in travels_mm {
        for point in points {
            let [dx_mm, dy_mm] = distortion(&lens, TRUTH, *point, *travel_mm);
            observations.push(Observation {
                x_mm: point[0],
                y_mm: point[1],
                dx_mm,
                dy_mm,
                regressor_mm: *travel_mm,
                sigma_mm: 1e-3,
            });
        }
    }
    observations
}

#[test]
fn one_exposure_cannot_tell_the_dynamic_terms_from_a_static_decentring() {
    for axis in FmcAxis::ALL {
        let mut observations = observations(&lens(axis), TRUTH, &[0.05], 11);
        let mut noise = Noise::new(1);
        for observation in &mut observations {
            let [x, y] = noise.pair();
            observation.dx_mm += 1e-3 * x;
            observation.dy_mm += 1e-3 * y;
        }
        for decentring in [StaticDecentring::Hold, StaticDecentring::Estimate] {
            let options = FitOptions {
                decentring,
                ..FitOptions::default()
            };
            assert_eq!(
                error(axis, options, &observations),
                FitError::Inseparable {
                    first: Parameter::Kd1,
                    second: Parameter::Pm1,
                    third: Some(Parameter::Decentring),
                }
            );
            let tied = FitOptions {
                tied: true,
                ..options
            };
            assert_eq!(
                error(axis, tied, &observations),
                FitError::Inseparable {
                    first: Parameter::Pm1,
                    second: Parameter::Decentring,
                    third: None,
                }
            );
        }
    }
}

#[test]
fn regressor_of_zero_means_that_the_dynamic_terms_do_not_exist() {
    let observations = observations(&lens(FmcAxis::PlusY), TRUTH, &[0.0, 1e-9, -1e-8], 7);
    let error = error(FmcAxis::PlusY, FitOptions::default(), &observations);
    assert!(matches!(error, FitError::NoMotion { largest_mm } if largest_mm <= 1.1e-8));
    let text = error.to_string();
    assert!(text.contains("K_d1 and P_m1 do not exist") && text.contains("centred"));
}

#[test]
fn points_on_a_line_are_said_to_be() {
    let along = |step: [f64; 2], from: [f64; 2]| {
        let places = (-5..=5).map(f64::from);
        let points: Vec<_> = places
            .map(|t| [from[0] + t * step[0], from[1] + t * step[1]])
            .collect();
        at_points(&points, &travels()[..20])
    };
    for (step, from) in [
        ([4.0, 0.0], [0.0625, -0.03125]),
        ([0.0, 3.5], [0.0625, -0.03125]),
        ([3.0, 3.0], [0.0, 0.0]),
        ([2.0, -1.0], [10.0, 5.0]),
        ([0.0, 0.0], [10.0, 5.0]),
    ] {
        let error = error(FmcAxis::PlusY, FitOptions::default(), &along(step, from));
        assert!(matches!(error, FitError::OnALine { spread_mm } if spread_mm < 1e-3));
    }
}

#[test]
fn points_at_one_distance_cannot_tell_the_radial_terms_apart() {
    let points: Vec<_> = (0..12)
        .map(|hour| {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(hour) / 12.0).sin_cos();
            [0.0625 + 15.0 * cosine, -0.03125 + 15.0 * sine]
        })
        .collect();
    let observations = at_points(&points, &travels()[..20]);
    let FitError::Inseparable {
        first,
        second,
        third,
    } = error(FmcAxis::PlusY, FitOptions::default(), &observations)
    else {
        panic!("separable");
    };
    let radial = [Parameter::Km0, Parameter::Km1, Parameter::Km2];
    assert!(radial.contains(&first) && radial.contains(&second));
    assert!(third.is_none_or(|third| radial.contains(&third)));
}

#[test]
fn fewer_than_three_points_are_too_few() {
    let corner = [[26.0, 19.0], [-17.0, 12.0], [4.0, -8.0]];
    for count in 0..3 {
        let observations = at_points(&corner[..usize::try_from(count).unwrap()], &[0.05]);
        assert_eq!(
            error(FmcAxis::PlusY, FitOptions::default(), &observations),
            FitError::TooFew {
                points: count,
                needed: 3
            }
        );
    }
    // Three points have six observations: one more than five coefficients, none more than six.
    let mut observations = at_points(&corner, &[0.05]);
    observations[1].regressor_mm = 0.02;
    observations[2].regressor_mm = 0.08;
    let options = FitOptions {
        decentring: StaticDecentring::Estimate,
        ..FitOptions::default()
    };
    assert_eq!(
        error(FmcAxis::PlusY, options, &observations),
        FitError::TooFew {
            points: 3,
            needed: 4
        }
    );
}

#[test]
fn unbelievable_observation_is_named_and_leaves_the_adjustment_as_it_was() {
    let lens = lens(FmcAxis::PlusY);
    let good = observations(&lens, TRUTH, &[0.02, 0.08], 5);
    let mut adjustment = adjusted(lens, FitOptions::default(), &good);
    let before = adjustment;
    let bad = |change: fn(&mut Observation<f64>)| {
        let mut observation = good[0];
        change(&mut observation);
        observation
    };
    for (observation, quantity) in [
        (bad(|o| o.x_mm = f64::NAN), Quantity::XMm),
        (bad(|o| o.y_mm = 100.0), Quantity::YMm),
        (bad(|o| o.dx_mm = f64::INFINITY), Quantity::DxUm),
        (bad(|o| o.dy_mm = 500.0), Quantity::DyUm),
        (bad(|o| o.regressor_mm = 200.0), Quantity::TravelMm),
        (bad(|o| o.sigma_mm = 0.0), Quantity::SigmaUm),
        (bad(|o| o.sigma_mm = -1e-3), Quantity::SigmaUm),
    ] {
        let error = adjustment.observe(observation).unwrap_err();
        assert_eq!(error.quantity, quantity);
        assert_eq!(adjustment, before);
    }
}
