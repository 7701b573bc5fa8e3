//! Unknowns that all images share: interior orientation, and how positions and attitudes observed
//! on board belong to the camera.

use nalgebra::{Rotation3, Vector3};

use crate::correction::{COEFFICIENT_NAMES, COEFFICIENTS};

use super::interior::{Interior, InteriorElement};
use super::pose::rotation_vector;
use super::stage::{Stage, StageElement};

/// A shared unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// Element of the interior orientation.
    Interior(InteriorElement),
    /// Element of the stage.
    Stage(StageElement),
    /// Additional parameter, by its number.
    Additional(usize),
    /// dt, s.
    TimeOffset,
    /// Component of the lever arm, m.
    LeverArm(usize),
    /// Component of the boresight rotation, rad.
    Boresight(usize),
    /// Component of the shift of a strip's positions, m.
    Shift {
        /// Number of the strip.
        strip: usize,
        /// Axis of the ground frame.
        axis: usize,
    },
    /// Coordinate of an object point at the end of a scale bar, m.
    Point {
        /// Number of the point.
        point: usize,
        /// Axis of the ground frame.
        axis: usize,
    },
}

/// Letters of the axes in names.
pub const AXES: [&str; 3] = ["x", "y", "z"];

impl Parameter {
    /// Name with unit, as in a summary; strips and points by the names given.
    #[must_use]
    pub fn name(self, strips: &[String], points: impl Fn(usize) -> String) -> String {
        let letter = |axis: usize| AXES.get(axis).copied().unwrap_or_default();
        match self {
            Self::Interior(element) => element.name().to_owned(),
            Self::Stage(element) => element.name().to_owned(),
            Self::Additional(number) => {
                let name = COEFFICIENT_NAMES.get(number).copied();
                name.unwrap_or_default().to_owned()
            }
            Self::TimeOffset => "time_offset_s".to_owned(),
            Self::LeverArm(axis) => format!("lever_arm_{}_m", letter(axis)),
            Self::Boresight(axis) => format!("boresight_{}_rad", letter(axis)),
            Self::Shift { strip, axis } => {
                let name = strips.get(strip).map_or("", String::as_str);
                format!("shift_{name}_{}_m", letter(axis))
            }
            Self::Point { point, axis } => format!("point_{}_{}_m", points(point), letter(axis)),
        }
    }
}

/// Values of the shared unknowns.
///
/// # Model
/// Projection centre `S = observed + V·dt + R·a + shift`, R = `ground_from_camera`; attitude
/// `camera_from_ground = exp(b)·(camera_from_ground observed)`.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedValues {
    /// Interior orientation.
    pub interior: Interior,
    /// Stage relative to that of the camera file.
    pub stage: Stage,
    /// Additional parameters.
    pub additional: [f64; COEFFICIENTS],
    /// dt: the centroid of the exposure less the time of the observed position, s.
    pub time_offset_s: f64,
    /// a: the projection centre from the observed point, camera axes, m.
    pub lever_arm_m: Vector3<f64>,
    /// exp(b): from the axes of the attitude system to camera axes.
    pub boresight: Rotation3<f64>,
    /// Shifts of the strips, ground frame, m.
    pub shifts_m: Vec<Vector3<f64>>,
}

impl SharedValues {
    /// Takes an interior orientation, with positions and attitudes observed at the camera itself.
    #[must_use]
    pub fn new(interior: Interior, strips: usize) -> Self {
        Self {
            interior,
            stage: Stage::default(),
            additional: [0.0; COEFFICIENTS],
            time_offset_s: 0.0,
            lever_arm_m: Vector3::zeros(),
            boresight: Rotation3::identity(),
            shifts_m: vec![Vector3::zeros(); strips],
        }
    }

    /// Value of an unknown; 0 for object points.
    #[must_use]
    pub fn value(&self, parameter: Parameter) -> f64 {
        let component = |vector: &Vector3<f64>, axis: usize| vector.get(axis).copied();
        match parameter {
            Parameter::Interior(element) => Some(self.interior.value(element)),
            Parameter::Stage(element) => Some(self.stage.value(element)),
            Parameter::Additional(number) => self.additional.get(number).copied(),
            Parameter::TimeOffset => Some(self.time_offset_s),
            Parameter::LeverArm(axis) => component(&self.lever_arm_m, axis),
            Parameter::Boresight(axis) => component(&rotation_vector(&self.boresight), axis),
            Parameter::Shift { strip, axis } => self
                .shifts_m
                .get(strip)
                .and_then(|shift| component(shift, axis)),
            Parameter::Point { .. } => None,
        }
        .unwrap_or(0.0)
    }

    /// Changes an unknown by a step; the boresight turns about the camera's axes.
    pub fn add(&mut self, parameter: Parameter, step: f64) {
        let element = match parameter {
            Parameter::Interior(element) => {
                self.interior.add(element, step);
                None
            }
            Parameter::Stage(element) => {
                self.stage.add(element, step);
                None
            }
            Parameter::Additional(number) => self.additional.get_mut(number),
            Parameter::TimeOffset => Some(&mut self.time_offset_s),
            Parameter::LeverArm(axis) => self.lever_arm_m.get_mut(axis),
            Parameter::Boresight(axis) => {
                let turn = Vector3::from_fn(|row, _| if row == axis { step } else { 0.0 });
                self.boresight = Rotation3::from_scaled_axis(turn) * self.boresight;
                None
            }
            Parameter::Shift { strip, axis } => self
                .shifts_m
                .get_mut(strip)
                .and_then(|shift| shift.get_mut(axis)),
            Parameter::Point { .. } => None,
        };
        if let Some(element) = element {
            *element += step;
        }
    }
}

/// Observed value of a shared unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// Unknown.
    pub parameter: Parameter,
    /// Value, in the unit of the unknown.
    pub value: f64,
    /// σ, in the unit of the unknown.
    pub sigma: f64,
}
