//! Cases of a campaign: faults with their sizes and durations.

use super::world::World;
use crate::mission::fault::{InjectedFault, Injection};
use crate::mission::file::{VhQuantity, VhSourceName};

/// Duration of a fault that ends, s: one frame cycle, in which every source reports.
const SHORT_S: f64 = 0.12;
/// Duration over which counts are lost and play grows, s.
const CREEPING_S: f64 = 0.36;
/// Durations of a fault that has one size alone, s.
const DURATIONS_S: [f64; 8] = [0.12, 0.13, 0.15, 0.18, 0.22, 0.25, 0.3, 0.36];
/// Durations of faults with two or three sizes.
const FEW_DURATIONS_S: [f64; 4] = [0.12, 0.15, 0.22, 0.36];

/// A fault with its size, its duration and what it affects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// World in which it is flown.
    pub world: World,
    /// Kind of the fault.
    pub fault: InjectedFault,
    /// Size, in the fault's own unit.
    pub size: f64,
    /// Duration, s; infinite for a fault that stays.
    pub duration_s: f64,
    /// Source that a V/H fault affects; `None` for the first.
    pub source: Option<VhSourceName>,
    /// Value of the source that a V/H fault affects; `None` for all or the first.
    pub quantity: Option<VhQuantity>,
}

impl Case {
    /// Returns all cases, fault by fault.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut cases = Vec::new();
        for fault in InjectedFault::ALL {
            let start = cases.len();
            for size in sizes(fault) {
                for duration_s in durations_s(fault) {
                    cases.push(Self {
                        world: World::OneSource,
                        fault,
                        size,
                        duration_s,
                        source: None,
                        quantity: None,
                    });
                }
            }
            let of_first: Vec<Self> = cases.iter().skip(start).copied().collect();
            if is_of_the_screw(fault) {
                cases.extend(of_first.iter().map(|case| Self {
                    world: World::Reverse,
                    ..*case
                }));
            }
            if fault.is_of_vh() {
                cases.extend(of_first.iter().map(|case| Self {
                    quantity: Some(VhQuantity::Height),
                    ..*case
                }));
                cases.extend(of_first.iter().map(|case| Self {
                    world: World::TwoSources,
                    source: Some(World::SECOND),
                    ..*case
                }));
            }
        }
        cases
    }

    /// Returns the fault of this case from a time on, s.
    #[must_use]
    pub const fn at(&self, onset_s: f64) -> Injection {
        Injection {
            fault: self.fault,
            onset_s,
            size: self.size,
            duration_s: self.duration_s,
            source: self.source,
            quantity: self.quantity,
        }
    }

    /// Returns the time after its onset at which no trigger is awaited any more, s: three frames,
    /// or two pulses of the receiver.
    #[must_use]
    pub const fn watched_s(&self) -> f64 {
        if self.fault.is_of_time() { 2.2 } else { 0.36 }
    }

    /// Returns the name of the row in which the case is shown.
    #[must_use]
    pub fn row(&self) -> String {
        let name = self.name();
        if self.world == World::Reverse {
            return format!("{name}, reverse");
        }
        name
    }

    /// Returns the name of the fault, with what it affects.
    #[must_use]
    pub fn name(&self) -> String {
        let name = self.fault.name();
        match (self.source, self.quantity) {
            (Some(_), _) => format!("{name}, second source"),
            (None, Some(VhQuantity::Height)) => format!("{name}, height"),
            _ => name.to_owned(),
        }
    }
}

/// Returns true if a fault is one of what lies between encoder and stage.
const fn is_of_the_screw(fault: InjectedFault) -> bool {
    matches!(
        fault,
        InjectedFault::PlayGrows | InjectedFault::CountsLost | InjectedFault::EncoderScale
    )
}

