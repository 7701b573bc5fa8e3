//! Motion of a mass under force and friction.

use super::settings::MechanicsSettings;

/// Position of the screw, reduced to the stage, and its speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Motion {
    pub position_mm: f64,
    pub speed_mm_s: f64,
}

/// Forces on the mass during a substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Forces {
    /// Force of the motor at rest, N.
    pub motor_n: f64,
    /// Back-EMF and viscous friction, N per m/s.
    pub damping_n_s_m: f64,
    /// Friction of a jam, N.
    pub jam_n: f64,
}

impl Motion {
    /// Returns the motion one substep later.
    ///
    /// # Model
    /// `m·dv/dt = F - b·v - F_f(v)·sgn(v)`, `F_f(v) = F_c + (F_s - F_c)·exp(-(v/v_s)²)`
    /// (Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30 (1994) 1083, eq. 5). The
    /// linear part is exact; friction is that of the mean speed. A substep in which the speed
    /// passes 0 is cut there: the mass then moves on only if the force exceeds the breakaway
    /// friction, and otherwise stands exactly still. End stops take all speed.
    pub(super) fn after(self, settings: &MechanicsSettings, forces: Forces, step_s: f64) -> Self {
        let mut motion = self;
        let mut left_s = step_s;
        if self.speed_mm_s != 0.0 {
            let next = self.sliding(settings, forces, self.speed_mm_s, step_s);
            let part = if next * self.speed_mm_s < 0.0 {
                self.speed_mm_s / (self.speed_mm_s - next)
            } else {
                1.0
            };
            let speed_mm_s = if part < 1.0 { 0.0 } else { next };
            motion = motion.moved(speed_mm_s, part * step_s);
            left_s = step_s - part * step_s;
        }
        let breakaway_n = settings.breakaway_n + forces.jam_n;
        if motion.speed_mm_s == 0.0 && left_s > 0.0 && forces.motor_n.abs() > breakaway_n {
            let next = motion.sliding(settings, forces, forces.motor_n, left_s);
            motion = motion.moved(next, left_s);
        }
        let [low, high] = settings.end_stops_mm;
        if motion.position_mm < low || motion.position_mm > high {
            motion = Self {
                position_mm: motion.position_mm.clamp(low, high),
                speed_mm_s: 0.0,
            };
        }
        motion
    }

    /// Moves on until a speed is reached, at constant acceleration.
    fn moved(self, speed_mm_s: f64, step_s: f64) -> Self {
        Self {
            position_mm: self.position_mm + 0.5 * (self.speed_mm_s + speed_mm_s) * step_s,
            speed_mm_s,
        }
    }

    /// Returns the speed after a time, with friction against one direction throughout.
    fn sliding(
        self,
        settings: &MechanicsSettings,
        forces: Forces,
        direction: f64,
        step_s: f64,
    ) -> f64 {
        let rate = forces.damping_n_s_m / settings.mass_kg;
        // ∫ exp(-rate·t) dt over the step.
        let decayed_s = if rate * step_s > 1e-9 {
            -(-rate * step_s).exp_m1() / rate
        } else {
            step_s
        };
        let speed = self.speed_mm_s;
        let after = |friction_speed: f64| {
            let slow = (-(friction_speed / settings.stribeck_mm_s).powi(2)).exp();
            let friction_n = settings.coulomb_n
                + (settings.breakaway_n - settings.coulomb_n) * slow
                + forces.jam_n;
            let force_n = forces.motor_n - friction_n.copysign(direction);
            speed + (1e3 * force_n / settings.mass_kg - speed * rate) * decayed_s
        };
        after(0.5 * (speed + after(speed)))
    }
}
