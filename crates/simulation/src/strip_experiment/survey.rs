//! Observations of one repetition of the strip, each with its error.

use fmc_adjustment::exterior_orientation::{ELEMENTS, ExteriorOrientation};
use fmc_adjustment::frame_observation::{PointSigmas, PosObservation};
use nalgebra::SVector;

use super::scenario::Scenario;
use super::strip::{Strip, TruePoint};
use crate::noise::Noise;

/// A ground point as observed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObservedPoint {
    /// Measured image point, sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// Surveyed position, ground frame, m.
    pub ground_m: [f64; 3],
}

/// A frame as observed.
#[derive(Debug, Clone, PartialEq)]
pub struct ObservedFrame {
    /// Exterior orientation observed on board.
    pub pos: PosObservation,
    /// Control points.
    pub control: Vec<ObservedPoint>,
    /// Check points.
    pub check: Vec<ObservedPoint>,
}

/// Standard deviations and biases of the observations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Errors {
    /// Standard deviations of image and ground points.
    pub points: PointSigmas,
    /// Standard deviations of the observed orientation, m and rad, as the adjustment weights them;
    /// `None`: free.
    pub pos: [Option<f64>; ELEMENTS],
    /// Bias of the observed orientation, m and rad, which the adjustment does not know.
    pub pos_bias: [f64; ELEMENTS],
    /// Factor of the noise: 1, or 0 for observations without error.
    pub noise: f64,
}

/// Spread of an initial value that is not observed: m and rad.
const FREE_SPREAD: [f64; ELEMENTS] = [1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3];

impl Errors {
    /// Returns the errors of a scenario.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let pos = &scenario.written.pos;
        let [x, y, z] = pos.position_sigma_m.each();
        let [pitch, roll, yaw] = pos
            .attitude_sigma_deg
            .each()
            .map(|sigma| sigma.map(f64::to_radians));
        let [bias_x, bias_y, bias_z] = pos.position_bias_m;
        let [bias_pitch, bias_roll, bias_yaw] = pos.attitude_bias_deg.map(f64::to_radians);
        Self {
            points: PointSigmas {
                image_mm: scenario.written.image.sigma_um / 1000.0,
                ground_m: scenario.written.control.sigma_m,
            },
            pos: [x, y, z, pitch, roll, yaw],
            pos_bias: [bias_x, bias_y, bias_z, bias_pitch, bias_roll, bias_yaw],
            noise: 1.0,
        }
    }
}

/// Observes a strip once. A control point has one surveyed position in all frames; check points are
/// surveyed as accurately as control points.
#[must_use]
pub fn observe(strip: &Strip, errors: &Errors, mut noise: Noise) -> Vec<ObservedFrame> {
    let PointSigmas { image_mm, ground_m } = errors.points;
    let part = errors.noise;
    let most = strip
        .frames
        .iter()
        .flat_map(|frame| &frame.control)
        .filter_map(|point| point.control)
        .max()
        .unwrap_or(0);
    let survey_errors: Vec<[f64; 3]> = (0..=most)
        .map(|_| noise.next([part * ground_m; 3]))
        .collect();
    strip
        .frames
        .iter()
        .map(|frame| {
            let spreads: Vec<f64> = errors
                .pos
                .iter()
                .zip(FREE_SPREAD)
                .map(|(sigma, spread)| part * sigma.unwrap_or(spread))
                .collect();
            let mut elements = frame.orientation.elements();
            let deviates = SVector::from(noise.next([1.0; ELEMENTS]));
            for (((element, deviate), spread), bias) in elements
                .iter_mut()
                .zip(deviates.iter())
                .zip(spreads)
                .zip(errors.pos_bias)
            {
                *element += deviate * spread + bias;
            }
            let mut observed = |point: &TruePoint| {
                let [ex, ey] = noise.next([part * image_mm; 2]);
                let own = noise.next([part * ground_m; 3]);
                let error = point
                    .control
                    .and_then(|index| survey_errors.get(index))
                    .copied()
                    .unwrap_or(own);
                let [x, y] = point.measured_mm;
                ObservedPoint {
                    measured_mm: [x + ex, y + ey],
                    ground_m: add(point.ground_m, error),
                }
            };
            ObservedFrame {
                pos: PosObservation {
                    orientation: ExteriorOrientation::from_elements(&elements),
                    sigmas: errors.pos,
                },
                control: frame.control.iter().map(&mut observed).collect(),
                check: frame.check.iter().map(&mut observed).collect(),
            }
        })
        .collect()
}

fn add([x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3]) -> [f64; 3] {
    [x + dx, y + dy, z + dz]
}
