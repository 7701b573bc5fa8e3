//! The five coefficients as the camera fits them, on the emulated cores.

use std::env;
use std::path::PathBuf;

use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::estimation::adjustment::Adjustment;
use fmc_camera::geometry::estimation::fit::Fit;
use fmc_camera::geometry::estimation::known_lens::KnownLens;
use fmc_camera::geometry::estimation::observation::Observation;
use fmc_camera::geometry::estimation::options::{FitOptions, StaticDecentring};
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::io::link::MAX_OBSERVATIONS;
use fmc_camera::{Camera, CameraParameters, Exposure};
use host_sim::device::Machine;
use host_sim::device::client::Client;
use host_sim::device::machine::{self, Started};
use host_sim::device::port::TcpPort;

/// Camera of 80.64 mm x 80.64 mm behind 100 mm, with 0.2 mm of distortion.
fn record() -> CameraParameters {
    let mut lens = CalibrationParameters::new(100.0, [9216, 9216], 8.75);
    lens.distortion.k1 = -1.2e-6;
    lens.distortion.k2 = 2.1e-10;
    lens.distortion.p2 = -3e-6;
    CameraParameters::new(lens)
}

/// Returns 11 x 11 points in 12 exposures, with a pattern in place of noise.
fn observations(camera: &Camera) -> Vec<Observation<f32>> {
    let mut observations = Vec::new();
    for step in 0_u8..12 {
        let vh = 0.05 + 0.01 * f32::from(step);
        let exposure = Exposure {
            opening_offset_mm: Some(0.1 - 0.02 * f32::from(step % 5)),
            ..Exposure::new(vh, 0.01)
        };
        let frame = camera.frame(&exposure).unwrap();
        for place in 0_u8..121 {
            let point = SensorPoint::new(
                8.0 * (f32::from(place % 11) - 5.0),
                8.0 * (f32::from(place / 11) - 5.0),
            );
            let seen = frame.correction.distortion(point);
            observations.push(Observation {
                x_mm: point.x_mm,
                y_mm: point.y_mm,
                dx_mm: seen.dx_mm + 1e-4 * (f32::from(place % 7) - 3.0),
                dy_mm: seen.dy_mm + 1e-4 * (f32::from(place % 5) - 2.0),
                regressor_mm: frame.interior.motion.travel_mm,
                sigma_mm: 5e-4 + 1e-4 * f32::from(place % 3),
            });
        }
    }
    observations
}

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
#[ignore = "needs QEMU and the image: cargo xtask test"]
fn fit_of_the_camera_is_that_of_the_pc_bit_by_bit() {
    let camera = Camera::new(record()).unwrap();
    let observations = observations(&camera);
    for machine in [Machine::An386, Machine::An500] {
        let image: PathBuf = env::var_os("FMC_FIRMWARE").unwrap().into();
        let Started {
            process: _process,
            link,
            log: _log,
            wires: _wires,
            memory: _memory,
        } = machine::start(&machine::find().unwrap(), machine, &image, None).unwrap();
        let mut client = Client::new(TcpPort::new(link).unwrap());
        client.connect().unwrap();
        client.load(&record()).unwrap();
        for (tied, decentring) in [
            (false, StaticDecentring::Hold),
            (true, StaticDecentring::Estimate),
        ] {
            let options = FitOptions {
                tied,
                decentring,
                ..FitOptions::default()
            };
            let mut on_pc = Adjustment::new(KnownLens::of(camera.calibration()), options);
            client.start_fit(options).unwrap();
            for batch in observations.chunks(MAX_OBSERVATIONS) {
                for observation in batch {
                    on_pc.observe(*observation).unwrap();
                }
                let points = client.observe(batch.iter().copied().collect()).unwrap();
                assert_eq!(points, on_pc.points());
            }
            let fit = client.fit().unwrap();
            assert_eq!(bits(&fit), bits(&on_pc.fit().unwrap()), "{machine:?}");
        }
        let counters = client.counters().unwrap();
        println!("{machine:?}: stack {} bytes", counters.stack_used_bytes);
    }
}
