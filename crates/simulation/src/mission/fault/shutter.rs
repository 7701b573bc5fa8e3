//! Faults of the shutter and of its sensor.

use super::{InjectedFault, Injection, active};

/// Effect of the faults on a command to open.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OpeningFault {
    /// Delay of first light, s.
    pub late_s: f64,
    /// `true` if the shutter stays shut.
    pub stays_shut: bool,
    /// `true` if the sensor misses the opening edge.
    pub opening_unseen: bool,
    /// `true` if the sensor misses the closing edge.
    pub closing_unseen: bool,
    /// Time after the opening edge at which the sensor gives it again, s.
    pub again_s: Option<f64>,
}

/// Returns the effect of the faults on a command to open that leaves the camera at a time, s.
#[must_use]
pub fn opening_fault(injections: &[Injection], time_s: f64) -> OpeningFault {
    let size = |fault| active(injections, fault, time_s).map(|injection| injection.size);
    let missing = size(InjectedFault::ShutterMissing);
    let is = |number: f64| missing.is_some_and(|size| (size - number).abs() < 0.5);
    OpeningFault {
        late_s: size(InjectedFault::ShutterLate).unwrap_or(0.0) / 1000.0,
        stays_shut: is(0.0),
        opening_unseen: is(1.0),
        closing_unseen: is(2.0),
        again_s: size(InjectedFault::ShutterDouble).map(|size_ms| size_ms / 1000.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_say_what_is_missing_how_late_and_how_soon_again() {
        let of = |fault, size| opening_fault(&[Injection::new(fault, 1.0).of_size(size)], 2.0);
        assert!(of(InjectedFault::ShutterMissing, 0.0).stays_shut);
        assert!(of(InjectedFault::ShutterMissing, 1.0).opening_unseen);
        assert!(of(InjectedFault::ShutterMissing, 2.0).closing_unseen);
        assert!((of(InjectedFault::ShutterLate, 5.0).late_s - 0.005).abs() < 1e-15);
        assert!(of(InjectedFault::ShutterDouble, 1.0).again_s.is_some());
        assert_eq!(opening_fault(&[], 2.0), OpeningFault::default());
    }
}
