//! The published estimates of the residual smear, from the camera and from the exposure:
//! f = 100 mm, 80.64 mm square, V/H 0.10 1/s, 1/300 s, δ = 33.3 µm.
//!
//! Each is the longest smear *vector* over the sensor: in a corner, or the same everywhere.

use fmc_camera::geometry::image_motion::FlightState;

use crate::scene::image_motion::{compensated, pair};
use crate::scene::support::{apart, points, square};

/// Largest difference between camera and exposure, µm: that of single precision.
const AGREEMENT_UM: f64 = 1e-4;
const EXPOSURE_S: f64 = 1.0 / 300.0;

/// Place where a term is largest.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Largest {
    Everywhere,
    InACorner,
}

use Largest::{Everywhere, InACorner};

struct Case {
    name: &'static str,
    change: fn(&mut FlightState),
    /// Number as printed, and half of its last digit, µm.
    printed_um: (f64, f64),
    largest: Largest,
}

#[rustfmt::skip]
const CASES: [Case; 7] = [
    Case { name: "V/H error 1 %", change: |f| f.compensated_vh_per_s = 0.101, printed_um: (0.33, 0.005), largest: Everywhere },
    Case { name: "relief 10 %", change: |f| f.motion.relief_percent = 10.0, printed_um: (3.70, 0.005), largest: Everywhere },
    Case { name: "pitch 1°", change: |f| f.attitude.pitch_deg = 1.0, printed_um: (0.53, 0.005), largest: InACorner },
    Case { name: "drift 5°", change: |f| f.motion.drift_deg = 5.0, printed_um: (2.91, 0.005), largest: Everywhere },
    Case { name: "pitch rate 1°/s", change: |f| f.attitude.pitch_rate_deg_s = 1.0, printed_um: (6.8, 0.05), largest: InACorner },
    Case { name: "roll rate 1°/s", change: |f| f.attitude.roll_rate_deg_s = 1.0, printed_um: (6.8, 0.05), largest: InACorner },
    Case { name: "yaw rate 1°/s", change: |f| f.attitude.yaw_rate_deg_s = 1.0, printed_um: (3.3, 0.05), largest: InACorner },
];

#[test]
fn camera_and_exposure_show_the_published_smear() {
    for case in CASES {
        let name = case.name;
        let mut flight = compensated(0.1);
        (case.change)(&mut flight);
        let (motion, scene) = pair("+y", &flight, EXPOSURE_S);
        let largest = motion.largest_smear(1.0 / 300.0);
        let of_camera = f64::from(largest.smear.length_um());
        let frame = scene.expose(0.0);
        let of_exposure = points(&square(""), 9, 1.0)
            .into_iter()
            .map(|point| {
                // The image of a corner may lie off the array.
                let ground = frame.ground_point(point).unwrap();
                let first = frame.place_at(ground, 0.0).unwrap();
                let last = frame.place_at(ground, EXPOSURE_S).unwrap();
                1e3 * apart(first, last)
            })
            .fold(0.0, f64::max);
        let (printed, half_digit) = case.printed_um;
        assert!(
            (of_camera - printed).abs() <= half_digit,
            "{name}: {of_camera}"
        );
        assert!(
            (of_camera - of_exposure).abs() <= AGREEMENT_UM,
            "{name}: {of_camera} {of_exposure}"
        );
        let corner = [largest.point.x_mm, largest.point.y_mm]
            .iter()
            .all(|coordinate| (coordinate.abs() - 40.32).abs() < 1e-5);
        assert!(corner || case.largest == Everywhere, "{name}");
    }
}
