//! A fault with its time and size.

use super::InjectedFault;
use crate::mission::file::{VhQuantity, VhSourceName};

/// A fault with its onset, size and duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Injection {
    /// Kind of the fault.
    pub fault: InjectedFault,
    /// Onset, s of the flight.
    pub onset_s: f64,
    /// Size, in the fault's own unit.
    pub size: f64,
    /// Duration, s; infinite for a fault that stays. Ignored if the size is the duration.
    pub duration_s: f64,
    /// Source that a V/H fault affects; `None` for the first source.
    pub source: Option<VhSourceName>,
    /// Value of the source that a V/H fault affects; `None` for speed or V/H, and for all values in
    /// a drop-out.
    pub quantity: Option<VhQuantity>,
}

impl Injection {
    /// Creates a fault of its default size from an instant to the end of the flight.
    #[must_use]
    pub const fn new(fault: InjectedFault, onset_s: f64) -> Self {
        Self {
            fault,
            onset_s,
            size: fault.default_size(),
            duration_s: f64::INFINITY,
            source: None,
            quantity: None,
        }
    }

    /// Returns the same fault with another size.
    #[must_use]
    pub const fn of_size(self, size: f64) -> Self {
        Self { size, ..self }
    }

    /// Returns the same fault with another duration, s.
    #[must_use]
    pub const fn lasting(self, duration_s: f64) -> Self {
        Self { duration_s, ..self }
    }

    /// Returns the same fault of another V/H source.
    #[must_use]
    pub const fn of_source(self, source: VhSourceName) -> Self {
        Self {
            source: Some(source),
            ..self
        }
    }

    /// Returns the time at which the fault ends, s of the flight; infinite if it stays.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        let lasts_s = if self.fault.is_sized_by_its_duration() {
            self.size
        } else {
            self.duration_s
        };
        self.onset_s + lasts_s
    }

    /// Returns true if the fault is active at a time, s.
    #[must_use]
    pub fn is_on(&self, time_s: f64) -> bool {
        time_s >= self.onset_s && time_s < self.end_s()
    }
}

/// Finds the injection of a fault that is active at a time.
pub(in crate::mission) fn active(
    injections: &[Injection],
    fault: InjectedFault,
    time_s: f64,
) -> Option<&Injection> {
    injections
        .iter()
        .find(|injection| injection.fault == fault && injection.is_on(time_s))
}
