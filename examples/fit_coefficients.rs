//! The five coefficients of Yuan et al. 2012, fitted to distortions observed at several exposures,
//! in single precision as in the camera.
//!
//! `cargo run --example fit_coefficients --features estimation`; `host-sim calibrate five` reads
//! files of observations and finds gross errors in them.

use std::{error::Error, fmt::Write as _};

use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::FitOptions;
use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_camera::geometry::five_coefficient::Regressor;
use fmc_camera::{CalibrationParameters, Camera, CameraParameters, Exposure, SensorPoint};

/// Standard deviation of an observed distortion, mm.
const SIGMA_MM: f32 = 1e-3;

/// Returns the reading of a comparator: the truth, rounded to whole micrometres.
fn read_mm(truth_mm: f32) -> f32 {
    (1e3 * truth_mm).round() / 1e3
}

/// Adjusts observations of five exposures at 81 points each.
pub(crate) fn fit() -> Result<String, Box<dyn Error>> {
    let mut lens = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    lens.distortion.k1 = -1e-5;
    let mut parameters = CameraParameters::new(lens);
    if let Mechanism::Stage { run_up, .. } = &mut parameters.mechanism {
        // The shutter opens after the principal point has left its calibrated place.
        *run_up = RunUp::FromRest;
    }
    let camera = Camera::new(parameters)?;

    // Per mm of c̄, the mean offset of the principal point: for a distortion of K1 alone, Kd1 =
    // -2·K1 and Pm1 = -K1.
    let options = FitOptions {
        regressor: Regressor::Centroid,
        ..FitOptions::default()
    };
    let mut adjustment = Adjustment::new(KnownLens::of(camera.calibration()), options);
    for exposure_s in [0.001, 0.0025, 0.005, 0.0075, 0.01] {
        let frame = camera.frame(&Exposure::new(0.17, exposure_s))?;
        for place in 0_u8..81 {
            let x_mm = 9.7 * (f32::from(place % 9) - 4.0);
            let y_mm = 9.7 * (f32::from(place / 9) - 4.0);
            let distortion = frame.correction.distortion(SensorPoint::new(x_mm, y_mm));
            adjustment.observe(Observation {
                x_mm,
                y_mm,
                dx_mm: read_mm(distortion.dx_mm),
                dy_mm: read_mm(distortion.dy_mm),
                regressor_mm: frame.interior.motion.centroid_mm,
                sigma_mm: SIGMA_MM,
            })?;
        }
    }
    let fit = adjustment.fit()?;

    let mut text = String::new();
    for parameter in [
        Parameter::Km0,
        Parameter::Km1,
        Parameter::Km2,
        Parameter::Kd1,
        Parameter::Pm1,
    ] {
        let (value, sigma) = (fit.value(parameter), fit.standard_deviation(parameter));
        writeln!(text, "{parameter:?} {value:12.4e} ± {sigma:.1e}")?;
    }
    let sigma0_um = 1e3 * SIGMA_MM * fit.sigma0;
    writeln!(text, "{} points, σ0 {sigma0_um:.2} µm", fit.points)?;
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", fit()?);
    Ok(())
}
