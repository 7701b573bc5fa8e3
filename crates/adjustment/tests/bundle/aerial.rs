//! Simulated flights with known truth: observed positions and attitudes that differ from those of
//! the camera by time offset, lever arm, boresight and shifts of the strips.

use std::collections::HashMap;

use fastrand::Rng;
use fmc_adjustment::bundle::interior::{Interior, InteriorElement};
use fmc_adjustment::bundle::network::Network;
use fmc_adjustment::bundle::network_of_tables::Unknowns;
use fmc_adjustment::bundle::orientation::network_orientation::orient;
use fmc_adjustment::bundle::parameters::Parameter;
use fmc_adjustment::bundle::pose::Pose;
use fmc_adjustment::bundle::records::{FlightRecords, RecordRow};
use fmc_adjustment::bundle::stage::Stage;
use fmc_adjustment::bundle::tables::{
    ImagePointRow, ImageRow, NetworkTables, ObjectPointRow, RowRole, Table,
};
use fmc_reference::residual_splines::ResidualSplines;
use nalgebra::{Rotation2, Rotation3, Vector2, Vector3};

use crate::data::ideal;
use crate::simulated::normal;

/// Principal distance, mm; half format, mm.
pub(crate) const F_MM: f64 = 50.0;
const HALF_MM: [f64; 2] = [26.7, 20.0];

/// e: direction in which the principal point moves, that of the flight.
const DIRECTION: [f64; 2] = [0.0, 1.0];

/// Focus shift of every record, mm.
const FOCUS_MM: f64 = 0.002;

/// Acceleration of the stage, mm/s², and settling time, s: run-up from rest.
const ACCELERATION_MM_S2: f64 = 1000.0;
const SETTLING_S: f64 = 0.005;

/// σ of image points, mm, of control, m, of positions, m, and of pitch, roll and yaw, degrees.
const SIGMA_MM: f64 = 1e-3;
const CONTROL_M: f64 = 0.02;
const GNSS_M: f64 = 0.03;
const ANGLE_DEG: f64 = 0.003;

/// A strip.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Strip {
    pub(crate) heading_deg: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) height_m: f64,
    pub(crate) exposure_s: f64,
}

/// Returns a strip 700 m above ground with exposures of 1/300 s.
pub(crate) const fn strip(heading_deg: f64, speed_m_s: f64) -> Strip {
    Strip {
        heading_deg,
        speed_m_s,
        height_m: 700.0,
        exposure_s: 1.0 / 300.0,
    }
}

impl Strip {
    /// v: speed of the detector, mm/s.
    fn rate_mm_s(&self) -> f64 {
        F_MM * self.speed_m_s / self.height_m
    }

    /// c at the centroid of the exposure, mm: run-up from rest, settling, half the exposure.
    fn centroid_mm(&self) -> f64 {
        let v = self.rate_mm_s();
        v * v / (2.0 * ACCELERATION_MM_S2) + v * (SETTLING_S + 0.5 * self.exposure_s)
    }
}

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
    /// True stage; `None` for a principal point that stays.
    pub(crate) stage: Option<Stage>,
}

/// To and fro along both axes, with different speeds.
pub(crate) const CROSSED: [Strip; 4] = [
    strip(0.0, 60.0),
    strip(180.0, 85.0),
    strip(90.0, 70.0),
    strip(270.0, 75.0),
];

/// Number of images of a strip.
const PLACES: usize = 6;

fn count(number: usize) -> f64 {
    f64::from(u32::try_from(number).unwrap())
}

/// Exposure of a flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Station {
    /// Number of the strip.
    strip: usize,
    /// Lens and attitude at the centroid.
    pub(crate) pose: Pose,
    /// m/s.
    velocity: Vector3<f64>,
}