/// Returns the sizes of a fault, of both signs where it has a sign.
fn sizes(fault: InjectedFault) -> Vec<f64> {
    use InjectedFault as F;
    let signed = |sizes: [f64; 8]| [sizes, sizes.map(|size| -size)].concat();
    match fault {
        // A short fault has two samples, of which a share of a half hits one.
        F::VhDropOut | F::VhNan | F::VhWrongSign => {
            vec![0.5, 0.55, 0.6, 0.67, 0.75, 0.8, 0.9, 1.0]
        }
        F::VhJump => signed([0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 95.0]),
        F::VhFrozen => vec![0.0, 0.01, 0.03, 0.1, 0.3, 0.5, 1.0, 2.0],
        F::VhWrongUnit => vec![0.3048, 0.514_444, 0.9, 1.1, 1.15, 1.943_844, 3.280_84, 3.6],
        F::Stall => vec![0.3, 1.0, 2.0, 4.0, 6.0, 10.0, 30.0, 100.0],
        F::SignError => vec![1.0, 2.0],
        F::Runaway => signed([0.01, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0]),
        F::EncoderGlitch => signed([1.0, 3.0, 10.0, 30.0, 100.0, 1000.0, 1e4, 1e5]),
        F::CountsLost => signed([0.3, 1.0, 2.0, 3.0, 5.0, 10.0, 50.0, 500.0]),
        F::IndexMissing | F::LimitSwitch | F::SupplyLow | F::PulseMissing => vec![1.0],
        F::ShutterLate => vec![0.05, 0.2, 0.5, 1.0, 2.0, 5.0, 20.0, 60.0],
        F::ShutterMissing => vec![0.0, 1.0, 2.0],
        F::ShutterDouble => vec![0.05, 0.2, 0.5, 1.0, 3.0, 5.0, 15.0, 40.0],
        F::TriggerOverlap => vec![0.1, 1.0, 5.0, 15.0, 30.0, 50.0, 80.0, 115.0],
        F::UartCut | F::ReceiverCut | F::AutopilotCut => {
            vec![0.05, 0.06, 0.08, 0.12, 0.2, 0.3, 0.5, 1.0]
        }
        F::ReceiverFlood | F::AutopilotFlood => {
            vec![1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 200.0, 1000.0]
        }
        F::ReceiverBaud | F::AutopilotBaud => vec![0.1, 0.25, 0.5, 0.9, 1.1, 2.0, 4.0, 10.0],
        F::EncoderScale => signed([0.1, 0.3, 1.0, 2.0, 3.0, 5.0, 10.0, 30.0]),
        F::PlayGrows => vec![1.0, 2.0, 3.0, 5.0, 8.0, 15.0, 40.0, 100.0],
        F::LateRounds => vec![0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0],
        F::PulseDouble => vec![0.1, 1.0, 10.0, 50.0, 119.0, 121.0, 250.0, 500.0],
        F::PulseMoved => signed([0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 60.0, 100.0]),
        F::SecondOff => signed([1.0, 2.0, 3.0, 5.0, 10.0, 18.0, 60.0, 3600.0]),
        F::AttitudeFrozen => vec![0.0, 0.03, 0.06, 0.1, 0.3, 0.5, 1.0, 2.0],
        F::AttitudeWrong => signed([0.5, 0.9, 1.1, 2.0, 5.0, 10.0, 30.0, 57.295_78]),
    }
}

/// Returns the durations of a fault, s.
fn durations_s(fault: InjectedFault) -> Vec<f64> {
    use InjectedFault as F;
    match fault {
        _ if fault.is_momentary() || fault.is_sized_by_its_duration() => vec![f64::INFINITY],
        // Pulses come once per second.
        F::PulseMissing => vec![1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, f64::INFINITY],
        F::PulseDouble | F::PulseMoved | F::SecondOff => vec![f64::INFINITY],
        F::IndexMissing | F::LimitSwitch | F::SupplyLow => DURATIONS_S.to_vec(),
        F::SignError | F::ShutterMissing => FEW_DURATIONS_S.to_vec(),
        F::CountsLost | F::PlayGrows => vec![CREEPING_S, f64::INFINITY],
        _ => vec![SHORT_S, f64::INFINITY],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_has_eight_cases_and_both_signs_and_every_size_is_allowed() {
        let cases = Case::all();
        for fault in InjectedFault::ALL {
            let mine: Vec<&Case> = cases.iter().filter(|case| case.fault == fault).collect();
            assert!(mine.len() >= 8, "{fault}: {}", mine.len());
            let [least, most] = fault.range();
            for case in &mine {
                assert!(least <= case.size && case.size <= most, "{case:?}");
                assert!(!fault.is_counted() || case.size.fract() == 0.0, "{case:?}");
            }
            let has_sign = least < 0.0;
            assert_eq!(has_sign, mine.iter().any(|case| case.size < 0.0), "{fault}");
        }
    }
}
