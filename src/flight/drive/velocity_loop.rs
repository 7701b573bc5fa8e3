//! The velocity loop: from set point and reading to the duty of the motor, arithmetic alone.

use super::feed_forward_motion::{Delays, FeedForwardMotion};
use super::known_force::{KnownForce, STANDING_MM_S};
use super::loop_settings::LoopSettings;
use crate::flight::stage::Setpoint;

/// Time until the next call, as long as nothing else is known, s.
const TICK_S: f32 = 1e-3;

/// Least time between calls, s; faster calls count as this far apart.
const SHORTEST_TICK_S: f32 = 2e-4;

/// Error of speed below which a stage inside the rest band is at rest, mm/s.
pub(crate) const REST_SPEED_MM_S: f32 = 1.0;

/// Following error beyond which learning stops, mm: something else is wrong then.
const LEARNING_ERROR_MM: f32 = 0.05;

/// A cascade: following error to speed, speed error to duty, with the known forces fed forward.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityLoop {
    settings: LoopSettings,
    known: KnownForce,
    led: FeedForwardMotion,
    last_error_mm: Option<f32>,
    slope_mm_s: f32,
    integral: f32,
    resting: bool,
}

impl VelocityLoop {
    /// Returns a loop without history; the settings are those that [`LoopSettings::checked`]
    /// accepts.
    #[must_use]
    pub fn new(settings: LoopSettings) -> Self {
        Self {
            settings,
            known: KnownForce::new(&settings),
            led: FeedForwardMotion::default(),
            last_error_mm: None,
            slope_mm_s: 0.0,
            integral: 0.0,
            resting: false,
        }
    }

    /// Forgets the stage's path before a motion that does not continue the last. The learned
    /// friction, damping and mass stay.
    pub fn restart(&mut self) {
        let known = self.known;
        *self = Self {
            known,
            ..Self::new(self.settings)
        };
    }

    /// Returns the duty for the time until the next call, -1 to 1, positive along the FMC axis.
    ///
    /// # Model
    /// `K·(w + ω_i·∫w dt) + k_v·v + k_a·a + k_f·sgn(v)` with `w = ω_p·e + de/dt` (Ellis, Control
    /// System Design Guide, 4th ed. 2012, chapter 17: position P over velocity PI, with
    /// feed-forward). e is the expected position at the reading less the reading; its slope, from
    /// one reading to the next, is the error of speed without the lag that a difference of
    /// positions has. v and a are the set point's, with corners between two ticks made up for in
    /// two ticks. `k_v`, `k_a` and `k_f` are learned from what the feedback has to add; K scales
    /// with `k_a`, the mass. The integral stands still while the duty is at its limit and the error
    /// would drive it further. At a set point at rest an error inside the rest band is tolerated,
    /// without duty, until it is twice as wide, so that the loop does not hunt over a step of the
    /// encoder.
    ///
    /// # Units and frames
    /// `measured_offset_mm` and the set point are along the FMC axis; `dt_s` is the time since the
    /// last call, 0 at the first.
    ///
    /// # Accuracy
    /// [`LoopSettings::tuned`] states the stage's following error. A set point or a reading that is
    /// not finite gives duty 0 and starts the loop afresh.
    pub fn duty(&mut self, setpoint: Setpoint, measured_offset_mm: f32, dt_s: f32) -> f32 {
        let settings = self.settings;
        let (dt_s, tick_s) = if dt_s > SHORTEST_TICK_S {
            (dt_s, dt_s)
        } else if dt_s > 0.0 {
            (dt_s, SHORTEST_TICK_S)
        } else {
            (0.0, TICK_S)
        };
        let lead = self.led.lead(
            setpoint,
            dt_s,
            Delays {
                reading: settings.reading_age_s,
                duty: settings.duty_delay_s,
                tick: tick_s,
            },
        );
        let error_mm = lead.expected_mm - measured_offset_mm;
        match self.last_error_mm.replace(error_mm) {
            Some(last_error_mm) if !lead.starts => {
                let slope_mm_s = (error_mm - last_error_mm) / tick_s;
                self.slope_mm_s += settings.slope_weight * (slope_mm_s - self.slope_mm_s);
            }
            _ => self.slope_mm_s = 0.0,
        }
        let at_rest = setpoint.is_at_rest() && lead.speed_mm_s.abs() <= STANDING_MM_S;
        if self.rests(at_rest, error_mm) {
            self.integral = 0.0;
            return 0.0;
        }

        // The gain is for the learned mass.
        let gain = settings.speed_gain_per_mm_s * self.known.mass_ratio(&settings);
        let speed_error = settings.position_gain_per_s * error_mm + self.slope_mm_s;
        let added = gain * speed_error + self.integral;
        let free = self.known.duty(&lead) + added;
        let max = settings.max_duty;
        let is_free = free.abs() <= max;
        let step = gain * settings.integral_rate_per_s * speed_error * dt_s;
        if is_free || free * step < 0.0 {
            self.integral = limited(self.integral + step, max);
        }
        if is_free && !at_rest && error_mm.abs() <= LEARNING_ERROR_MM {
            self.known.learn(&settings, &lead, added * dt_s);
        }
        let duty = limited(free, max);
        if duty.is_finite() {
            duty
        } else {
            *self = Self::new(settings);
            0.0
        }
    }

    /// Returns `true` if the stage may stay at its present position.
    fn rests(&mut self, at_rest: bool, error_mm: f32) -> bool {
        let band_mm = 1e-3 * self.settings.rest_band_um;
        self.resting = at_rest
            && if self.resting {
                error_mm.abs() <= 2.0 * band_mm
            } else {
                error_mm.abs() <= band_mm && self.slope_mm_s.abs() <= REST_SPEED_MM_S
            };
        self.resting
    }
}

