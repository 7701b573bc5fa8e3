//! Block as flown and observed once: the tables of its adjustment and the records of its flight.

use std::collections::HashMap;

use fmc_adjustment::bundle::records::FlightRecords;
use fmc_adjustment::bundle::tables::{
    ImagePointRow, ImageRow, NetworkTables, ObjectPointRow, RowRole, Table,
};
use fmc_camera::flight::camera::FrameError;
use fmc_reference::residual_splines::ResidualSplines;

use super::flight_plan::Station;
use super::flown_image::{FlownImage, sensor_pose};
use super::ground_points::{GroundPoint, ground_points};
use super::scenario::Scenario;
use crate::noise::Noise;

/// A block with its observations. Positions are those at the centroids of the exposures.
#[derive(Debug, Clone)]
pub struct FlownBlock {
    /// Observations. Control points have errors of their σ, check points none.
    pub tables: NetworkTables,
    /// The camera's records.
    pub records: FlightRecords,
}

impl FlownBlock {
    /// Flies a block once; runs count from 1.
    ///
    /// # Errors
    /// [`FrameError`] for an exposure that the camera refuses.
    pub fn fly(scenario: &Scenario, seed: u64, run: u32) -> Result<Self, FrameError> {
        let ground = ground_points(scenario, seed);
        let mut noise = Noise::new(seed, u64::from(run));
        let mut image_points = Vec::new();
        let (mut images, mut records) = (Vec::new(), Vec::new());
        for station in &scenario.plan.stations {
            let frame = FlownImage::new(scenario, station, &mut noise)?;
            image_points.extend(recorded(scenario, station, &frame, &ground, &mut noise));
            images.push(observed(scenario, station, &frame, &mut noise));
            records.push(frame.record);
        }
        let seen = seen(&image_points, ground.len());
        image_points.retain(|(number, _)| seen.get(*number).is_some_and(|rays| *rays > 1));
        let sigma_m = scenario.written.control.sigma_m;
        let object_points = ground
            .iter()
            .zip(&seen)
            .enumerate()
            .filter(|(_, (point, rays))| point.role != RowRole::Approximate && **rays > 1)
            .map(|(number, (point, _))| {
                let sigma_m = if point.role == RowRole::Control {
                    sigma_m
                } else {
                    0.0
                };
                let [dx, dy, dz] = noise.next([sigma_m; 3]);
                let [x, y, z] = point.place_m;
                ObjectPointRow {
                    line: line(number),
                    point: name(number),
                    position_m: [x + dx, y + dy, z + dz],
                    sigmas_m: [sigma_m; 3],
                    role: point.role,
                }
            })
            .collect();
        let table_of = |rows| Table {
            file: "image_points.csv".to_owned(),
            rows,
        };
        Ok(Self {
            tables: NetworkTables {
                image_points: table_of(image_points.into_iter().map(|(_, row)| row).collect()),
                object_points: Table {
                    file: "points.csv".to_owned(),
                    rows: object_points,
                },
                images: Some(Table {
                    file: "images.csv".to_owned(),
                    rows: images,
                }),
                scale_bars: None,
                stages: HashMap::new(),
            },
            records: FlightRecords {
                table: Table {
                    file: "records.csv".to_owned(),
                    rows: records,
                },
                direction: scenario.camera.fmc.axis.unit(),
                principal_point_mm: scenario.camera.principal_point_mm,
                lever_mm: scenario.camera.exit_pupil_mm(),
                grids: ResidualSplines::NONE,
            },
        })
    }
}

/// Returns the measured image points of a frame, each with the number of its ground point.
fn recorded(
    scenario: &Scenario,
    station: &Station,
    frame: &FlownImage,
    ground: &[GroundPoint],
    noise: &mut Noise,
) -> Vec<(usize, ImagePointRow)> {
    let exposed = frame.scene.expose(0.0);
    let [along, across] = scenario.plan.footprint_m;
    // Half of the diagonal, with a quarter of it for relief and tilt.
    let reach = 0.625 * along.hypot(across);
    let sigma_mm = scenario.written.sigma.image_um / 1000.0;
    let [x, y, _] = station.position_m;
    ground
        .iter()
        .enumerate()
        .filter(|(_, point)| {
            let [u, v, _] = point.place_m;
            (u - x).hypot(v - y) < reach
        })
        .filter_map(|(number, point)| {
            let [u, v] = exposed.image_point(point.place_m)?.point_mm;
            let [du, dv] = noise.next([sigma_mm; 2]);
            let measured_mm = [u + du, v + dv];
            // At the edge an error may put a point off the sensor.
            if !frame.scene.interior.contains(measured_mm) {
                return None;
            }
            let row = ImagePointRow {
                line: line(number),
                image: station.frame.to_string().into(),
                point: name(number),
                measured_mm,
                by_grids_mm: [0.0; 2],
                sigma_mm: Some(sigma_mm),
            };
            Some((number, row))
        })
        .collect()
}

/// Returns position and attitude of a frame as observed on board.
fn observed(
    scenario: &Scenario,
    station: &Station,
    frame: &FlownImage,
    noise: &mut Noise,
) -> ImageRow {
    let exposed = frame.scene.expose(0.0);
    let true_pose = sensor_pose(
        &frame.scene,
        exposed.projection_centre_m(),
        exposed.ground_from_camera(),
    )
    .orientation();
    let sigma = &scenario.written.sigma;
    let [x, y, z] = true_pose.position_m;
    let [dx, dy, dz] = noise.next(sigma.position_m);
    let [pitch, roll, yaw] = true_pose.attitude.map(f64::to_degrees);
    let [dpitch, droll, dyaw] = noise.next(sigma.attitude_deg);
    let ([sx, sy, sz], [spitch, sroll, syaw]) = (sigma.position_m, sigma.attitude_deg);
    ImageRow {
        line: u64::from(station.frame) + 1,
        image: station.frame.to_string().into(),
        position_m: [x + dx, y + dy, z + dz],
        attitude_deg: [pitch + dpitch, roll + droll, yaw + dyaw],
        sigmas: [sx, sy, sz, spitch, sroll, syaw].map(Some),
        velocity_m_s: Some(station.velocity_m_s),
        strip: Some(station.strip.clone()),
    }
}

/// Counts the rays of every ground point.
fn seen(image_points: &[(usize, ImagePointRow)], points: usize) -> Vec<u32> {
    let mut seen = vec![0; points];
    for (number, _) in image_points {
        if let Some(rays) = seen.get_mut(*number) {
            *rays += 1;
        }
    }
    seen
}

fn name(number: usize) -> Box<str> {
    format!("p{number}").into()
}

fn line(number: usize) -> u64 {
    number as u64 + 2
}
