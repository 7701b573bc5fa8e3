//! Motions at constant acceleration, one after the other.

use fmc_camera::flight::stage::Setpoint;

/// Acceleration of run-ups, stops and fly-backs, mm/s².
pub(crate) const ACCELERATION_MM_S2: f64 = 1000.0;

/// Speed of fly-backs, mm/s.
pub(crate) const FASTEST_MM_S: f64 = 50.0;

/// Phase of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    Rest,
    Ramp,
    Cruise,
    FlyBack,
}

#[derive(Debug, Clone, Copy)]
struct Part {
    phase: Phase,
    start_s: f64,
    offset_mm: f64,
    speed_mm_s: f64,
    acceleration_mm_s2: f64,
}

/// Motions from rest to rest, one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Profile {
    parts: Vec<Part>,
    end_s: f64,
    end_mm: f64,
    measured_from_s: f64,
}

/// Required motion at an instant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted {
    pub(crate) phase: Phase,
    /// Time since the phase began.
    pub(crate) since_s: f64,
    pub(crate) offset_mm: f64,
    pub(crate) speed_mm_s: f64,
    pub(crate) acceleration_mm_s2: f64,
}

impl Profile {
    /// Returns a profile that begins at rest at the calibrated position for so long.
    pub(crate) fn at_rest(duration_s: f64) -> Self {
        let mut profile = Self {
            parts: Vec::new(),
            end_s: 0.0,
            end_mm: 0.0,
            measured_from_s: 0.0,
        };
        profile.add(Phase::Rest, duration_s, 0.0, 0.0);
        profile
    }

    fn add(&mut self, phase: Phase, duration_s: f64, speed_mm_s: f64, acceleration_mm_s2: f64) {
        self.parts.push(Part {
            phase,
            start_s: self.end_s,
            offset_mm: self.end_mm,
            speed_mm_s,
            acceleration_mm_s2,
        });
        self.end_s += duration_s;
        self.end_mm += duration_s * (speed_mm_s + 0.5 * acceleration_mm_s2 * duration_s);
    }

    pub(crate) fn rest(&mut self, duration_s: f64) {
        self.add(Phase::Rest, duration_s, 0.0, 0.0);
    }

    /// Adds a ramp to a speed, a time at that speed, and a ramp to rest.
    pub(crate) fn cruise(&mut self, speed_mm_s: f64, duration_s: f64, acceleration: f64) {
        let ramp_s = speed_mm_s.abs() / acceleration;
        let acceleration = acceleration.copysign(speed_mm_s);
        self.add(Phase::Ramp, ramp_s, 0.0, acceleration);
        self.add(Phase::Cruise, duration_s, speed_mm_s, 0.0);
        self.add(Phase::Ramp, ramp_s, speed_mm_s, -acceleration);
    }

    /// Adds so many strokes to and fro, as at arming.
    pub(crate) fn strokes(&mut self, strokes: u32) {
        for _ in 0..strokes {
            self.move_to(-1.0, FASTEST_MM_S, ACCELERATION_MM_S2);
            self.rest(0.02);
            self.move_to(1.0, FASTEST_MM_S, ACCELERATION_MM_S2);
            self.rest(0.02);
        }
    }

    /// Adds a motion to a place, as fast as acceleration and speed allow.
    pub(crate) fn move_to(&mut self, offset_mm: f64, fastest_mm_s: f64, acceleration: f64) {
        let way_mm = offset_mm - self.end_mm;
        let speed_mm_s = fastest_mm_s.min((way_mm.abs() * acceleration).sqrt());
        let ramp_s = speed_mm_s / acceleration;
        let cruise_s = way_mm.abs() / speed_mm_s - ramp_s;
        let (speed, acceleration) = (speed_mm_s.copysign(way_mm), acceleration.copysign(way_mm));
        self.add(Phase::FlyBack, ramp_s, 0.0, acceleration);
        self.add(Phase::FlyBack, cruise_s, speed, 0.0);
        self.add(Phase::FlyBack, ramp_s, speed, -acceleration);
    }

    /// Makes everything before this instant a warm-up.
    pub(crate) fn measure_from_here(&mut self) {
        self.measured_from_s = self.end_s;
    }

    pub(crate) fn measured_from_s(&self) -> f64 {
        self.measured_from_s
    }

    pub(crate) fn end_s(&self) -> f64 {
        self.end_s
    }

    pub(crate) fn at(&self, time_s: f64) -> Wanted {
        let next = self.parts.partition_point(|part| part.start_s <= time_s);
        let part = self.parts[next.max(1) - 1];
        let since_s = time_s - part.start_s;
        Wanted {
            phase: part.phase,
            since_s,
            offset_mm: part.offset_mm
                + since_s * (part.speed_mm_s + 0.5 * part.acceleration_mm_s2 * since_s),
            speed_mm_s: part.speed_mm_s + part.acceleration_mm_s2 * since_s,
            acceleration_mm_s2: part.acceleration_mm_s2,
        }
    }
}

impl Wanted {
    #[expect(clippy::cast_possible_truncation, reason = "the camera's precision")]
    pub(crate) fn setpoint(&self) -> Setpoint {
        Setpoint {
            offset_mm: self.offset_mm as f32,
            speed_mm_s: self.speed_mm_s as f32,
            acceleration_mm_s2: self.acceleration_mm_s2 as f32,
        }
    }
}
