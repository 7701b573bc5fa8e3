//! A motion of the stage as a list of segments of constant jerk.

use heapless::Vec;

use super::setpoint::Setpoint;

/// Most segments of a profile: three of a stop, seven of the fly-back after it.
pub const MAX_SEGMENTS: usize = 10;

/// A stretch of constant jerk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Duration, s.
    pub duration_s: f32,
    /// Set point at its beginning.
    pub start: Setpoint,
    /// Change of the acceleration, mm/s³; 0 is constant acceleration.
    pub jerk_mm_s3: f32,
}

impl Segment {
    /// Returns the set point at a time after the segment's start.
    fn at(&self, time_s: f32) -> Setpoint {
        let Setpoint {
            offset_mm,
            speed_mm_s,
            acceleration_mm_s2,
        } = self.start;
        let jerk = self.jerk_mm_s3;
        Setpoint {
            offset_mm: offset_mm
                + time_s
                    * (speed_mm_s + time_s * (0.5 * acceleration_mm_s2 + time_s * (jerk / 6.0))),
            speed_mm_s: speed_mm_s + time_s * (acceleration_mm_s2 + time_s * (0.5 * jerk)),
            acceleration_mm_s2: acceleration_mm_s2 + time_s * jerk,
        }
    }

    /// Returns the times at which the speed is zero, s after the start; those outside the segment
    /// do not count.
    fn turning_times_s(&self) -> [f32; 2] {
        let Setpoint {
            speed_mm_s,
            acceleration_mm_s2,
            ..
        } = self.start;
        // The stable pair of roots of jt²/2 + at + v.
        let root = fmc_camera_kernel::sqrt(
            acceleration_mm_s2 * acceleration_mm_s2 - 2.0 * self.jerk_mm_s3 * speed_mm_s,
        );
        let sum = -(acceleration_mm_s2 + root.copysign(acceleration_mm_s2));
        [sum / self.jerk_mm_s3, 2.0 * speed_mm_s / sum]
    }
}

/// A motion that begins in any state and ends at rest.
///
/// # Model
/// In each segment `s(t) = s₀ + v₀t + a₀t²/2 + jt³/6`, from the segment's own start, so that
/// rounding does not grow with time. If the jerk is unlimited, the acceleration steps from one
/// segment to the next; position and speed are continuous.
///
/// # Accuracy
/// [`POSITION_NM`] against the same segments in double precision and against the exact plan, over
/// 4 mm in 1 s (`tests/stage/accuracy.rs`).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    start: Setpoint,
    segments: Vec<Segment, MAX_SEGMENTS>,
    end: Setpoint,
    duration_s: f32,
}

/// Largest error of a profile's position, nm, over 4 mm in 1 s (0.33 nm found).
pub const POSITION_NM: f32 = 0.5;

impl Profile {
    /// Returns a profile without segments.
    pub(super) const fn from(start: Setpoint) -> Self {
        Self {
            start,
            segments: Vec::new(),
            end: start,
            duration_s: 0.0,
        }
    }

    /// Appends a time with a jerk, from an acceleration.
    pub(super) fn then(&mut self, duration_s: f32, acceleration_mm_s2: f32, jerk_mm_s3: f32) {
        if duration_s > 0.0 {
            let segment = Segment {
                duration_s,
                start: Setpoint {
                    acceleration_mm_s2,
                    ..self.end
                },
                jerk_mm_s3,
            };
            // The planner makes no more segments: three of a stop, seven of the way.
            if self.segments.push(segment).is_ok() {
                self.end = segment.at(duration_s);
                self.duration_s += duration_s;
            }
        }
    }

    /// Ends an acceleration at a speed, without its rounding.
    pub(super) const fn settle_at_speed(&mut self, speed_mm_s: f32) {
        self.end.speed_mm_s = speed_mm_s;
        self.end.acceleration_mm_s2 = 0.0;
    }

    /// Ends the motion at a place.
    pub(super) const fn stand_at(&mut self, offset_mm: f32) {
        self.end = Setpoint {
            offset_mm,
            speed_mm_s: 0.0,
            acceleration_mm_s2: 0.0,
        };
    }

    /// Returns the set point at a time after the start: at the start before it, at rest at the end
    /// after the end. A NaN counts as before the start.
    #[must_use]
    pub fn setpoint(&self, time_s: f32) -> Setpoint {
        if time_s <= 0.0 || time_s.is_nan() {
            return self.start;
        }
        // The sum of the durations is rounded.
        if time_s >= self.duration_s {
            return self.end;
        }
        let mut left_s = time_s;
        for segment in &self.segments {
            if left_s < segment.duration_s {
                return segment.at(left_s);
            }
            left_s -= segment.duration_s;
        }
        self.end
    }

    /// Duration, s.
    #[must_use]
    pub const fn duration_s(&self) -> f32 {
        self.duration_s
    }

    /// Set point at its beginning.
    #[must_use]
    pub const fn start(&self) -> Setpoint {
        self.start
    }

    /// Set point at rest after its end.
    #[must_use]
    pub const fn end(&self) -> Setpoint {
        self.end
    }

    /// The segments, in order.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Least and largest offset on the way, mm.
    #[must_use]
    pub fn reach_mm(&self) -> (f32, f32) {
        let mut least = self.start.offset_mm.min(self.end.offset_mm);
        let mut most = self.start.offset_mm.max(self.end.offset_mm);
        for segment in &self.segments {
            least = least.min(segment.start.offset_mm);
            most = most.max(segment.start.offset_mm);
            for time_s in segment.turning_times_s() {
                if time_s > 0.0 && time_s < segment.duration_s {
                    let Setpoint { offset_mm, .. } = segment.at(time_s);
                    least = least.min(offset_mm);
                    most = most.max(offset_mm);
                }
            }
        }
        (least, most)
    }
}
