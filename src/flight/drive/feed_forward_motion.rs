//! Motion under the fed-forward force: that of the set point, with its corners rounded to whole
//! ticks.

use crate::flight::stage::Setpoint;

/// Distance from the set point beyond which the led motion starts anew there, mm: the set point has
/// jumped.
const JUMP_MM: f32 = 0.02;

/// Gains per tick that bring a double integrator back in two ticks.
const JOIN_OFFSET: f32 = 1.0;
const JOIN_SPEED: f32 = 1.5;

/// Motion of the stage under the fed-forward force alone.
///
/// A set point does not show a corner that comes before the next tick, and the bridge delays the
/// force: at 1000 mm/s² the speed is then wrong by up to 1.1 mm/s. The led motion contains that
/// error and makes up for it in the two ticks that follow; the feedback compares it with the
/// encoder, as it would otherwise correct the error itself, over 10 ms of exposure.
///
/// # Model
/// At constant push over a tick T: `x += v·T + u·T²/2`, `v += u·T`, with
/// `u = a + (x_s - x)/T² + 1.5·(v_s - v)/T`: both poles at 0 (Åström and Wittenmark,
/// Computer-Controlled Systems, 3rd ed. 1997, section 4.3: dead-beat control).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct FeedForwardMotion {
    /// Led motion when the last duty began to act; its acceleration is the push since.
    at: Option<Setpoint>,
}

/// Motion to be pushed until the next call.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FeedForward {
    /// Expected position of the stage at the reading, mm.
    pub expected_mm: f32,
    /// Mean speed over the tick to come, mm/s.
    pub speed_mm_s: f32,
    /// Acceleration over the tick to come, mm/s².
    pub push_mm_s2: f32,
    /// `true` if the led motion starts here, without a last tick.
    pub starts: bool,
}

/// Delays between set point, reading and force, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Delays {
    /// Age of the reading.
    pub reading: f32,
    /// Delay until a duty acts.
    pub duty: f32,
    /// Time until the next call.
    pub tick: f32,
}

impl FeedForwardMotion {
    /// Advances by one tick; `dt_s` is the time since the last.
    pub(super) fn lead(&mut self, setpoint: Setpoint, dt_s: f32, delays: Delays) -> FeedForward {
        let ahead = moved(setpoint, delays.duty);
        let (led, starts) = match self.at.map(|last| moved(last, dt_s)) {
            Some(led) if (ahead.offset_mm - led.offset_mm).abs() <= JUMP_MM => (led, false),
            _ => (ahead, true),
        };
        let tick_s = delays.tick;
        let push_mm_s2 = ahead.acceleration_mm_s2
            + ((ahead.offset_mm - led.offset_mm) * JOIN_OFFSET / tick_s
                + (ahead.speed_mm_s - led.speed_mm_s) * JOIN_SPEED)
                / tick_s;
        self.at = Some(Setpoint {
            acceleration_mm_s2: push_mm_s2,
            ..led
        });
        FeedForward {
            expected_mm: moved(led, -(delays.duty + delays.reading)).offset_mm,
            speed_mm_s: led.speed_mm_s + 0.5 * push_mm_s2 * tick_s,
            push_mm_s2,
            starts,
        }
    }
}

/// Returns a set point moved at constant acceleration to a later or earlier time.
pub(super) fn moved(setpoint: Setpoint, time_s: f32) -> Setpoint {
    let Setpoint {
        offset_mm,
        speed_mm_s,
        acceleration_mm_s2,
    } = setpoint;
    Setpoint {
        offset_mm: offset_mm + time_s * (speed_mm_s + 0.5 * acceleration_mm_s2 * time_s),
        speed_mm_s: speed_mm_s + acceleration_mm_s2 * time_s,
        acceleration_mm_s2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DELAYS: Delays = Delays {
        reading: 0.0,
        duty: 0.0,
        tick: 1e-3,
    };

    /// Up to 5 mm/s at 1000 mm/s², where the ramp ends between two ticks.
    fn ramp(time_s: f32) -> Setpoint {
        let end_s = 0.0053;
        if time_s < end_s {
            moved(
                Setpoint {
                    acceleration_mm_s2: 1000.0,
                    ..Setpoint::default()
                },
                time_s,
            )
        } else {
            let end = Setpoint {
                acceleration_mm_s2: 0.0,
                ..ramp(end_s - 1e-9)
            };
            moved(end, time_s - end_s)
        }
    }

    #[test]
    fn corner_between_two_ticks_is_made_up_for_in_two_ticks() {
        let mut led = FeedForwardMotion::default();
        let mut farthest_um: f32 = 0.0;
        for tick in 0_u8..20 {
            let wanted = ramp(f32::from(tick) * 1e-3);
            let lead = led.lead(wanted, 1e-3, DELAYS);
            let off_um = 1e3 * (lead.expected_mm - wanted.offset_mm);
            farthest_um = farthest_um.max(off_um.abs());
            if tick <= 5 || tick >= 8 {
                // Single precision: 2 nm of position, so 2 mm/s² of push.
                assert!(off_um.abs() < 0.002, "tick {tick}: {off_um} µm");
            }
            if tick > 8 {
                assert!(lead.push_mm_s2.abs() < 5.0, "tick {tick}: {lead:?}");
            }
        }
        // By hand: 0.7 ms of 1000 mm/s² too much is 0.245 µm at the first tick after the corner.
        assert!((farthest_um - 0.245).abs() < 0.15, "{farthest_um} µm");
    }

    #[test]
    fn jump_of_the_set_point_is_left_to_the_feedback() {
        let mut led = FeedForwardMotion::default();
        led.lead(Setpoint::default(), 0.0, DELAYS);
        let there = Setpoint {
            offset_mm: 0.1,
            ..Setpoint::default()
        };
        let lead = led.lead(there, 1e-3, DELAYS);
        assert!(lead.starts && lead.push_mm_s2.abs() <= 0.0);
        assert!((lead.expected_mm - 0.1).abs() <= 0.0);
    }
}
