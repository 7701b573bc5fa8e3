//! Cameras whose work is counted, and their points.

use fmc_camera::flight::camera::Mechanism;
use fmc_camera::flight::exposure::Limits;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::calibration::CalibrationParameters;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera::geometry::shutter::ShutterProfile;
use fmc_camera::{Brown, CameraParameters, Exposure};

/// Phase One iXM-RS150F with 50 mm: K1 to K3, the short form.
pub(crate) fn short() -> CameraParameters {
    let mut lens = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
    lens.distortion = Brown {
        k1: -1.6056e-5,
        k2: 6.18966e-9,
        k3: -1.31329e-12,
        ..Brown::default()
    };
    CameraParameters::new(lens)
}

/// The same camera with tangential distortion and affinity: the full form.
pub(crate) fn full() -> CameraParameters {
    let mut parameters = short();
    parameters.calibration.distortion = Brown {
        p1: 2e-6,
        p2: -3e-6,
        b1: 1e-5,
        b2: -2e-5,
        ..parameters.calibration.distortion
    };
    parameters
}

/// The full form behind a leaf shutter, on a stage of limited jerk, for which the parameters of an
/// exposure is most expensive.
pub(crate) fn flown() -> CameraParameters {
    CameraParameters {
        mechanism: Mechanism::Stage {
            acceleration_mm_s2: 1000.0,
            settling_ms: 5.0,
            run_up: RunUp::Centred,
            jerk_mm_s3: Some(100_000.0),
            max_speed_mm_s: None,
        },
        shutter: ShutterProfile::Trapezoid {
            opening_fraction: 0.2,
            closing_fraction: 0.25,
        },
        limits: Limits {
            vh_per_s: [0.05, 0.17],
            exposure_s: [0.001, 0.02],
        },
        ..full()
    }
}

/// A lens of 20 % distortion at the corner, near to folding; the proof that it is one-to-one goes
/// box by box, which takes longest.
pub(crate) fn strong() -> CameraParameters {
    let mut lens = CalibrationParameters::new(100.0, [8000, 6000], 10.0);
    lens.distortion.k1 = 9e-5;
    CameraParameters::new(lens)
}

/// A sensor 104 mm wide and high with 0.5 mm of distortion per axis at the corner, of terms up to
/// K3 that compete.
pub(crate) fn wide() -> CameraParameters {
    let mut lens = CalibrationParameters::new(100.0, [10_400, 10_400], 10.0);
    lens.distortion = Brown {
        k1: 2.5e-6,
        k2: -1.6e-10,
        k3: 5.0e-15,
        ..Brown::default()
    };
    CameraParameters::new(lens)
}

pub(crate) const EXPOSURE: Exposure = Exposure::new(0.17, 1.0 / 200.0);

/// Points along a side of the grid that is corrected.
const SIDE: u16 = 32;
/// Number of points of the grid.
pub(crate) const POINTS: usize = SIDE as usize * SIDE as usize;

/// Returns a grid over most of the sensor, small enough that every ideal point has a measured one.
pub(crate) fn points() -> [SensorPoint; POINTS] {
    let mut points = [SensorPoint::default(); POINTS];
    for (index, point) in (0_u16..).zip(&mut points) {
        let [column, row] = [index % SIDE, index / SIDE].map(f32::from);
        *point = SensorPoint::new(-25.0 + column * 1.6125, -19.0 + row * 1.225);
    }
    points
}
