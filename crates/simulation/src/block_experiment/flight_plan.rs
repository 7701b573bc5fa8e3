//! Flight plan of a block: stations of the exposures, strip after strip.

use fmc_camera_file::CameraFile;

use super::scenario_file::{FlightTable, ScenarioFile};
use crate::range::whole;

/// A planned exposure.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// Number of the frame, from 1.
    pub frame: u32,
    /// Name of the strip.
    pub strip: Box<str>,
    /// Projection centre when the shutter opens, m.
    pub position_m: [f64; 3],
    /// Velocity over ground, m/s.
    pub velocity_m_s: [f64; 3],
}

impl Station {
    /// Speed over ground, m/s.
    #[must_use]
    pub fn speed_m_s(&self) -> f64 {
        let [x, y, _] = self.velocity_m_s;
        x.hypot(y)
    }

    /// Yaw of the FMC axis, which points ahead, °: counter-clockwise from the ground frame's y.
    #[must_use]
    pub fn yaw_deg(&self) -> f64 {
        let [x, y, _] = self.velocity_m_s;
        (-x).atan2(y).to_degrees()
    }
}

/// Stations of a block, and the ground that a frame shows.
#[derive(Debug, Clone, PartialEq)]
pub struct FlightPlan {
    /// Stations, in the order of flight.
    pub stations: Vec<Station>,
    /// Length and width of a frame on the mean terrain, along and across its strip, m.
    pub footprint_m: [f64; 2],
    /// Length and width of the rectangle of the stations, m.
    pub size_m: [f64; 2],
}

/// Returns the speeds over ground downwind, upwind and across the wind, m/s.
///
/// The wind blows along the strips; across them, the aircraft turns into it.
pub(super) fn ground_speeds_m_s(flight: &FlightTable) -> [f64; 3] {
    let FlightTable {
        speed_m_s: air,
        wind_m_s: wind,
        ..
    } = *flight;
    [
        air + wind,
        air - wind,
        ((air - wind) * (air + wind)).max(0.0).sqrt(),
    ]
}

impl FlightPlan {
    /// Plans a block: strips to and fro along x, the first one downwind, then cross strips to and
    /// fro along y.
    pub(super) fn new(scenario: &ScenarioFile, camera: &CameraFile) -> Self {
        let block = &scenario.block;
        let height_m = scenario.flight.height_m;
        let scale = (height_m - scenario.terrain.height_m) / camera.principal_distance_mm;
        let ([ex, ey], [half_x, half_y]) = (camera.fmc.axis.unit(), camera.half_format_mm());
        let along = 2.0 * scale * (ex.abs() * half_x + ey.abs() * half_y);
        let across = 2.0 * scale * (ey.abs() * half_x + ex.abs() * half_y);
        let apart = |percent: i64| 1.0 - whole(percent) / 100.0;
        let base = along * apart(block.forward_overlap_percent);
        let distance = across * apart(block.side_overlap_percent);
        let size_m = [
            base * whole(block.frames - 1),
            distance * whole(block.strips - 1),
        ];
        let [length, width] = size_m;
        let [downwind, upwind, crosswind] = ground_speeds_m_s(&scenario.flight);
        let mut stations = Vec::new();
        let mut add = |strip: &str, [x, y]: [f64; 2], [vx, vy]: [f64; 2]| {
            let frame = u32::try_from(stations.len() + 1).unwrap_or(u32::MAX);
            stations.push(Station {
                frame,
                strip: strip.into(),
                position_m: [x, y, height_m],
                velocity_m_s: [vx, vy, 0.0],
            });
        };
        for strip in 0..block.strips {
            let name = format!("s{}", strip + 1);
            for place in 0..block.frames {
                let (x, speed) = if strip % 2 == 0 {
                    (base * whole(place), downwind)
                } else {
                    (length - base * whole(place), -upwind)
                };
                add(&name, [x, distance * whole(strip)], [speed, 0.0]);
            }
        }
        let frames = 2 + steps(width / base);
        for strip in 0..block.cross_strips {
            let name = format!("c{}", strip + 1);
            let x = length * (whole(strip) + 0.5) / whole(block.cross_strips);
            for place in 0..frames {
                let from_first = width * f64::from(place) / f64::from(frames - 1);
                let (y, speed) = if strip % 2 == 0 {
                    (from_first, crosswind)
                } else {
                    (width - from_first, -crosswind)
                };
                add(&name, [x, y], [0.0, speed]);
            }
        }
        Self {
            stations,
            footprint_m: [along, across],
            size_m,
        }
    }
}

/// Returns the whole steps in a distance, counted in steps.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "not negative; at most 20 strips of a few steps each"
)]
fn steps(distance: f64) -> u32 {
    distance.max(0.0).floor() as u32
}
