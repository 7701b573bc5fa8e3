//! Hysteresis and creep of a stage that follows a position command, and its motion.

use std::f64::consts::TAU;

use super::motion::Motion;
use super::position_stage::PositionStage;

/// Number of play operators of the hysteresis.
const PLAYS: usize = 8;

/// Part of each in the hysteresis.
const PART: f64 = 1.0 / 8.0;

/// Radius of the widest of them, in parts of the travel.
const WIDEST: f64 = 0.25;

/// Time constants of the creep, s: a logarithm of time over three decades.
const CREEP_S: [f64; 3] = [0.1, 1.0, 10.0];

/// Part of each in the creep.
const CREEP_PART: f64 = 1.0 / 3.0;

/// Hysteresis and creep of a stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Hysteresis {
    /// Place of each play operator, µm.
    plays_um: [f64; PLAYS],
    /// Part of the creep with each time constant, µm.
    crept_um: [f64; CREEP_S.len()],
}

impl Hysteresis {
    /// Returns the motion after a step in time under a command, -1 to 1.
    ///
    /// # Model
    /// `x″ = ω²·(y - x) - 2ζω·x′`, where y is the command's travel through the hysteresis of
    /// Prandtl and Ishlinskii, with play operators of evenly spread radii, and a creep of
    /// first-order lags (Kuhnen and Janocha, Proc. 6th Int. Conf. Actuator 1998, 309: both in
    /// series with the dynamics). Its steps in time are short against the resonance: semi-implicit
    /// Euler.
    pub(super) fn after(
        &mut self,
        stage: &PositionStage,
        motion: Motion,
        command: f64,
        step_s: f64,
    ) -> Motion {
        let asked_um = command * stage.travel_um * (1.0 + 0.01 * stage.travel_error_percent);
        let towards_mm = 1e-3 * self.place_um(stage, asked_um, step_s);
        let rate = TAU * stage.resonance_hz;
        let push = rate * rate * (towards_mm - motion.position_mm)
            - 2.0 * stage.damping_ratio * rate * motion.speed_mm_s;
        let speed_mm_s = motion.speed_mm_s + push * step_s;
        Motion {
            position_mm: motion.position_mm + speed_mm_s * step_s,
            speed_mm_s,
        }
    }

    /// Returns the place to which a command leads, µm.
    fn place_um(&mut self, stage: &PositionStage, asked_um: f64, step_s: f64) -> f64 {
        let mut played_um = 0.0;
        let mut width_um = 0.0;
        for (number, play_um) in (1_u32..).zip(&mut self.plays_um) {
            let radius_um = stage.travel_um * WIDEST * f64::from(number) * PART;
            *play_um = play_um.clamp(asked_um - radius_um, asked_um + radius_um);
            played_um += *play_um * PART;
            width_um += 2.0 * radius_um * PART;
        }
        let part = 0.01 * stage.hysteresis_percent * stage.travel_um / width_um;
        let held_um = (1.0 - part) * asked_um + part * played_um;
        let mut crept_um = 0.0;
        for (time_s, part_um) in CREEP_S.into_iter().zip(&mut self.crept_um) {
            *part_um += (held_um - *part_um) * (step_s / time_s);
            crept_um += *part_um * CREEP_PART;
        }
        held_um + 0.01 * stage.creep_percent * crept_um
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns where the stage stands after each command, held for a time, µm.
    fn standing_um(stage: &PositionStage, commands: &[f64], held_s: f64) -> Vec<f64> {
        let (mut memory, mut motion) = (Hysteresis::default(), Motion::default());
        let step_s = 2e-5;
        commands
            .iter()
            .map(|command| {
                let mut time_s = 0.0;
                while time_s < held_s {
                    motion = memory.after(stage, motion, *command, step_s);
                    time_s += step_s;
                }
                1e3 * motion.position_mm
            })
            .collect()
    }

    #[test]
    fn hysteresis_leaves_its_width_between_both_ways_and_creep_its_part() {
        let stage = PositionStage {
            hysteresis_percent: 5.0,
            ..PositionStage::default()
        };
        let [_, down, _, up] = standing_um(&stage, &[1.0, 0.0, -1.0, 0.0], 0.1)[..] else {
            unreachable!();
        };
        // By definition: 5 % of 2500 µm.
        assert!((down - up - 125.0).abs() < 1.0, "{down} {up}");
        let stage = PositionStage {
            creep_percent: 3.0,
            ..PositionStage::default()
        };
        let [after] = standing_um(&stage, &[0.4], 100.0)[..] else {
            unreachable!();
        };
        assert!((after - 1030.0).abs() < 0.5, "{after}");
    }

    #[test]
    fn stage_lags_behind_a_ramp_as_stated() {
        let stage = PositionStage::default();
        let (mut memory, mut motion) = (Hysteresis::default(), Motion::default());
        let (step_s, speed_mm_s) = (2e-5, 20.0);
        let mut time_s = 0.0;
        while time_s < 0.1 {
            let command = speed_mm_s * time_s / (1e-3 * stage.travel_um);
            motion = memory.after(&stage, motion, command, step_s);
            time_s += step_s;
        }
        let behind_s = time_s - motion.position_mm / speed_mm_s;
        assert!(
            (behind_s - stage.lag_s()).abs() < 3.0 * step_s,
            "{behind_s}"
        );
    }
}