impl Flight {
    /// Returns the points of the field, which does not depend on the seed, and the exposures, in
    /// the order of the names of their images.
    pub(crate) fn field(&self) -> (Vec<Vector3<f64>>, Vec<Station>) {
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
        let mut stations = Vec::new();
        for (strip, flown) in self.strips.iter().enumerate() {
            let yaw = -flown.heading_deg.to_radians();
            let along = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw);
            for place in 0..PLACES {
                let aside = 160.0 * (count(strip) - 0.5 * count(self.strips.len() - 1)) / 2.0;
                let tilt = Vector3::from_fn(|_, _| self.tilt_rad * normal(&mut field));
                stations.push(Station {
                    strip,
                    pose: Pose {
                        position_m: along
                            * Vector3::new(aside, 150.0 * (count(place) - 2.5), flown.height_m),
                        rotation: along * Rotation3::from_scaled_axis(tilt),
                    },
                    velocity: along * Vector3::new(0.0, flown.speed_m_s, 0.0),
                });
            }
        }
        (points, stations)
    }

    /// Returns the files of the flight.
    pub(crate) fn tables(&self, seed: u64) -> NetworkTables {
        let mut random = Rng::with_seed(seed);
        let (points, stations) = self.field();
        let mut rays = Vec::new();
        let mut images = Vec::new();
        for (number, station) in stations.iter().enumerate() {
            let name: Box<str> = number.to_string().into();
            let (pose, velocity) = (&station.pose, station.velocity);
            let flown = &self.strips[station.strip];
            for (number, ground) in points.iter().enumerate() {
                let [x, y] = self.image_mm(flown, pose, velocity, ground);
                if x.abs() < HALF_MM[0] && y.abs() < HALF_MM[1] {
                    let measured = [x, y].map(|mm| mm + SIGMA_MM * normal(&mut random));
                    rays.push((name.clone(), number, measured));
                }
            }
            images.push(self.observed(name, station.strip, pose, velocity, &mut random));
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
                by_grids_mm: [0.0; 2],
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

    /// Returns the place of a ground point, with a stage the mean over the exposure, mm: Gauss and
    /// Legendre with three nodes, exact to the fifth power of time.
    fn image_mm(
        &self,
        flown: &Strip,
        pose: &Pose,
        velocity: Vector3<f64>,
        ground: &Vector3<f64>,
    ) -> [f64; 2] {
        let at = |pose: &Pose| {
            let u = pose.in_camera(ground);
            -F_MM * u.xy() / u.z
        };
        let Some(stage) = self.stage else {
            return at(pose).into();
        };
        let half = 0.5 * flown.exposure_s;
        let nodes = [(-half, 5.0), (0.0, 8.0), (half, 5.0)];
        let turn = Rotation2::new(stage.axis_angle_rad);
        let axis = turn * Vector2::from(DIRECTION);
        let mut mean = Vector2::zeros();
        for (time, weight) in nodes.map(|(end, weight)| (0.6_f64.sqrt() * end, weight / 18.0)) {
            let c = flown.centroid_mm() + flown.rate_mm_s() * time;
            let moved = Pose {
                position_m: pose.position_m + velocity * time,
                ..*pose
            };
            let enlarged = 1.0 + (FOCUS_MM + stage.run_out_mm_per_mm * c) / F_MM;
            mean += weight * ((1.0 + stage.scale) * c * axis + enlarged * at(&moved));
        }
        mean.into()
    }

    /// Returns the tables reduced by the records of the flight.
    pub(crate) fn with_records(&self, seed: u64) -> NetworkTables {
        self.records().reduced(&self.tables(seed)).unwrap()
    }

    /// Returns the records of the flight.
    pub(crate) fn records(&self) -> FlightRecords {
        let strips = self.strips.iter().enumerate();
        let rows = strips.flat_map(|(strip, flown)| {
            (0..PLACES).map(move |place| RecordRow {
                line: 0,
                sequence: u32::try_from(PLACES * strip + place).unwrap(),
                is_exposed: true,
                offset_mm: flown.centroid_mm(),
                sigma_mm: 0.0,
                enlargement: FOCUS_MM / F_MM,
                centroid_after_trigger_s: None,
            })
        });
        FlightRecords {
            table: Table {
                file: "records.csv".to_owned(),
                rows: rows.collect(),
            },
            direction: DIRECTION,
            principal_point_mm: [0.0; 2],
            lever_mm: F_MM,
            grids: ResidualSplines::NONE,
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
        oriented(&self.tables(seed), &unknowns)
    }
}

/// Returns the oriented network of some tables of a camera without distortion.
pub(crate) fn oriented(tables: &NetworkTables, unknowns: &Unknowns) -> Network {
    oriented_from(tables, ideal(F_MM), unknowns)
}

/// Returns the network of some tables, oriented with an interior orientation.
pub(crate) fn oriented_from(
    tables: &NetworkTables,
    interior: Interior,
    unknowns: &Unknowns,
) -> Network {
    let mut tabled = tables.network(interior, unknowns).unwrap();
    let unoriented = orient(&mut tabled.network, tabled.known.clone());
    assert_eq!(unoriented.images, [0; 0]);
    assert_eq!(unoriented.points, [0; 0]);
    tabled.network
}
