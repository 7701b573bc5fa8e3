//! Force that is known beforehand: friction, damping and mass, learned in motion.

use super::feed_forward_motion::FeedForward;
use super::loop_settings::LoopSettings;

/// Speed below which the stage counts as standing, mm/s.
pub(super) const STANDING_MM_S: f32 = 0.05;

/// Speed at which damping is learned as fast as friction, mm/s.
const LEARNING_SPEED_MM_S: f32 = 20.0;

/// Acceleration at which the mass is learned as fast as friction, mm/s².
const LEARNING_ACCELERATION_MM_S2: f32 = 1000.0;

/// Bounds of the learned values, as parts of the settings.
const LEAST: f32 = 0.5;
const MOST: f32 = 2.0;

/// Duty per friction, speed and acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KnownForce {
    per_speed: f32,
    per_acceleration: f32,
    friction: f32,
}

impl KnownForce {
    pub(super) const fn new(settings: &LoopSettings) -> Self {
        Self {
            per_speed: settings.speed_feed_per_mm_s,
            per_acceleration: settings.acceleration_feed_per_mm_s2,
            friction: settings.friction_feed,
        }
    }

    /// The duty for a tick.
    pub(super) fn duty(&self, lead: &FeedForward) -> f32 {
        self.per_speed * lead.speed_mm_s
            + self.per_acceleration * lead.push_mm_s2
            + self.friction * direction(lead.speed_mm_s)
    }

    /// Learns from what the feedback had to add, duty times seconds.
    ///
    /// # Model
    /// Feedback-error learning: `dθ/dt = λ·φ·u_fb/|φ|²`, with φ the direction, speed and
    /// acceleration in parts of what is usual (Kawato, Furukawa and Suzuki, Biological Cybernetics
    /// 57 (1987) 169). Each value stays between half and twice its setting, so that a jam has no
    /// lasting effect on it.
    pub(super) fn learn(&mut self, settings: &LoopSettings, lead: &FeedForward, added_s: f32) {
        let direction = direction(lead.speed_mm_s);
        let speed = lead.speed_mm_s / LEARNING_SPEED_MM_S;
        let push = lead.push_mm_s2 / LEARNING_ACCELERATION_MM_S2;
        let step = settings.learning_rate_per_s * added_s / (1.0 + speed * speed + push * push);
        self.friction = near(self.friction + step * direction, settings.friction_feed);
        self.per_speed = near(
            self.per_speed + step * speed / LEARNING_SPEED_MM_S,
            settings.speed_feed_per_mm_s,
        );
        self.per_acceleration = near(
            self.per_acceleration + step * push / LEARNING_ACCELERATION_MM_S2,
            settings.acceleration_feed_per_mm_s2,
        );
    }

    /// The learned mass, in parts of that of the settings.
    pub(super) fn mass_ratio(&self, settings: &LoopSettings) -> f32 {
        let set = settings.acceleration_feed_per_mm_s2;
        if set > 0.0 {
            self.per_acceleration / set
        } else {
            1.0
        }
    }
}

fn direction(speed_mm_s: f32) -> f32 {
    if speed_mm_s > STANDING_MM_S {
        1.0
    } else if speed_mm_s < -STANDING_MM_S {
        -1.0
    } else {
        0.0
    }
}

fn near(value: f32, setting: f32) -> f32 {
    if value > MOST * setting {
        MOST * setting
    } else if value < LEAST * setting {
        LEAST * setting
    } else {
        value
    }
}
