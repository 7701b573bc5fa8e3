//! Simulated flights with known truth: observed positions and attitudes that differ from those of
//! the camera by time offset, lever arm, boresight and shifts of the strips.

use std::collections::HashMap;

use fastrand::Rng;
use fmc_adjustment::bundle::interior::InteriorElement;
use fmc_adjustment::bundle::network::Network;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::orientation::network_orientation::orient;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::pose::Pose;
use fmc_adjustment::bundle::tables::{
    ImagePointRow, ImageRow, NetworkTables, ObjectPointRow, RowRole, Table,
};
use nalgebra::{Rotation3, Vector3};

use crate::data::ideal;
use crate::simulated::normal;

/// Principal distance, mm; half format, mm; flying height, m.
pub(crate) const F_MM: f64 = 50.0;
const HALF_MM: [f64; 2] = [26.7, 20.0];
const HEIGHT_M: f64 = 700.0;

/// σ of image points, mm, of control, m, of positions, m, and of pitch, roll and yaw, degrees.
const SIGMA_MM: f64 = 1e-3;
const CONTROL_M: f64 = 0.02;
const GNSS_M: f64 = 0.03;
const ANGLE_DEG: f64 = 0.003;

/// A strip: heading, degrees, and speed, m/s.
pub(crate) type Strip = [f64; 2];

/// Differences of observed positions and attitudes from those of the camera.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Platform {
    pub(crate) time_offset_s: f64,
    pub(crate) lever_arm_m: [f64; 3],
    pub(crate) boresight_rad: [f64; 3],
    /// Shift of each strip, m, as a function of its number.
    pub(crate) shift_m: [f64; 3],
}

impl Platform {
    /// Returns the true value of an unknown.
    pub(crate) fn value(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::Interior(InteriorElement::PrincipalDistance) => F_MM,
            Parameter::TimeOffset => self.time_offset_s,
            Parameter::LeverArm(axis) => self.lever_arm_m[axis],
            Parameter::Boresight(axis) => self.boresight_rad[axis],
            Parameter::Shift { strip, axis } => self.shift(strip)[axis],
            _ => 0.0,
        }
    }

    fn shift(&self, strip: usize) -> Vector3<f64> {
        let sign = if strip.is_multiple_of(2) { 1.0 } else { -0.5 };
        sign * Vector3::from(self.shift_m)
    }
}

/// A flight over one field, six images in each strip.
#[derive(Debug, Clone)]
pub(crate) struct Flight {
    pub(crate) strips: Vec<Strip>,
    pub(crate) platform: Platform,
    /// Random tilt of the camera, rad.
    pub(crate) tilt_rad: f64,
    /// Number of control points.
    pub(crate) control: usize,
}

/// To and fro along both axes, with different speeds.
pub(crate) const CROSSED: [Strip; 4] = [[0.0, 60.0], [180.0, 85.0], [90.0, 70.0], [270.0, 75.0]];

fn count(number: usize) -> f64 {
    f64::from(u32::try_from(number).unwrap())
}

