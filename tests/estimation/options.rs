//! Effects of the options.

use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::{
    Calibration, CalibrationParameters, Camera, CameraParameters, CorrectionModel, Exposure,
};

use crate::estimation::simulated::{TRUTH, adjusted, lens, observations, travels};

#[test]
fn static_decentring_is_found_where_it_is_estimated_and_spoils_the_fit_where_it_is_held() {
    for axis in FmcAxis::ALL {
        let truth = lens(axis);
        let observations = observations(&truth, TRUTH, &travels(), 7);
        let place = usize::from(!axis.is_x());
        let mut wrong = truth;
        wrong.p[place] += 3e-6;
        let estimate = FitOptions {
            decentring: StaticDecentring::Estimate,
            ..FitOptions::default()
        };
        let fit = adjusted(wrong, estimate, &observations).fit().unwrap();
        let found = fit.value(Parameter::Decentring);
        assert!((found / truth.p[place] - 1.0).abs() < 1e-8, "{axis:?}");
        assert!((fit.value(Parameter::Pm1) / TRUTH[4] - 1.0).abs() < 1e-8);
        let fit = adjusted(wrong, FitOptions::default(), &observations)
            .fit()
            .unwrap();
        assert!((fit.value(Parameter::Pm1) / TRUTH[4] - 1.0).abs() > 0.5);
        assert!((fit.value(Parameter::Decentring) - wrong.p[place]).abs() < 1e-20);
        assert!(fit.standard_deviation(Parameter::Decentring).abs() < 1e-30);
    }
}

#[test]
fn tie_gives_both_where_the_truth_is_tied() {
    let lens = lens(FmcAxis::MinusX);
    let [km0, km1, km2, _, pm1] = TRUTH;
    let tied = [km0, km1, km2, 2.0 * pm1, pm1];
    let observations = observations(&lens, tied, &travels(), 7);
    let options = FitOptions {
        tied: true,
        ..FitOptions::default()
    };
    let fit = adjusted(lens, options, &observations).fit().unwrap();
    assert_eq!(fit.unknowns, 4);
    for (value, truth) in fit.values.into_iter().zip(tied) {
        assert!((value / truth - 1.0).abs() < 1e-9);
    }
    let sigma = |parameter| fit.standard_deviation(parameter);
    let ratio = sigma(Parameter::Kd1) / sigma(Parameter::Pm1);
    assert!((ratio - 2.0).abs() < 1e-9, "{ratio}");
    let correlation = fit.correlation(Parameter::Kd1, Parameter::Pm1);
    assert!((correlation - 1.0).abs() < 1e-9, "{correlation}");
}

/// One exposure alone, as Yuan et al. 2012 fit in their section 4.1.
#[test]
fn one_exposure_suffices_where_the_static_decentring_is_believed() {
    let lens = lens(FmcAxis::PlusY);
    let observations = observations(&lens, TRUTH, &[0.05], 7);
    let options = FitOptions {
        decentring: StaticDecentring::Known,
        ..FitOptions::default()
    };
    let fit = adjusted(lens, options, &observations).fit().unwrap();
    for (value, truth) in fit.values.into_iter().zip(TRUTH) {
        assert!((value / truth - 1.0).abs() < 1e-9);
    }
}

/// Coefficients that are fitted to c̄ are applied to c̄: the camera with the fitted coefficients
/// removes the observed distortion, whatever Δδ.
#[test]
fn coefficients_are_applied_to_what_they_were_regressed_on() {
    for regressor in [Regressor::Travel, Regressor::Centroid] {
        let mut record =
            CameraParameters::new(CalibrationParameters::new(100.0, [9216, 9216], 8.75));
        record.calibration.distortion.k1 = -1e-6;
        let calibration = Calibration::new(record.calibration).unwrap();
        let mut adjustment = Adjustment::new(
            KnownLens::of(&calibration),
            FitOptions {
                regressor,
                ..FitOptions::default()
            },
        );
        let camera = Camera::new(record).unwrap();
        let exposure = |vh: f32, offset_mm: f32| Exposure {
            opening_offset_mm: Some(offset_mm),
            ..Exposure::new(vh, 0.01)
        };
        let points = [
            (30.0, 10.0),
            (-10.0, 15.0),
            (4.0, -26.0),
            (-37.0, -31.0),
            (5.0, 8.0),
        ];
        let mut observe = |exposure: &Exposure| {
            let frame = camera.frame(exposure).unwrap();
            let motion = &frame.interior.motion;
            for (x_mm, y_mm) in points {
                let seen = frame.correction.distortion(SensorPoint::new(x_mm, y_mm));
                let observation = fmc_camera::geometry::estimation::observation::Observation {
                    x_mm,
                    y_mm,
                    dx_mm: seen.dx_mm,
                    dy_mm: seen.dy_mm,
                    regressor_mm: match regressor {
                        Regressor::Travel => motion.travel_mm,
                        Regressor::Centroid => motion.centroid_mm,
                    },
                    sigma_mm: 1e-6,
                };
                adjustment.observe(observation).unwrap();
            }
        };
        for vh in [0.05, 0.1, 0.17] {
            // Δδ = δ, so that c̄ is 1.5 δ.
            observe(&exposure(vh, vh));
        }
        record.calibration.fitted = Some(adjustment.fit().unwrap().coefficients());
        let fitted = Camera::new(record).unwrap();
        let worst_um = |exposure: Exposure| {
            let exact = camera.frame(&exposure).unwrap().correction;
            let model = Exposure {
                model: CorrectionModel::Fitted,
                ..exposure
            };
            let fitted = fitted.frame(&model).unwrap().correction;
            points
                .map(|(x, y)| {
                    let point = SensorPoint::new(x, y);
                    let (a, b) = (exact.distortion(point), fitted.distortion(point));
                    1000.0 * (a.dx_mm - b.dx_mm).abs().max((a.dy_mm - b.dy_mm).abs())
                })
                .into_iter()
                .fold(0.0, f32::max)
        };
        // Second order in the offset remains.
        assert!(worst_um(exposure(0.12, 0.12)) < 0.01);
        // From another opening offset, c̄ = 0, the terms vanish; on δ they do not.
        let elsewhere = worst_um(exposure(0.17, -0.085));
        match regressor {
            Regressor::Centroid => assert!(elsewhere < 0.01, "{elsewhere}"),
            Regressor::Travel => assert!(elsewhere > 0.5, "{elsewhere}"),
        }
    }
}
