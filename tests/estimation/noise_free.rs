//! Fits to noise-free observations of the model, which give its coefficients back.

use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::sensor::FmcAxis;

use crate::estimation::simulated::{
    TRUTH, adjusted, lens, observations, rounded, single_lens, travels,
};

/// Largest relative error over the five coefficients.
fn worst(values: impl Iterator<Item = f64>) -> f64 {
    values
        .zip(TRUTH)
        .map(|(value, truth)| (value / truth - 1.0).abs())
        .fold(0.0, f64::max)
}

#[test]
fn coefficients_come_back_to_1e_minus_9_in_double_precision() {
    for axis in FmcAxis::ALL {
        let lens = lens(axis);
        let observations = observations(&lens, TRUTH, &travels(), 11);
        let fit = adjusted(lens, FitOptions::default(), &observations)
            .fit()
            .unwrap();
        let worst = worst(fit.values.into_iter());
        assert!(worst < 1e-9, "{axis:?}: {worst:e}");
        assert!(fit.sigma0 * 1e-3 < 1e-12, "{axis:?}: {:e} mm", fit.sigma0);
    }
}

#[test]
fn coefficients_come_back_to_1e_minus_4_in_single_precision() {
    for axis in FmcAxis::ALL {
        let lens = lens(axis);
        let observations = observations(&lens, TRUTH, &travels(), 11);
        assert_eq!(observations.len(), 7260);
        for decentring in [StaticDecentring::Hold, StaticDecentring::Estimate] {
            let options = FitOptions {
                decentring,
                ..FitOptions::default()
            };
            let mut adjustment = Adjustment::new(single_lens(axis), options);
            for observation in &observations {
                adjustment.observe(rounded(observation)).unwrap();
            }
            let fit = adjustment.fit().unwrap();
            let worst = worst(fit.values.into_iter().map(f64::from));
            println!("{axis:?} {decentring:?}: {worst:e}");
            assert!(worst < 1e-4, "{axis:?} {decentring:?}: {worst:e}");
        }
    }
}

/// The calibration has no distortion: all of 0.6 mm of distortion is fitted, in single precision.
#[test]
fn lens_without_static_calibration_is_fitted_in_single_precision_too() {
    let mut known = lens(FmcAxis::PlusY);
    known.k = [0.0; 4];
    let mut single = single_lens(FmcAxis::PlusY);
    single.k = [0.0; 4];
    let mut adjustment = Adjustment::new(single, FitOptions::default());
    for observation in &observations(&known, TRUTH, &travels(), 11) {
        adjustment.observe(rounded(observation)).unwrap();
    }
    let fit = adjustment.fit().unwrap();
    let worst = worst(fit.values.into_iter().map(f64::from));
    println!("{worst:e}");
    assert!(worst < 1e-4, "{worst:e}");
}

/// In powers of mm the condition number of the same design is in the millions (`dense.rs`).
#[test]
fn condition_number_is_about_30() {
    let lens = lens(FmcAxis::PlusY);
    let observations = observations(&lens, TRUTH, &travels(), 11);
    let fit = adjusted(lens, FitOptions::default(), &observations)
        .fit()
        .unwrap();
    println!("{}", fit.condition);
    assert!(
        fit.condition > 10.0 && fit.condition < 40.0,
        "{}",
        fit.condition
    );
}