impl Flight {
    /// Returns the files of the flight.
    pub(crate) fn tables(&self, seed: u64) -> NetworkTables {
        let mut random = Rng::with_seed(seed);
        // The field does not depend on the seed.
        let mut field = Rng::with_seed(5);
        let points: Vec<Vector3<f64>> = (0..90)
            .map(|_| {
                Vector3::new(
                    900.0 * (field.f64() - 0.5),
                    900.0 * (field.f64() - 0.5),
                    80.0 * field.f64(),
                )
            })
            .collect();
        let mut rays = Vec::new();
        let mut images = Vec::new();
        for (strip, [heading, speed]) in self.strips.iter().enumerate() {
            let yaw = -heading.to_radians();
            let along = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
            for place in 0..6 {
                let name: Box<str> = format!("s{strip}i{place}").into();
                let aside = 160.0 * (count(strip) - 0.5 * count(self.strips.len() - 1)) / 2.0;
                let tilt = Vector3::from_fn(|_, _| self.tilt_rad * normal(&mut field));
                let pose = Pose {
                    position_m: along * Vector3::new(aside, 150.0 * (count(place) - 2.5), HEIGHT_M),
                    rotation: along * Rotation3::from_scaled_axis(tilt),
                };
                for (number, ground) in points.iter().enumerate() {
                    let u = pose.in_camera(ground);
                    let [x, y] = [-F_MM * u.x / u.z, -F_MM * u.y / u.z];
                    if x.abs() < HALF_MM[0] && y.abs() < HALF_MM[1] {
                        let measured = [x, y].map(|mm| mm + SIGMA_MM * normal(&mut random));
                        rays.push((name.clone(), number, measured));
                    }
                }
                let velocity = along * Vector3::new(0.0, *speed, 0.0);
                images.push(self.observed(name, strip, &pose, velocity, &mut random));
            }
        }
        let seen = |number: usize| rays.iter().filter(|(_, other, _)| *other == number).count();
        let image_points = rays
            .iter()
            .filter(|(_, number, _)| seen(*number) > 1)
            .zip(2..)
            .map(|((image, number, measured), line)| ImagePointRow {
                line,
                image: image.clone(),
                point: format!("p{number}").into(),
                measured_mm: *measured,
                sigma_mm: Some(SIGMA_MM),
            })
            .collect();
        let object_points = (0..points.len())
            .step_by(points.len() / self.control.max(1))
            .take(self.control)
            .zip(2..)
            .map(|(number, line)| ObjectPointRow {
                line,
                point: format!("p{number}").into(),
                position_m: (points[number]
                    + Vector3::from_fn(|_, _| CONTROL_M * normal(&mut random)))
                .into(),
                sigmas_m: [CONTROL_M; 3],
                role: RowRole::Control,
            })
            .collect();
        NetworkTables {
            image_points: Table {
                file: "image_points.csv".to_owned(),
                rows: image_points,
            },
            object_points: Table {
                file: "control.csv".to_owned(),
                rows: object_points,
            },
            images: Some(Table {
                file: "images.csv".to_owned(),
                rows: images,
            }),
            scale_bars: None,
            stages: HashMap::new(),
        }
    }

    /// Returns what is observed on board at a pose of the camera.
    fn observed(
        &self,
        image: Box<str>,
        strip: usize,
        pose: &Pose,
        velocity: Vector3<f64>,
        random: &mut Rng,
    ) -> ImageRow {
        let platform = &self.platform;
        let arm = pose.rotation * Vector3::from(platform.lever_arm_m);
        let noise = Vector3::from_fn(|_, _| GNSS_M * normal(random));
        let position =
            pose.position_m - velocity * platform.time_offset_s - arm - platform.shift(strip)
                + noise;
        let boresight = Rotation3::from_scaled_axis(Vector3::from(platform.boresight_rad));
        let turned = Pose {
            position_m: position,
            rotation: pose.rotation * boresight,
        };
        let attitude = turned.orientation().attitude.map(f64::to_degrees);
        ImageRow {
            line: 0,
            image,
            position_m: position.into(),
            attitude_deg: attitude.map(|angle| angle + ANGLE_DEG * normal(random)),
            sigmas: [GNSS_M, GNSS_M, GNSS_M, ANGLE_DEG, ANGLE_DEG, ANGLE_DEG].map(Some),
            velocity_m_s: Some(velocity.into()),
            strip: Some(format!("s{strip}").into()),
        }
    }

    /// Returns the oriented network.
    pub(crate) fn network(&self, seed: u64, estimated: &[Parameter]) -> Network {
        let unknowns = Unknowns {
            estimated: estimated.to_vec(),
            priors: Vec::new(),
        };
        let mut tabled = self.tables(seed).network(ideal(F_MM), &unknowns).unwrap();
        let unoriented = orient(&mut tabled.network, tabled.known.clone());
        assert_eq!(unoriented.images, [0; 0]);
        assert_eq!(unoriented.points, [0; 0]);
        tabled.network
    }
}
