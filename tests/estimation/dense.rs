//! An independent check: the design in powers of mm, dense, solved by singular value decomposition.

use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera::geometry::sensor::FmcAxis;
use nalgebra::{DMatrix, DVector};

use crate::estimation::simulated::{
    Noise, TRUTH, adjusted, distortion, lens, observations, travels,
};

/// Returns columns from the model itself, which is linear: the change when a coefficient is one.
fn design(observations: &[Observation<f64>], axis: FmcAxis) -> DMatrix<f64> {
    let lens = lens(axis);
    DMatrix::from_fn(2 * observations.len(), 6, |row, column| {
        let observation = &observations[row / 2];
        let point = [observation.x_mm, observation.y_mm];
        let mut unit = [0.0; 5];
        let mut moved = lens;
        match unit.get_mut(column) {
            Some(coefficient) => *coefficient = 1.0,
            None if axis.is_x() => moved.p[0] += 1.0,
            None => moved.p[1] += 1.0,
        }
        let zero = distortion(&lens, [0.0; 5], point, observation.regressor_mm);
        let one = distortion(&moved, unit, point, observation.regressor_mm);
        (one[row % 2] - zero[row % 2]) / observation.sigma_mm
    })
}

#[test]
fn fit_is_that_of_a_dense_singular_value_decomposition() {
    for axis in FmcAxis::ALL {
        let lens = lens(axis);
        let mut noise = Noise::new(7);
        let mut observations = observations(&lens, TRUTH, &travels()[..12], 7);
        for (index, observation) in (0_u32..).zip(&mut observations) {
            observation.sigma_mm = 1e-3 * (1.0 + f64::from(index % 3));
            let [x, y] = noise.pair().map(|noise| observation.sigma_mm * noise);
            observation.dx_mm += x;
            observation.dy_mm += y;
        }
        let all = design(&observations, axis);
        let right = DVector::from_fn(2 * observations.len(), |row, _| {
            let observation = &observations[row / 2];
            let point = [observation.x_mm, observation.y_mm];
            let known = distortion(&lens, [0.0; 5], point, observation.regressor_mm);
            let observed = [observation.dx_mm, observation.dy_mm];
            (observed[row % 2] - known[row % 2]) / observation.sigma_mm
        });
        for (tied, decentring) in [
            (false, StaticDecentring::Hold),
            (false, StaticDecentring::Estimate),
            (true, StaticDecentring::Hold),
            (true, StaticDecentring::Estimate),
        ] {
            let columns = if decentring == StaticDecentring::Estimate {
                6
            } else {
                5
            };
            let mut dense = all.columns(0, columns).into_owned();
            if tied {
                let radial = 2.0 * dense.column(3);
                let mut tangential = dense.column_mut(4);
                tangential += radial;
                dense = dense.remove_column(3);
            }
            // Columns have unit length, so that the decomposition does not get numbers 1e10 apart.
            let lengths: Vec<f64> = dense.column_iter().map(|column| column.norm()).collect();
            for (mut column, length) in dense.column_iter_mut().zip(&lengths) {
                column /= *length;
            }
            let decomposition = dense.clone().svd(true, true);
            let scaled = decomposition.solve(&right, 1e-12).unwrap();
            let residual = &right - &dense * &scaled;
            let redundancy = f64::from(u32::try_from(right.len() - lengths.len()).unwrap());
            let sigma0 = (residual.norm_squared() / redundancy).sqrt();
            let cofactors = (dense.transpose() * &dense).try_inverse().unwrap();

            let options = FitOptions {
                tied,
                decentring,
                ..FitOptions::default()
            };
            let fit = adjusted(lens, options, &observations).fit().unwrap();
            assert!((fit.sigma0 / sigma0 - 1.0).abs() < 1e-10);
            let singular = &decomposition.singular_values;
            assert!((fit.condition * singular.min() / singular.max() - 1.0).abs() < 1e-8);
            let parameters: Vec<Parameter> = Parameter::ALL
                .into_iter()
                .take(columns)
                .filter(|parameter| !(tied && *parameter == Parameter::Kd1))
                .collect();
            for (place, parameter) in parameters.iter().enumerate() {
                let held = if *parameter == Parameter::Decentring {
                    lens.p[usize::from(!axis.is_x())]
                } else {
                    0.0
                };
                let value = held + scaled[place] / lengths[place];
                let deviation = sigma0 * cofactors[(place, place)].sqrt() / lengths[place];
                assert!(
                    (fit.value(*parameter) / value - 1.0).abs() < 1e-9,
                    "{parameter}"
                );
                assert!(
                    (fit.standard_deviation(*parameter) / deviation - 1.0).abs() < 1e-8,
                    "{parameter}"
                );
                for (other_place, other) in parameters.iter().enumerate() {
                    let covariance = sigma0 * sigma0 * cofactors[(place, other_place)]
                        / (lengths[place] * lengths[other_place]);
                    let scale = deviation * fit.standard_deviation(*other);
                    let difference = fit.covariance(*parameter, *other) - covariance;
                    assert!(difference.abs() < 1e-8 * scale, "{parameter} {other}");
                }
            }
            if tied {
                let [radial, tangential] = [Parameter::Kd1, Parameter::Pm1];
                assert!((fit.value(radial) / fit.value(tangential) - 2.0).abs() < 1e-12);
                assert!((fit.correlation(radial, tangential) - 1.0).abs() < 1e-12);
            }
        }
    }
}

/// Shows the reason for which coordinates are divided by the format radius and columns are brought
/// to one length.
#[test]
fn condition_number_in_powers_of_mm_is_beyond_single_precision() {
    let lens = lens(FmcAxis::PlusY);
    let observations = observations(&lens, TRUTH, &travels(), 5);
    let design = design(&observations, FmcAxis::PlusY);
    let singular = design
        .columns(0, 5)
        .into_owned()
        .svd(false, false)
        .singular_values;
    let condition = singular.max() / singular.min();
    println!("{condition:e}");
    assert!(condition > 1e6, "{condition:e}");
}
