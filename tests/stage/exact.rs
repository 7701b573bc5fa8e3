//! Motion in double precision: the segments of a profile one after the other, and the plans from
//! their equations.

use fmc_camera::flight::stage::{Profile, Segment, Setpoint};

/// A state of motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct State {
    pub(crate) offset: f64,
    pub(crate) speed: f64,
    pub(crate) acceleration: f64,
}

impl State {
    /// Returns offset, speed and acceleration less those of a set point.
    pub(crate) fn minus(self, setpoint: Setpoint) -> [f64; 3] {
        [
            self.offset - f64::from(setpoint.offset_mm),
            self.speed - f64::from(setpoint.speed_mm_s),
            self.acceleration - f64::from(setpoint.acceleration_mm_s2),
        ]
    }

    fn after(self, time: f64, jerk: f64) -> Self {
        Self {
            offset: self.offset
                + self.speed * time
                + self.acceleration * time * time / 2.0
                + jerk * time.powi(3) / 6.0,
            speed: self.speed + self.acceleration * time + jerk * time * time / 2.0,
            acceleration: self.acceleration + jerk * time,
        }
    }
}

impl From<Setpoint> for State {
    fn from(setpoint: Setpoint) -> Self {
        Self {
            offset: setpoint.offset_mm.into(),
            speed: setpoint.speed_mm_s.into(),
            acceleration: setpoint.acceleration_mm_s2.into(),
        }
    }
}

/// Returns the state at the end of a segment.
pub(crate) fn end_of(segment: &Segment) -> State {
    State::from(segment.start).after(segment.duration_s.into(), segment.jerk_mm_s3.into())
}

/// A motion of constant jerk after constant jerk: (duration, acceleration at its start, jerk).
pub(crate) struct Motion {
    pub(crate) start: State,
    pub(crate) segments: Vec<[f64; 3]>,
}

impl Motion {
    /// Returns the motion through the segments of a profile.
    pub(crate) fn of(profile: &Profile) -> Self {
        Self {
            start: profile.start().into(),
            segments: profile
                .segments()
                .iter()
                .map(|segment| {
                    [
                        segment.duration_s.into(),
                        segment.start.acceleration_mm_s2.into(),
                        segment.jerk_mm_s3.into(),
                    ]
                })
                .collect(),
        }
    }

    /// Returns the motion from rest at a place: acceleration to a speed, some time at it,
    /// deceleration.
    pub(crate) fn rest_to_rest(
        from: f64,
        speed: f64,
        cruise: f64,
        acceleration: f64,
        jerk: Option<f64>,
    ) -> Self {
        let (peak, rise) = match jerk {
            None => (acceleration, 0.0),
            Some(jerk) => {
                let peak = acceleration.min((speed.abs() * jerk).sqrt());
                (peak, peak / jerk)
            }
        };
        let hold = speed.abs() / peak - rise;
        let peak = peak.copysign(speed);
        let jerk = jerk.unwrap_or(0.0).copysign(speed);
        Self {
            start: State {
                offset: from,
                ..State::default()
            },
            segments: vec![
                [rise, 0.0, jerk],
                [hold, peak, 0.0],
                [rise, peak, -jerk],
                [cruise, 0.0, 0.0],
                [rise, 0.0, -jerk],
                [hold, -peak, 0.0],
                [rise, -peak, jerk],
            ],
        }
    }

    pub(crate) fn duration(&self) -> f64 {
        self.segments.iter().map(|[duration, ..]| duration).sum()
    }

    /// Returns the state a time after the start.
    pub(crate) fn at(&self, time: f64) -> State {
        let mut state = self.start;
        let mut left = time.max(0.0);
        for [duration, acceleration, jerk] in &self.segments {
            state.acceleration = *acceleration;
            state = state.after(left.min(*duration), *jerk);
            if left < *duration {
                return state;
            }
            left -= duration;
        }
        state
    }
}
