//! Calibrations for the tests: the published ones, and random lenses with every term.
//!
//! Published coefficients are read from `host-sim/data/cameras.csv` (sources are named there).

use fmc_camera::geometry::brown::Brown;
use fmc_camera::geometry::calibration::{Calibration, CalibrationParameters};
use fmc_camera::geometry::five_coefficient::FiveCoefficients;
use fmc_camera::geometry::principal_distance::{Flatness, FocusShift, FocusSign};
use fmc_camera::geometry::principal_point::{PrincipalPointMotion, UniformTravel};
use fmc_camera::geometry::sensor::{FmcAxis, SensorPoint};
use fmc_camera::geometry::shutter::{Shutter, ShutterProfile};
use proptest::prelude::*;

/// Returns the five published calibrations.
pub(crate) fn published() -> Vec<CalibrationParameters> {
    include_str!("../../host-sim/data/cameras.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let column: Vec<&str> = line.split(',').collect();
            let number = |index: usize| column[index].parse::<f32>().unwrap();
            let sign = if column[13] == "correction" {
                -1.0
            } else {
                1.0
            };
            // The film cameras have no pixel: 228.6 mm are scanned in 18000 pixels.
            let pixel_um = if column[6].is_empty() {
                12.7
            } else {
                number(6)
            };
            let pixels = |mm: f32| {
                (0..=20_000_u16).min_by(|a, b| {
                    let off = |n: u16| (f32::from(n) * pixel_um - 1000.0 * mm).abs();
                    off(*a).total_cmp(&off(*b))
                })
            };
            CalibrationParameters {
                principal_distance_mm: number(1),
                exit_pupil_mm: number(1),
                principal_point: SensorPoint::new(number(2), number(3)),
                width_px: u32::from(pixels(number(4)).unwrap()),
                height_px: u32::from(pixels(number(5)).unwrap()),
                pixel_um,
                distortion: Brown {
                    k0: sign * number(7),
                    k1: sign * number(8),
                    k2: sign * number(9),
                    k3: sign * number(10),
                    p1: sign * number(11),
                    p2: sign * number(12),
                    b1: 0.0,
                    b2: 0.0,
                },
                fitted: None,
                axis: FmcAxis::PlusY,
                stroke_mm: 4.0,
                flatness: Flatness::default(),
            }
        })
        .collect()
}

/// Returns a record of an 80.64 mm square sensor behind a 100 mm lens.
pub(crate) fn square(distortion: Brown, axis: FmcAxis) -> CalibrationParameters {
    CalibrationParameters {
        principal_distance_mm: 100.0,
        exit_pupil_mm: 100.0,
        principal_point: SensorPoint::new(0.031, -0.047),
        width_px: 9216,
        height_px: 9216,
        pixel_um: 8.75,
        distortion,
        fitted: None,
        axis,
        stroke_mm: 4.0,
        flatness: Flatness::default(),
    }
}

/// Returns lenses with up to some per cent of distortion in which no term is zero.
pub(crate) fn lenses() -> impl Strategy<Value = Brown> {
    let signed = |largest: f32| {
        (0.05_f32..1.0, any::<bool>()).prop_map(move |(size, negative)| {
            if negative {
                -size * largest
            } else {
                size * largest
            }
        })
    };
    (
        signed(1e-2),
        signed(1e-5),
        signed(3e-9),
        signed(1e-12),
        signed(1e-5),
        signed(1e-5),
        signed(1e-3),
        signed(1e-3),
    )
        .prop_map(|(k0, k1, k2, k3, p1, p2, b1, b2)| Brown {
            k0,
            k1,
            k2,
            k3,
            p1,
            p2,
            b1,
            b2,
        })
}

/// Returns any of the four axes.
pub(crate) fn axes() -> impl Strategy<Value = FmcAxis> {
    prop::sample::select(FmcAxis::ALL.to_vec())
}

/// Returns a motion of up to 0.34 mm at up to 0.5 mm from the calibrated position.
pub(crate) fn motions() -> impl Strategy<Value = PrincipalPointMotion> {
    (-0.5_f32..0.5, 0.0_f32..0.34).prop_map(|(offset_mm, travel_mm)| {
        let travel = UniformTravel {
            opening_offset_mm: offset_mm,
            speed_mm_s: travel_mm / 0.01,
            exposure_s: 0.01,
        };
        let leaf = ShutterProfile::Trapezoid {
            opening_fraction: 0.3,
            closing_fraction: 0.1,
        };
        PrincipalPointMotion::from_plan(travel, &Shutter::new(leaf).unwrap())
    })
}

/// Returns the shift of a detector that is `shift_mm` out of its plane.
pub(crate) fn focus(calibration: &Calibration, shift_mm: f32) -> FocusShift {
    FocusShift {
        shift_mm,
        principal_distance_mm: calibration.parameters().principal_distance_mm,
        exit_pupil_mm: calibration.parameters().exit_pupil_mm,
        sign: FocusSign::Physical,
    }
}

/// Returns the five coefficients that a fit to motion from rest gives a lens of this K1.
pub(crate) fn fitted(lens: &Brown) -> FiveCoefficients {
    FiveCoefficients {
        km0: lens.k0,
        km1: lens.k1,
        km2: lens.k2,
        kd1: -lens.k1,
        pm1: -0.5 * lens.k1,
        ..FiveCoefficients::default()
    }
}

/// Returns `steps` x `steps` points over the sensor, edges included.
pub(crate) fn grid(calibration: &Calibration, steps: u8) -> Vec<SensorPoint> {
    let half_width = calibration.sensor().half_width_mm();
    let half_height = calibration.sensor().half_height_mm();
    let place = |index: u8| 2.0 * f32::from(index) / f32::from(steps - 1) - 1.0;
    (0..steps)
        .flat_map(|row| (0..steps).map(move |column| (row, column)))
        .map(|(row, column)| SensorPoint::new(place(column) * half_width, place(row) * half_height))
        .collect()
}
