//! Faults of the stage, its motor, encoder and limit switches, in terms of the mechanics.

use super::{InjectedFault, Injection};
use crate::mechanics::{self, MechanicalFault};

/// Returns the mechanical faults among the injections.
#[must_use]
pub fn mechanical(injections: &[Injection]) -> Vec<mechanics::Injection> {
    injections.iter().filter_map(one).collect()
}

fn one(injection: &Injection) -> Option<mechanics::Injection> {
    let size = injection.size;
    let fault = match injection.fault {
        InjectedFault::Stall => MechanicalFault::Stall { force_n: size },
        InjectedFault::SignError if size < 1.5 => MechanicalFault::MotorReversed,
        InjectedFault::SignError => MechanicalFault::EncoderReversed,
        InjectedFault::Runaway => MechanicalFault::Runaway { duty: size },
        InjectedFault::EncoderGlitch => MechanicalFault::EncoderGlitch {
            counts: counts(size),
        },
        InjectedFault::CountsLost => MechanicalFault::CountsLost { um: size },
        InjectedFault::IndexMissing => MechanicalFault::IndexMissing,
        InjectedFault::LimitSwitch => MechanicalFault::LimitStuck,
        InjectedFault::EncoderScale => MechanicalFault::EncoderScale { percent: size },
        InjectedFault::PlayGrows => MechanicalFault::PlayGrows { um: size },
        _ => return None,
    };
    Some(mechanics::Injection {
        fault,
        from_s: injection.onset_s,
        until_s: injection.end_s(),
    })
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the cast saturates, and the range is checked"
)]
fn counts(size: f64) -> i32 {
    size.round() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wires_of_the_motor_or_of_the_encoder_are_swapped() {
        let of = |size| {
            let error = Injection::new(InjectedFault::SignError, 1.0).of_size(size);
            mechanical(&[error])
                .first()
                .map(|injection| injection.fault)
        };
        assert_eq!(of(1.0), Some(MechanicalFault::MotorReversed));
        assert_eq!(of(2.0), Some(MechanicalFault::EncoderReversed));
    }

    #[test]
    fn onset_and_duration_are_kept_and_other_faults_left_out() {
        let glitch = Injection::new(InjectedFault::EncoderGlitch, 3.0).lasting(0.001);
        let jump = Injection::new(InjectedFault::VhJump, 3.0);
        let [found] = mechanical(&[jump, glitch])[..] else {
            panic!("one fault of the mechanics")
        };
        assert!((found.from_s - 3.0).abs() < 1e-15 && (found.until_s - 3.001).abs() < 1e-12);
        assert_eq!(found.fault, MechanicalFault::EncoderGlitch { counts: 1000 });
    }
}
