//! The moving mass under force and friction.

use super::settings::MechanicsSettings;

/// Where the screw is, reduced to the stage, and how it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Motion {
    pub position_mm: f64,
    pub speed_mm_s: f64,
}

/// What acts on it for a substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Forces {
    /// The motor's at rest, N.
    pub motor_n: f64,
    /// Back-EMF and viscous friction, N per m/s.
    pub damping_n_s_m: f64,
    /// Of a jam, N.
    pub jam_n: f64,
}

impl Motion {
    /// The motion one substep later.
    ///
    /// # Model
    /// `m·dv/dt = F - b·v - F_f(v)·sgn(v)`, `F_f(v) = F_c + (F_s - F_c)·exp(-(v/v_s)²)` (Armstrong-Hélouvry, Dupont and
    /// Canudas de Wit, Automatica 30 (1994) 1083, eq. 5). The linear part is exact for a force that is constant over the substep;
    /// friction then takes off what it can, down to 0: a stage that friction can hold stands, exactly. End stops
    /// take all speed.
    pub(super) fn after(self, settings: &MechanicsSettings, forces: Forces, step_s: f64) -> Self {
        let mass_kg = settings.mass_kg;
        let rate = forces.damping_n_s_m / mass_kg;
        // ∫ exp(-rate·t) dt over the substep.
        let decayed_s = if rate * step_s > 1e-9 {
            -(-rate * step_s).exp_m1() / rate
        } else {
            step_s
        };
        let per_force = 1e3 * decayed_s / mass_kg;
        let speed = self.speed_mm_s;
        let free = speed - speed * rate * decayed_s + forces.motor_n * per_force;
        let slow = (-(speed / settings.stribeck_mm_s).powi(2)).exp();
        let friction_n =
            settings.coulomb_n + (settings.breakaway_n - settings.coulomb_n) * slow + forces.jam_n;
        let taken = friction_n * per_force;
        let next = if free.abs() <= taken {
            0.0
        } else {
            free - taken.copysign(free)
        };
        let position_mm = self.position_mm + 0.5 * (speed + next) * step_s;
        let [low, high] = settings.end_stops_mm;
        if position_mm < low || position_mm > high {
            return Self {
                position_mm: position_mm.clamp(low, high),
                speed_mm_s: 0.0,
            };
        }
        Self {
            position_mm,
            speed_mm_s: next,
        }
    }
}
