//! Aircraft: position, attitude and true V/H.

use fmc_camera::flight::event::AttitudeSample;
use fmc_camera_file::number::single;

use super::file::DirectionName;
use super::scenario::MissionScenario;
use crate::scene::attitude::Attitude;
use crate::scene::terrain::Terrain;
use crate::scene::trajectory::Trajectory;
use crate::scene::turbulence::{Spectrum, Turbulence};

/// Frequency below which the camera's mount takes rotations out, Hz, so that the angles stay small
/// over a long flight.
const LEVELLED_BELOW_HZ: f64 = 0.05;

/// Aircraft and ground of a mission; the same seed gives the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Aircraft {
    /// Path of the projection centre.
    pub trajectory: Trajectory,
    /// Attitude of the camera.
    pub attitude: Attitude,
    /// The ground.
    pub terrain: Terrain,
}

/// True speed and height at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedAndHeight {
    /// Ground speed, m/s.
    pub ground_speed_m_s: f64,
    /// Height of the lens above sea level, m.
    pub altitude_m: f64,
    /// Height of the ground below the lens above sea level, m.
    pub terrain_m: f64,
}

impl SpeedAndHeight {
    /// Returns the height above the ground below, m.
    #[must_use]
    pub fn height_above_ground_m(&self) -> f64 {
        self.altitude_m - self.terrain_m
    }

    /// η: the true V/H, 1/s.
    #[must_use]
    pub fn vh_per_s(&self) -> f64 {
        self.ground_speed_m_s / self.height_above_ground_m()
    }
}

impl Aircraft {
    /// Creates the aircraft of a scenario, which flies along the ground frame's y, or against it in
    /// reverse, over the crests and troughs of the terrain.
    #[must_use]
    pub fn of(scenario: &MissionScenario, seed: u64) -> Self {
        let written = &scenario.written;
        let (air, turn) = (&written.air, &written.attitude);
        // Seeds of the six processes, distinct from those of neighbouring flights.
        let process = |stream: u64, rms: f64, corner_hz: f64| {
            if rms > 0.0 {
                let spectrum = Spectrum { rms, corner_hz };
                Turbulence::new(spectrum, seed.wrapping_mul(64).wrapping_add(stream))
            } else {
                Turbulence::still()
            }
        };
        let [cross, along, vertical] = air.gust_rms_m_s;
        let [pitch, roll, yaw] = turn.rate_rms_deg_s;
        let speed_m_s = match written.flight.direction {
            Some(DirectionName::Reverse) => -written.flight.speed_m_s,
            Some(DirectionName::Forward) | None => written.flight.speed_m_s,
        };
        let mut trajectory = Trajectory::level(written.flight.height_m, speed_m_s);
        trajectory.position_m[0] = written.terrain.wavelength_m / 4.0;
        trajectory.gusts = [
            process(1, cross, air.gust_corner_hz),
            process(2, along, air.gust_corner_hz),
            process(3, vertical, air.gust_corner_hz),
        ];
        Self {
            trajectory,
            attitude: Attitude {
                yaw_deg: turn.drift_deg,
                pitch_deg: turn.pitch_deg,
                roll_deg: turn.roll_deg,
                reference_s: 0.0,
                rates_deg_s: [0.0; 3],
                turbulence: [
                    process(4, pitch, turn.rate_corner_hz).above(LEVELLED_BELOW_HZ),
                    process(5, roll, turn.rate_corner_hz).above(LEVELLED_BELOW_HZ),
                    process(6, yaw, turn.rate_corner_hz).above(LEVELLED_BELOW_HZ),
                ],
            },
            terrain: Terrain::Hills {
                height_m: written.terrain.height_m,
                amplitude_m: written.terrain.relief_m,
                wavelength_m: [written.terrain.wavelength_m; 2],
            },
        }
    }

    /// Returns speed and height at a time, s.
    #[must_use]
    pub fn speed_and_height(&self, time_s: f64) -> SpeedAndHeight {
        let [x, y, altitude_m] = self.trajectory.position_at(time_s);
        let [across, along, _] = self.trajectory.velocity_at(time_s);
        SpeedAndHeight {
            ground_speed_m_s: across.hypot(along),
            altitude_m,
            terrain_m: self.terrain.height_m(x, y),
        }
    }

    /// Returns attitude and rates at a time, s, as an inertial unit reports them.
    #[must_use]
    pub fn attitude_sample(&self, time_s: f64) -> AttitudeSample {
        let [pitch, roll, yaw] = &self.attitude.turbulence;
        let turned = |process: &Turbulence| process.integral(time_s);
        AttitudeSample {
            pitch_deg: single(self.attitude.pitch_deg + turned(pitch)),
            roll_deg: single(self.attitude.roll_deg + turned(roll)),
            drift_deg: single(self.attitude.yaw_deg + turned(yaw)),
            rates_deg_s: [pitch, roll, yaw].map(|process| single(process.value(time_s))),
        }
    }
}
