//! Path of the projection centre.

use super::turbulence::Turbulence;

/// Uniform flight with gusts.
///
/// Ground frame: x, y horizontal, z up, right-handed, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    /// Projection centre at time 0, m.
    pub position_m: [f64; 3],
    /// Mean velocity, m/s.
    pub velocity_m_s: [f64; 3],
    /// Velocity that gusts add, m/s per axis.
    pub gusts: [Turbulence; 3],
}

impl Trajectory {
    /// Creates a level flight along y in still air, over the origin at time 0.
    #[must_use]
    pub const fn level(height_m: f64, speed_m_s: f64) -> Self {
        Self {
            position_m: [0.0, 0.0, height_m],
            velocity_m_s: [0.0, speed_m_s, 0.0],
            gusts: [const { Turbulence::still() }; 3],
        }
    }

    /// Returns the projection centre at a time, m.
    #[must_use]
    pub fn position_at(&self, time_s: f64) -> [f64; 3] {
        let mut position_m = self.position_m;
        for ((place, speed), gust) in position_m
            .iter_mut()
            .zip(self.velocity_m_s)
            .zip(&self.gusts)
        {
            *place += speed * time_s + gust.integral(time_s);
        }
        position_m
    }

    /// Returns the velocity at a time, m/s.
    #[must_use]
    pub fn velocity_at(&self, time_s: f64) -> [f64; 3] {
        let mut velocity_m_s = self.velocity_m_s;
        for (speed, gust) in velocity_m_s.iter_mut().zip(&self.gusts) {
            *speed += gust.value(time_s);
        }
        velocity_m_s
    }

    /// Highest frequency of the gusts, Hz.
    pub(super) fn highest_hz(&self) -> f64 {
        self.gusts
            .iter()
            .map(Turbulence::highest_hz)
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::turbulence::Spectrum;

    #[test]
    fn velocity_is_the_rate_of_the_position_gusts_included() {
        let mut flight = Trajectory::level(1000.0, 80.0);
        for (seed, gust) in (5..).zip(&mut flight.gusts) {
            let spectrum = Spectrum {
                rms: 2.0,
                corner_hz: 0.1,
            };
            *gust = Turbulence::new(spectrum, seed);
        }
        let (before, after) = (flight.position_at(1.999), flight.position_at(2.001));
        let velocity = flight.velocity_at(2.0);
        for axis in 0..3 {
            let rate = (after[axis] - before[axis]) / 2e-3;
            assert!((rate - velocity[axis]).abs() < 1e-3);
        }
        assert!((flight.position_at(0.0)[2] - 1000.0).abs() < 1e-12);
    }
}
