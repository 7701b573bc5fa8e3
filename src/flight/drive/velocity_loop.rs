//! The velocity loop: from set point and reading to the duty of the motor, arithmetic alone.

use super::loop_settings::LoopSettings;
use crate::flight::stage::Setpoint;

/// Below this error of speed a stage inside the rest band is at rest, mm/s.
const REST_SPEED_MM_S: f32 = 1.0;

/// Learning stops beyond this following error, mm: something else is wrong then.
const LEARNING_ERROR_MM: f32 = 0.05;

/// Speed at which viscous friction is learned as fast as Coulomb friction, mm/s.
const LEARNING_SPEED_MM_S: f32 = 20.0;

/// The same for the mass, mm/s².
const LEARNING_ACCELERATION_MM_S2: f32 = 1000.0;

/// A cascade: following error to speed, speed error to duty, with the known forces fed forward.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityLoop {
    settings: LoopSettings,
    feed: Feed,
    last: Option<Last>,
    slope_mm_s: f32,
    integral: f32,
    resting: bool,
}

/// Duty per what is known of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Feed {
    per_speed: f32,
    per_acceleration: f32,
    friction: f32,
}

/// The last call.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Last {
    error_mm: f32,
    /// The speed that its acceleration leads to, when the next duty acts.
    next_speed_mm_s: f32,
}

impl VelocityLoop {
    /// A loop that has seen nothing yet; settings are those that
    /// [`LoopSettings::checked`] lets pass.
    #[must_use]
    pub const fn new(settings: LoopSettings) -> Self {
        Self {
            settings,
            feed: Feed {
                per_speed: settings.speed_feed_per_mm_s,
                per_acceleration: settings.acceleration_feed_per_mm_s2,
                friction: settings.friction_feed,
            },
            last: None,
            slope_mm_s: 0.0,
            integral: 0.0,
            resting: false,
        }
    }

    /// Forgets where the stage was: before a motion that is no continuation of the last. What it has learned stays.
    pub const fn restart(&mut self) {
        self.last = None;
        self.slope_mm_s = 0.0;
        self.integral = 0.0;
        self.resting = false;
    }

    /// The duty for the time until the next call, -1 to 1, positive along the FMC axis.
    pub fn duty(&mut self, setpoint: Setpoint, measured_offset_mm: f32, dt_s: f32) -> f32 {
        let settings = self.settings;
        let age_s = settings.reading_age_s;
        let (speed, acceleration) = (setpoint.speed_mm_s, setpoint.acceleration_mm_s2);
        let moved_since_mm = age_s * (speed - 0.5 * acceleration * age_s);
        let error_mm = setpoint.offset_mm - moved_since_mm - measured_offset_mm;
        let next_speed_mm_s = speed + acceleration * (dt_s + settings.duty_delay_s);
        let last = self.last.replace(Last {
            error_mm,
            next_speed_mm_s,
        });
        let mut push_mm_s2 = acceleration;
        if let Some(last) = last
            && dt_s > 0.0
        {
            let slope_mm_s = (error_mm - last.error_mm) / dt_s;
            self.slope_mm_s += settings.slope_weight * (slope_mm_s - self.slope_mm_s);
            push_mm_s2 = (next_speed_mm_s - last.next_speed_mm_s) / dt_s;
        }

        let at_rest = speed.abs() + acceleration.abs() + push_mm_s2.abs() <= 0.0;
        if self.rests(at_rest, error_mm) {
            self.integral = 0.0;
            return 0.0;
        }

        let speed_error = settings.position_gain_per_s * error_mm + self.slope_mm_s;
        let mean_speed = speed + acceleration * (0.5 * dt_s + settings.duty_delay_s);
        let direction = if speed.abs() > 0.0 {
            sign(speed)
        } else {
            sign(acceleration)
        };
        let known = self.feed.per_speed * mean_speed
            + self.feed.per_acceleration * push_mm_s2
            + self.feed.friction * direction;
        // The gain is for the mass that has been learned.
        let gain = settings.speed_gain_per_mm_s * self.mass_ratio();
        let corrected = gain * speed_error + self.integral;
        let step = gain * settings.integral_rate_per_s * speed_error * dt_s;
        let free = known + corrected;
        let max = settings.max_duty;
        if free.abs() <= max || free * step < 0.0 {
            self.integral = limited(self.integral + step, max);
        }
        if free.abs() <= max && error_mm.abs() <= LEARNING_ERROR_MM && !at_rest {
            self.learn(direction, mean_speed, push_mm_s2, corrected * dt_s);
        }
        let duty = limited(free, max);
        if duty.is_finite() {
            duty
        } else {
            *self = Self::new(settings);
            0.0
        }
    }

    fn learn(&mut self, direction: f32, speed_mm_s: f32, push_mm_s2: f32, corrected_s: f32) {
        let settings = &self.settings;
        let speed = speed_mm_s / LEARNING_SPEED_MM_S;
        let push = push_mm_s2 / LEARNING_ACCELERATION_MM_S2;
        let step = settings.learning_rate_per_s * corrected_s / (1.0 + speed * speed + push * push);
        let feed = &mut self.feed;
        feed.friction = near(feed.friction + step * direction, settings.friction_feed);
        feed.per_speed = near(
            feed.per_speed + step * speed / LEARNING_SPEED_MM_S,
            settings.speed_feed_per_mm_s,
        );
        feed.per_acceleration = near(
            feed.per_acceleration + step * push / LEARNING_ACCELERATION_MM_S2,
            settings.acceleration_feed_per_mm_s2,
        );
    }

    /// The mass that has been learned, in parts of that of the settings.
    fn mass_ratio(&self) -> f32 {
        let set = self.settings.acceleration_feed_per_mm_s2;
        if set > 0.0 {
            self.feed.per_acceleration / set
        } else {
            1.0
        }
    }

    /// Whether the stage may stay where it is.
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

/// Not less than half and not more than twice the setting.
fn near(value: f32, setting: f32) -> f32 {
    if value > 2.0 * setting {
        2.0 * setting
    } else if value < 0.5 * setting {
        0.5 * setting
    } else {
        value
    }
}

fn sign(value: f32) -> f32 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// `f32::clamp` panics where the limits are no numbers.
fn limited(value: f32, max: f32) -> f32 {
    if value > max {
        max
    } else if value < -max {
        -max
    } else {
        value
    }
}
