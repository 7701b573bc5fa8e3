//! Faults of the satellite receiver's time: its pulses and the seconds that it names.

use super::{InjectedFault, Injection, active};
use crate::mission::clock::{microseconds, seconds};

/// Returns the time at which a pulse comes that is due at a time, µs: the faults move it.
pub(in crate::mission) fn moved_us(injections: &[Injection], pulse_us: u64) -> u64 {
    match active(injections, InjectedFault::PulseMoved, seconds(pulse_us)) {
        Some(moved) => microseconds(seconds(pulse_us) + moved.size / 1000.0),
        None => pulse_us,
    }
}

/// Returns true if a pulse that is due at a time, µs, does not come.
pub(in crate::mission) fn is_missing(injections: &[Injection], pulse_us: u64) -> bool {
    active(injections, InjectedFault::PulseMissing, seconds(pulse_us)).is_some()
}

/// Returns the time, µs, at which a pulse comes again that is due at a time; `None` if it does not.
pub(in crate::mission) fn again_us(injections: &[Injection], pulse_us: u64) -> Option<u64> {
    let again = active(injections, InjectedFault::PulseDouble, seconds(pulse_us))?;
    Some(pulse_us + microseconds(again.size / 1000.0))
}

/// Returns the second that the receiver names in place of the true one, s since 1970, in a message
/// at a time, µs.
pub(in crate::mission) fn named_s(injections: &[Injection], at_us: u64, unix_s: u64) -> u64 {
    match active(injections, InjectedFault::SecondOff, seconds(at_us)) {
        Some(off) if off.size < 0.0 => unix_s.saturating_sub(whole(-off.size)),
        Some(off) => unix_s.saturating_add(whole(off.size)),
        None => unix_s,
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number in its range, not negative"
)]
fn whole(size: f64) -> u64 {
    size.round() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(fault: InjectedFault, size: f64) -> [Injection; 1] {
        [Injection::new(fault, 1.0).of_size(size).lasting(1.0)]
    }

    #[test]
    fn pulse_is_moved_missing_or_doubled_while_the_fault_lasts() {
        let times_us = [900_000, 1_500_000, 2_500_000];
        let early = of(InjectedFault::PulseMoved, -20.0);
        let moved = times_us.map(|time_us| moved_us(&early, time_us));
        assert_eq!(moved, [900_000, 1_480_000, 2_500_000]);
        let missing = of(InjectedFault::PulseMissing, 1.0);
        let gone = times_us.map(|time_us| is_missing(&missing, time_us));
        assert_eq!(gone, [false, true, false]);
        let double = of(InjectedFault::PulseDouble, 0.5);
        let again = times_us.map(|time_us| again_us(&double, time_us));
        assert_eq!(again, [None, Some(1_500_500), None]);
    }

    #[test]
    fn receiver_names_a_second_before_or_after_the_true_one() {
        for (size, named) in [(1.0, 1001), (-2.0, 998)] {
            let off = of(InjectedFault::SecondOff, size);
            assert_eq!(named_s(&off, 1_500_000, 1000), named);
            assert_eq!(named_s(&off, 2_500_000, 1000), 1000);
        }
    }
}
