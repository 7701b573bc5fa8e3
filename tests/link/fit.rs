//! The camera's own fit of the five coefficients.

use fmc_camera::Camera;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::fit::{Fit, FitError};
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera::geometry::range::Quantity;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::MAX_OBSERVATIONS;
use fmc_camera::io::link::message::{Answer, Refusal, Request};

use crate::link::pc::{Pc, camera_parameters};

/// Returns the observations of exposures from rest on a 9 x 9 grid, with a pattern in place of
/// noise.
fn observations() -> Vec<Observation<f32>> {
    let camera = Camera::new(camera_parameters()).unwrap();
    let mut observations = Vec::new();
    for (vh, offset_mm) in [(0.05, 0.1), (0.1, -0.04), (0.17, 0.2)] {
        let frame = camera
            .frame(&Exposure {
                opening_offset_mm: Some(offset_mm),
                ..Exposure::new(vh, 0.01)
            })
            .unwrap();
        for (index, place) in (0_u8..81).zip(0_u8..) {
            let point = SensorPoint::new(
                6.5 * (f32::from(place % 9) - 4.0),
                4.75 * (f32::from(place / 9) - 4.0),
            );
            let seen = frame.correction.distortion(point);
            observations.push(Observation {
                x_mm: point.x_mm,
                y_mm: point.y_mm,
                dx_mm: seen.dx_mm + 1e-4 * (f32::from(index % 7) - 3.0),
                dy_mm: seen.dy_mm + 1e-4 * (f32::from(index % 5) - 2.0),
                regressor_mm: frame.interior.motion.centroid_mm,
                sigma_mm: 5e-4 + 1e-4 * f32::from(index % 3),
            });
        }
    }
    observations
}

fn options() -> [FitOptions; 3] {
    let options = FitOptions {
        regressor: Regressor::Centroid,
        ..FitOptions::default()
    };
    let tied = FitOptions {
        tied: true,
        ..options
    };
    let estimate = FitOptions {
        decentring: StaticDecentring::Estimate,
        ..options
    };
    [options, tied, estimate]
}

/// Returns every number of a fit, as bits.
fn bits(fit: &Fit<f32>) -> Vec<u32> {
    fit.values
        .into_iter()
        .chain(fit.standard_deviations)
        .chain(fit.correlations.into_iter().flatten())
        .chain([fit.sigma0, fit.condition])
        .chain(fit.sigma0_as_printed)
        .map(f32::to_bits)
        .collect()
}

#[test]
fn fit_through_the_link_is_that_of_a_direct_call_bit_by_bit() {
    let observations = observations();
    for options in options() {
        let calibration = *Camera::new(camera_parameters()).unwrap().calibration();
        let mut direct = Adjustment::new(KnownLens::of(&calibration), options);
        let mut pc = Pc::loaded();
        assert_eq!(pc.ask(&Request::StartFit(options)), Answer::Observed(0));
        let mut points = 0;
        for batch in observations.chunks(MAX_OBSERVATIONS) {
            for observation in batch {
                direct.observe(*observation).unwrap();
            }
            points += u32::try_from(batch.len()).unwrap();
            let request = Request::Observe(batch.iter().copied().collect());
            assert_eq!(pc.ask(&request), Answer::Observed(points));
        }
        let Answer::Fitted(fit) = pc.ask(&Request::Fit) else {
            panic!("no fit");
        };
        let direct = direct.fit().unwrap();
        assert_eq!(fit, direct);
        assert_eq!(bits(&fit), bits(&direct));
        assert!(fit.sigma0 > 0.1 && fit.sigma0 < 1.0, "{}", fit.sigma0);
        // More observations can follow, and another fit.
        let request = Request::Observe(observations[..3].iter().copied().collect());
        assert_eq!(pc.ask(&request), Answer::Observed(points + 3));
        assert!(matches!(pc.ask(&Request::Fit), Answer::Fitted(_)));
    }
}

#[test]
fn adjustment_belongs_to_its_calibration_and_its_session() {
    let batch = Request::Observe(observations()[..2].iter().copied().collect());
    let no_fit = Answer::Refused(Refusal::NoFit);
    let mut pc = Pc::connected();
    let start = Request::StartFit(FitOptions::default());
    assert_eq!(
        pc.ask(&start),
        Answer::Refused(Refusal::NoCalibration),
        "without a calibration there is no lens"
    );
    pc.load(&camera_parameters());
    assert_eq!(pc.ask(&batch), no_fit);
    assert_eq!(pc.ask(&Request::Fit), no_fit);
    let load = |pc: &mut Pc| pc.load(&camera_parameters());
    let connect = |pc: &mut Pc| pc.ask(&Request::Connect);
    for end in [load, connect] {
        assert_eq!(pc.ask(&start), Answer::Observed(0));
        assert_eq!(pc.ask(&batch), Answer::Observed(2));
        end(&mut pc);
        assert_eq!(pc.ask(&batch), no_fit);
    }
    assert_eq!(pc.ask(&start), Answer::Observed(0));
    assert_eq!(pc.ask(&batch), Answer::Observed(2));
    assert_eq!(pc.ask(&start), Answer::Observed(0), "from the beginning");
}

#[test]
fn batch_with_an_unbelievable_observation_is_not_taken() {
    let mut pc = Pc::loaded();
    pc.ask(&Request::StartFit(FitOptions::default()));
    let good = observations();
    let send = |pc: &mut Pc, change: fn(&mut Observation<f32>)| {
        let mut batch = good[..4].to_vec();
        change(&mut batch[2]);
        pc.ask(&Request::Observe(batch.into_iter().collect()))
    };
    for (change, quantity) in [
        (
            (|o| o.sigma_mm = 0.0) as fn(&mut Observation<f32>),
            Quantity::SigmaUm,
        ),
        (|o| o.dx_mm = f32::NAN, Quantity::DxUm),
        (|o| o.regressor_mm = f32::INFINITY, Quantity::TravelMm),
    ] {
        let answer = send(&mut pc, change);
        let Answer::Refused(Refusal::Observation { index: 2, error }) = answer else {
            panic!("{answer:?}");
        };
        assert_eq!(error.quantity, quantity);
    }
    let off = Answer::Refused(Refusal::OffSensor { index: 2 });
    assert_eq!(send(&mut pc, |o| o.x_mm = 27.0), off);
    assert_eq!(send(&mut pc, |o| o.y_mm = f32::NAN), off);
    assert_eq!(send(&mut pc, |_| {}), Answer::Observed(4));
}

#[test]
fn observations_that_determine_nothing_are_refused_by_name() {
    let mut pc = Pc::loaded();
    pc.ask(&Request::StartFit(FitOptions::default()));
    let one_exposure: Vec<_> = observations()[..81].to_vec();
    pc.ask(&Request::Observe(
        one_exposure[..2].iter().copied().collect(),
    ));
    assert_eq!(
        pc.ask(&Request::Fit),
        Answer::Refused(Refusal::Fit(FitError::TooFew {
            points: 2,
            needed: 3
        }))
    );
    for batch in one_exposure[2..].chunks(MAX_OBSERVATIONS) {
        pc.ask(&Request::Observe(batch.iter().copied().collect()));
    }
    let Answer::Refused(refusal @ Refusal::Fit(FitError::Inseparable { .. })) =
        pc.ask(&Request::Fit)
    else {
        panic!("not refused");
    };
    let text = refusal.to_string();
    assert!(text.contains("K_d1 and P_m1 cannot be separated from the static decentring"));
}