/// Limits a value to ± a bound; a NaN stays one. `f32::clamp` panics if a limit is not a number.
pub(super) fn limited(value: f32, max: f32) -> f32 {
    if value > max {
        max
    } else if value < -max {
        -max
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::super::feed_forward_motion::moved;
    use super::*;

    const TICK: f32 = 1e-3;

    fn cruise(tick: u8) -> Setpoint {
        Setpoint {
            offset_mm: 0.017 * f32::from(tick),
            speed_mm_s: 17.0,
            acceleration_mm_s2: 0.0,
        }
    }

    fn exact() -> LoopSettings {
        LoopSettings {
            reading_age_s: 0.0,
            duty_delay_s: 0.0,
            ..LoopSettings::default()
        }
    }

    #[test]
    fn stage_on_its_set_point_gets_the_known_force_alone() {
        let mut velocity_loop = VelocityLoop::new(exact());
        let mut duty = 0.0;
        for tick in 0..10 {
            duty = velocity_loop.duty(cruise(tick), cruise(tick).offset_mm, TICK);
        }
        // By hand: (22 N·s/m · 0.017 m/s + 0.25 N) / 6 N.
        assert!((duty - 0.104).abs() < 1e-4, "{duty}");
    }

    #[test]
    fn reading_of_known_age_is_no_error() {
        let aged = LoopSettings {
            reading_age_s: 4e-4,
            duty_delay_s: 2e-4,
            ..LoopSettings::default()
        };
        let mut velocity_loop = VelocityLoop::new(aged);
        let mut duty = 0.0;
        for tick in 0..10 {
            duty = velocity_loop.duty(cruise(tick), cruise(tick).offset_mm - 17.0 * 4e-4, TICK);
        }
        assert!((duty - 0.104).abs() < 1e-4, "{duty}");
    }

    #[test]
    fn integral_does_not_wind_up_behind_the_limit() {
        let mut velocity_loop = VelocityLoop::new(exact());
        for tick in 0..200 {
            assert!(velocity_loop.duty(cruise(tick), 0.0, TICK) <= 1.0);
        }
        // The stage is free again and at its place: nothing is left that pushes on.
        let end = Setpoint {
            offset_mm: 3.4,
            ..Setpoint::default()
        };
        velocity_loop.duty(end, 3.4, TICK);
        assert!(velocity_loop.integral.abs() < 0.15, "{velocity_loop:?}");
        let duties = [(); 5].map(|()| velocity_loop.duty(end, 3.4, TICK));
        assert!(duties[4].abs() <= 0.0, "{duties:?}");
    }

    #[test]
    fn integral_comes_back_from_the_limit_of_the_duty_and_goes_no_further() {
        for (offset_mm, has_come_back) in [(-0.005, false), (0.005, true)] {
            let mut velocity_loop = VelocityLoop::new(exact());
            // A push that asks for more than there is: 0.3 kg at 40 m/s² of 6 N.
            let pushed = Setpoint {
                acceleration_mm_s2: 40_000.0,
                ..Setpoint::default()
            };
            velocity_loop.duty(pushed, offset_mm, 0.0);
            velocity_loop.restart();
            velocity_loop.led.lead(
                pushed,
                0.0,
                Delays {
                    reading: 0.0,
                    duty: 0.0,
                    tick: TICK,
                },
            );
            let there = moved(pushed, TICK);
            let duty = velocity_loop.duty(there, there.offset_mm + offset_mm, TICK);
            assert!(duty >= 1.0, "{duty}");
            assert_eq!(velocity_loop.integral < 0.0, has_come_back);
            assert!(velocity_loop.integral <= 0.0, "{velocity_loop:?}");
        }
    }

    #[test]
    fn call_that_comes_soon_has_its_slope_over_the_shortest_tick() {
        let mut velocity_loop = VelocityLoop::new(exact());
        velocity_loop.duty(Setpoint::default(), 0.0, TICK);
        // 5 µm in 0.1 ms count as 25 mm/s, and the whole slope is taken.
        velocity_loop.duty(Setpoint::default(), -0.005, 0.5 * SHORTEST_TICK_S);
        let slope_mm_s = velocity_loop.slope_mm_s;
        assert!((slope_mm_s - 25.0).abs() < 1e-3, "{slope_mm_s}");
    }

    #[test]
    fn rest_band_is_left_alone_until_twice_as_wide() {
        let band_mm = 1e-3 * LoopSettings::default().rest_band_um;
        let mut velocity_loop = VelocityLoop::new(exact());
        let rest = Setpoint::default();
        let errors = [
            (0.9, true),
            (1.9, true),
            (2.1, false),
            (1.5, false),
            (1.1, false),
            (0.9, true),
        ];
        for (bands, rests) in errors {
            let duty = velocity_loop.duty(rest, -bands * band_mm, TICK);
            assert_eq!(duty.abs() <= 0.0, rests, "{bands}: {duty}");
        }
    }

    #[test]
    fn what_is_no_number_moves_nothing_and_is_forgotten() {
        let mut velocity_loop = VelocityLoop::new(exact());
        velocity_loop.duty(cruise(0), 0.0, TICK);
        assert!(velocity_loop.duty(cruise(1), f32::NAN, TICK).abs() <= 0.0);
        assert_eq!(velocity_loop, VelocityLoop::new(exact()));
        for _ in 0..3 {
            assert!(velocity_loop.duty(cruise(0), 0.0, f32::NAN) > 0.0);
        }
    }
}
