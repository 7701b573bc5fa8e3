//! Section 13: the five coefficients fitted to exposures.

use super::{Example, Given, Results};
use crate::conventions::camera;
use fmc_camera::flight::camera::{Camera, CameraParameters};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera::geometry::sensor::SensorPoint;

pub(super) const EXAMPLES: &[Example] = &[(
    "fitted per mm of c̄ to exact exposures",
    fitted_to_exact_exposures,
)];

fn fitted_to_exact_exposures(given: &Given) -> Results {
    let mut record: CameraParameters = camera::record();
    record.calibration.principal_distance_mm = given.number("f", "mm");
    record.calibration.distortion.k1 = given.number("K1", "mm⁻²");
    let camera = Camera::new(record).unwrap();
    let options = FitOptions {
        regressor: Regressor::Centroid,
        ..FitOptions::default()
    };
    let mut adjustment = Adjustment::new(KnownLens::of(camera.calibration()), options);
    let exposure_s: f32 = given.number("t", "s");
    for (vh, opening_offset_mm) in [(0.05_f32, 0.0), (0.1, 0.05), (0.17, -0.02), (0.17, 0.1)] {
        let exposure = Exposure {
            opening_offset_mm: Some(opening_offset_mm),
            ..Exposure::new(vh, exposure_s)
        };
        let frame = camera.frame(&exposure).unwrap();
        for (x_mm, y_mm) in [(5.0, 30.0), (-20.0, 8.0), (36.0, -33.0), (-3.0, -14.0)] {
            let seen = frame.correction.distortion(SensorPoint::new(x_mm, y_mm));
            adjustment
                .observe(Observation {
                    x_mm,
                    y_mm,
                    dx_mm: seen.dx_mm,
                    dy_mm: seen.dy_mm,
                    regressor_mm: frame.interior.motion.centroid_mm,
                    sigma_mm: 1e-6,
                })
                .unwrap();
        }
    }
    let fitted = adjustment.fit().unwrap().coefficients();
    vec![
        ("Kd1", "mm⁻²", fitted.kd1.into()),
        ("Pm1", "mm⁻²", fitted.pm1.into()),
    ]
}
