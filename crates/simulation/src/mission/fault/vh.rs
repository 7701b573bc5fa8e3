//! Faults of a V/H source.

use super::{InjectedFault, Injection, Share, active};

/// The faults of one source, applied to its speed or V/H.
#[derive(Debug, Clone)]
pub struct VhFaults {
    injections: Vec<Injection>,
    dropped: Share,
    not_a_number: Share,
    reversed: Share,
    /// Past values as (time, value), for the fault that freezes the source.
    past: Vec<(f64, f64)>,
}

impl VhFaults {
    /// Creates the faults of one source from its injections.
    #[must_use]
    pub fn new(injections: &[Injection]) -> Self {
        Self {
            injections: injections.to_vec(),
            dropped: Share::default(),
            not_a_number: Share::default(),
            reversed: Share::default(),
            past: Vec::new(),
        }
    }

    /// Adds a fault of the source.
    pub fn inject(&mut self, injection: Injection) {
        self.injections.push(injection);
    }

    /// Returns the value that the source reports at a time in place of the true one; `None` if it
    /// is silent.
    pub fn said(&mut self, time_s: f64, value: f64) -> Option<f64> {
        let find = |fault| active(&self.injections, fault, time_s).copied();
        if let Some(drop_out) = find(InjectedFault::VhDropOut)
            && self.dropped.hits(drop_out.size)
        {
            return None;
        }
        let mut said = value;
        match find(InjectedFault::VhFrozen) {
            None => self.past.push((time_s, value)),
            Some(frozen) => {
                let kept_s = frozen.onset_s - frozen.size;
                let kept = self.past.iter().rev().find(|(time, _)| *time <= kept_s);
                said = kept.or(self.past.first()).map_or(value, |(_, kept)| *kept);
            }
        }
        if let Some(jump) = find(InjectedFault::VhJump) {
            said *= 1.0 + jump.size / 100.0;
        }
        if let Some(unit) = find(InjectedFault::VhWrongUnit) {
            said *= unit.size;
        }
        if let Some(sign) = find(InjectedFault::VhWrongSign)
            && self.reversed.hits(sign.size)
        {
            said = -said;
        }
        if let Some(nan) = find(InjectedFault::VhNan)
            && self.not_a_number.hits(nan.size)
        {
            said = f64::NAN;
        }
        Some(said)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(fault: InjectedFault, size: f64) -> VhFaults {
        VhFaults::new(&[Injection::new(fault, 1.0).of_size(size).lasting(1.0)])
    }

    #[test]
    fn each_fault_does_what_its_name_says_and_only_while_it_lasts() {
        let said = |fault, size: f64| {
            let mut faults = faults(fault, size);
            [0.5, 1.5, 2.5].map(|time| faults.said(time, 80.0 + time))
        };
        assert_eq!(
            said(InjectedFault::VhDropOut, 1.0),
            [Some(80.5), None, Some(82.5)]
        );
        assert_eq!(
            said(InjectedFault::VhFrozen, 0.0),
            [Some(80.5), Some(80.5), Some(82.5)]
        );
        assert_eq!(
            said(InjectedFault::VhWrongSign, 1.0),
            [Some(80.5), Some(-81.5), Some(82.5)]
        );
        assert_eq!(
            said(InjectedFault::VhWrongUnit, 2.0),
            [Some(80.5), Some(163.0), Some(82.5)]
        );
        assert_eq!(
            said(InjectedFault::VhJump, 50.0),
            [Some(80.5), Some(122.25), Some(82.5)]
        );
        let [before, during, after] = said(InjectedFault::VhNan, 1.0);
        assert_eq!((before, after), (Some(80.5), Some(82.5)));
        assert!(during.is_some_and(f64::is_nan));
    }
}
