//! Triggers that overlap.

use super::{InjectedFault, Injection};
use crate::mission::clock::microseconds;

/// Returns the triggers and those that faults add, in order of time, µs.
#[must_use]
pub fn with_overlaps(triggers_us: &[u64], injections: &[Injection]) -> Vec<u64> {
    let mut all = triggers_us.to_vec();
    for injection in injections {
        if injection.fault == InjectedFault::TriggerOverlap {
            let onset_us = microseconds(injection.onset_s);
            // The first trigger at or after the onset.
            if let Some(trigger) = triggers_us.iter().find(|trigger| **trigger >= onset_us) {
                all.push(trigger + microseconds(injection.size / 1000.0));
            }
        }
    }
    all.sort_unstable();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extra_trigger_follows_the_first_one_after_the_onset() {
        let overlap = Injection::new(InjectedFault::TriggerOverlap, 1.5).of_size(20.0);
        let all = with_overlaps(&[1_000_000, 2_000_000, 3_000_000], &[overlap]);
        assert_eq!(all, [1_000_000, 2_000_000, 2_020_000, 3_000_000]);
        assert_eq!(with_overlaps(&[5], &[]), [5]);
    }
}
