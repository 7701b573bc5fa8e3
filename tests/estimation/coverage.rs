//! Coverage of the standard deviations.

use fmc_camera::geometry::estimation::fit::Fit;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::sensor::FmcAxis;

use crate::estimation::simulated::{Noise, TRUTH, adjusted, lens, observations};

const FITS: u32 = 1000;

/// One standard deviation covers 68.27 % of normal errors. Of 1000 fits that is 683 ± 48 at 99.9 %
/// (binomial, standard deviation 14.7).
#[test]
fn one_standard_deviation_covers_the_truth_as_often_as_it_should() {
    let lens = lens(FmcAxis::PlusY);
    let travels_mm = [0.004, 0.02, 0.045, 0.085];
    let exact = observations(&lens, TRUTH, &travels_mm, 7);
    let mut noise = Noise::new(20_240_417);
    let mut covered = [0_u32; 5];
    let mut sigma0 = 0.0;
    for _ in 0..FITS {
        let mut noisy = exact.clone();
        for observation in &mut noisy {
            let [x, y] = noise.pair().map(|noise| 0.85e-3 * noise);
            observation.dx_mm += x;
            observation.dy_mm += y;
        }
        let fit = adjusted(lens, FitOptions::default(), &noisy).fit().unwrap();
        sigma0 += fit.sigma0 / f64::from(FITS);
        for ((count, truth), (value, deviation)) in covered
            .iter_mut()
            .zip(TRUTH)
            .zip(fit.values.into_iter().zip(fit.standard_deviations))
        {
            *count += u32::from((value - truth).abs() <= deviation);
        }
    }
    println!("{covered:?} {sigma0}");
    for count in covered {
        assert!((634..=731).contains(&count), "{covered:?}");
    }
    // With 2n - u degrees of freedom there is no bias; with n - u it would be 1.21.
    assert!((sigma0 - 0.85).abs() < 0.003, "{sigma0}");
}

#[test]
fn degrees_of_freedom_count_both_coordinates() {
    let lens = lens(FmcAxis::PlusY);
    let mut observations = observations(&lens, TRUTH, &[0.01, 0.05], 3);
    let mut noise = Noise::new(3);
    for observation in &mut observations {
        observation.dx_mm += 1e-3 * noise.pair()[0];
    }
    for (decentring, unknowns) in [(StaticDecentring::Hold, 5), (StaticDecentring::Estimate, 6)] {
        let options = FitOptions {
            decentring,
            ..FitOptions::default()
        };
        let fit = adjusted(lens, options, &observations).fit().unwrap();
        assert_eq!((fit.points, fit.unknowns), (18, unknowns));
        assert_eq!(fit.redundancy(), 36 - unknowns);
        let ratio = fit.sigma0_as_printed.unwrap() / fit.sigma0;
        let expected = (f64::from(36 - unknowns) / f64::from(18 - unknowns)).sqrt();
        assert!((ratio / expected - 1.0).abs() < 1e-12);
        // As many points as are counted have twice as many coordinates as can be.
        let points = u32::MAX;
        assert_eq!(Fit { points, ..fit }.redundancy(), u32::MAX - unknowns);
    }
}
