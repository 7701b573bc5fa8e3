//! Faults that can be injected into a simulated flight, by name, with onset and size.
//!
//! # Examples
//! ```
//! use fmc_simulation::mission::fault::{Injection, InjectedFault};
//! // A campaign: every size of a jump at every onset.
//! let jump = InjectedFault::named("vh-jump").unwrap();
//! let [least, most] = jump.range();
//! let onsets = [3.0, 3.5].into_iter();
//! let sweep = onsets.flat_map(|onset_s| [least, most].map(|size| Injection::new(jump, onset_s).of_size(size)));
//! assert_eq!(sweep.count(), 4);
//! ```

pub(in crate::mission) mod attitude;
mod injection;
pub mod line;
pub(in crate::mission) mod receiver;
pub mod shutter;
pub mod stage;
pub mod trigger;
pub mod vh;

pub use injection::Injection;
pub(in crate::mission) use injection::active;

use std::fmt;

/// A fault outside the camera.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum InjectedFault {
    /// A V/H source is silent.
    VhDropOut,
    /// The source's values jump.
    VhJump,
    /// The source's values are NaN.
    VhNan,
    /// The source's values stay at an earlier one.
    VhFrozen,
    /// The source's values are in another unit.
    VhWrongUnit,
    /// The source's values have the wrong sign.
    VhWrongSign,
    /// The stage jams.
    Stall,
    /// The wires of the motor or of the encoder are swapped.
    SignError,
    /// The motor's bridge is stuck at a pulse width.
    Runaway,
    /// The encoder's count jumps.
    EncoderGlitch,
    /// The encoder loses counts for good, evenly over the duration, or at once without one.
    CountsLost,
    /// The index mark is not seen.
    IndexMissing,
    /// A limit switch closes.
    LimitSwitch,
    /// The shutter opens late.
    ShutterLate,
    /// The shutter does not open, or its sensor misses an edge.
    ShutterMissing,
    /// The shutter's sensor gives the opening edge twice.
    ShutterDouble,
    /// A second trigger follows soon after one.
    TriggerOverlap,
    /// The serial line is cut, with all of its traffic.
    UartCut,
    /// The satellite receiver's wire is cut.
    ReceiverCut,
    /// The satellite receiver's wire brings bytes without a pause.
    ReceiverFlood,
    /// The satellite receiver sends at another baud rate than the camera expects.
    ReceiverBaud,
    /// The autopilot's wire is cut.
    AutopilotCut,
    /// The autopilot's wire brings bytes without a pause.
    AutopilotFlood,
    /// The autopilot sends at another baud rate than the camera expects.
    AutopilotBaud,
    /// The encoder's scale changes.
    EncoderScale,
    /// The play between screw and stage grows for good, evenly over the duration, or at once
    /// without one.
    PlayGrows,
    /// The supply voltage is low.
    SupplyLow,
    /// The rounds of the control loop come late.
    LateRounds,
    /// The satellite receiver's time pulse does not come.
    PulseMissing,
    /// The satellite receiver's time pulse comes twice.
    PulseDouble,
    /// The satellite receiver's time pulse comes early or late.
    PulseMoved,
    /// The satellite receiver names a wrong second.
    SecondOff,
    /// Attitude and rates stay at earlier ones.
    AttitudeFrozen,
    /// Attitude and rates are wrong by a factor, such as the sign.
    AttitudeWrong,
}

impl InjectedFault {
    /// All of them.
    pub const ALL: [Self; 34] = [
        Self::VhDropOut,
        Self::VhJump,
        Self::VhNan,
        Self::VhFrozen,
        Self::VhWrongUnit,
        Self::VhWrongSign,
        Self::Stall,
        Self::SignError,
        Self::Runaway,
        Self::EncoderGlitch,
        Self::CountsLost,
        Self::IndexMissing,
        Self::LimitSwitch,
        Self::ShutterLate,
        Self::ShutterMissing,
        Self::ShutterDouble,
        Self::TriggerOverlap,
        Self::UartCut,
        Self::ReceiverCut,
        Self::ReceiverFlood,
        Self::ReceiverBaud,
        Self::AutopilotCut,
        Self::AutopilotFlood,
        Self::AutopilotBaud,
        Self::EncoderScale,
        Self::PlayGrows,
        Self::SupplyLow,
        Self::LateRounds,
        Self::PulseMissing,
        Self::PulseDouble,
        Self::PulseMoved,
        Self::SecondOff,
        Self::AttitudeFrozen,
        Self::AttitudeWrong,
    ];

    /// Returns the name used in a scenario.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::VhDropOut => "vh-drop-out",
            Self::VhJump => "vh-jump",
            Self::VhNan => "vh-nan",
            Self::VhFrozen => "vh-frozen",
            Self::VhWrongUnit => "vh-wrong-unit",
            Self::VhWrongSign => "vh-wrong-sign",
            Self::Stall => "stall",
            Self::SignError => "sign-error",
            Self::Runaway => "runaway",
            Self::EncoderGlitch => "encoder-glitch",
            Self::CountsLost => "counts-lost",
            Self::IndexMissing => "index-missing",
            Self::LimitSwitch => "limit-switch",
            Self::ShutterLate => "shutter-late",
            Self::ShutterMissing => "shutter-missing",
            Self::ShutterDouble => "shutter-double",
            Self::TriggerOverlap => "trigger-overlap",
            Self::UartCut => "uart-cut",
            Self::ReceiverCut => "receiver-cut",
            Self::ReceiverFlood => "receiver-flood",
            Self::ReceiverBaud => "receiver-baud",
            Self::AutopilotCut => "autopilot-cut",
            Self::AutopilotFlood => "autopilot-flood",
            Self::AutopilotBaud => "autopilot-baud",
            Self::EncoderScale => "encoder-scale",
            Self::PlayGrows => "play-grows",
            Self::SupplyLow => "supply-low",
            Self::LateRounds => "late-rounds",
            Self::PulseMissing => "pulse-missing",
            Self::PulseDouble => "pulse-double",
            Self::PulseMoved => "pulse-moved",
            Self::SecondOff => "second-off",
            Self::AttitudeFrozen => "attitude-frozen",
            Self::AttitudeWrong => "attitude-wrong",
        }
    }

    /// Returns the fault of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fault| fault.name() == name)
    }

    /// Returns the unit of its size.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::VhDropOut | Self::VhNan | Self::VhWrongSign => "of the samples",
            Self::VhJump => "% more",
            Self::VhFrozen | Self::AttitudeFrozen => {
                "s before the onset, the value of which is kept"
            }
            Self::VhWrongUnit | Self::AttitudeWrong => "times the value",
            Self::Stall => "N of friction more",
            Self::SignError => "(1: motor, 2: encoder)",
            Self::Runaway => "of full pulse width",
            Self::EncoderGlitch => "counts",
            Self::CountsLost => "µm lost in sum",
            Self::IndexMissing => "(1: no edge)",
            Self::LimitSwitch => "(1: closed wherever the stage is)",
            Self::ShutterLate | Self::LateRounds | Self::PulseMoved => "ms late",
            Self::EncoderScale => "% more counts",
            Self::PlayGrows => "µm more in the end",
            Self::SupplyLow => "(1: too low)",
            Self::PulseMissing => "(1: no pulse)",
            Self::PulseDouble => "ms after the first pulse",
            Self::SecondOff => "s more",
            Self::ShutterMissing => {
                "(0: stays shut, 1: opening edge not seen, 2: closing edge not seen)"
            }
            Self::ShutterDouble => "ms after the first edge",
            Self::TriggerOverlap => "ms after the trigger",
            Self::UartCut | Self::ReceiverCut | Self::AutopilotCut => "s",
            Self::ReceiverFlood | Self::AutopilotFlood => "bytes per ms",
            Self::ReceiverBaud | Self::AutopilotBaud => "times the baud rate",
        }
    }

    /// Returns the smallest and the largest size.
    #[must_use]
    pub const fn range(self) -> [f64; 2] {
        match self {
            Self::VhDropOut | Self::VhNan | Self::VhWrongSign => [0.01, 1.0],
            Self::VhJump => [-99.0, 1000.0],
            Self::VhFrozen => [0.0, 60.0],
            Self::VhWrongUnit => [0.001, 1000.0],
            Self::Stall => [0.01, 1000.0],
            Self::SignError => [1.0, 2.0],
            Self::Runaway => [-1.0, 1.0],
            Self::EncoderGlitch => [-1e6, 1e6],
            Self::CountsLost => [-1000.0, 1000.0],
            Self::LimitSwitch | Self::IndexMissing | Self::SupplyLow | Self::PulseMissing => {
                [1.0, 1.0]
            }
            Self::EncoderScale => [-50.0, 50.0],
            Self::PlayGrows => [0.01, 100.0],
            Self::LateRounds | Self::PulseDouble => [0.1, 500.0],
            Self::PulseMoved => [-100.0, 100.0],
            Self::SecondOff => [-3600.0, 3600.0],
            Self::AttitudeFrozen => [0.0, 60.0],
            Self::AttitudeWrong => [-60.0, 60.0],
            Self::ShutterLate => [0.01, 100.0],
            Self::ShutterMissing => [0.0, 2.0],
            Self::ShutterDouble => [0.01, 50.0],
            Self::TriggerOverlap | Self::UartCut | Self::ReceiverCut | Self::AutopilotCut => {
                [0.001, 1000.0]
            }
            Self::ReceiverFlood | Self::AutopilotFlood => [1.0, 1000.0],
            Self::ReceiverBaud | Self::AutopilotBaud => [0.1, 10.0],
        }
    }

    /// Returns the size of a fault for which a scenario gives none.
    #[must_use]
    pub const fn default_size(self) -> f64 {
        match self {
            Self::VhJump => 30.0,
            Self::VhFrozen | Self::ShutterMissing | Self::AttitudeFrozen => 0.0,
            Self::PlayGrows | Self::PulseMoved => 10.0,
            Self::LateRounds => 2.0,
            Self::PulseDouble => 100.0,
            Self::AttitudeWrong => -1.0,
            // Knots for metres per second.
            Self::VhWrongUnit => 1.943_844,
            Self::EncoderGlitch => 1000.0,
            Self::ShutterLate => 5.0,
            Self::ShutterDouble => 0.5,
            Self::TriggerOverlap | Self::CountsLost => 20.0,
            Self::Stall => 50.0,
            Self::UartCut | Self::ReceiverCut | Self::AutopilotCut => 6.0,
            Self::ReceiverFlood | Self::AutopilotFlood => 100.0,
            Self::ReceiverBaud | Self::AutopilotBaud => 0.5,
            Self::VhDropOut
            | Self::VhNan
            | Self::VhWrongSign
            | Self::SignError
            | Self::Runaway
            | Self::IndexMissing
            | Self::LimitSwitch
            | Self::EncoderScale
            | Self::SupplyLow
            | Self::PulseMissing
            | Self::SecondOff => 1.0,
        }
    }

    /// Returns true if the fault happens once, at its onset, and has no duration.
    #[must_use]
    pub const fn is_momentary(self) -> bool {
        matches!(self, Self::TriggerOverlap)
    }

    /// Returns true if the size is the duration, s.
    #[must_use]
    pub const fn is_sized_by_its_duration(self) -> bool {
        matches!(self, Self::UartCut | Self::ReceiverCut | Self::AutopilotCut)
    }

    /// Returns true if the fault is one of a V/H source.
    #[must_use]
    pub const fn is_of_vh(self) -> bool {
        matches!(
            self,
            Self::VhDropOut
                | Self::VhJump
                | Self::VhNan
                | Self::VhFrozen
                | Self::VhWrongUnit
                | Self::VhWrongSign
        )
    }

    /// Returns true if the fault is one of the receiver's wire.
    #[must_use]
    pub const fn is_of_receiver(self) -> bool {
        matches!(
            self,
            Self::ReceiverCut | Self::ReceiverFlood | Self::ReceiverBaud
        )
    }

    /// Returns true if the fault is one of the autopilot's wire.
    #[must_use]
    pub const fn is_of_autopilot(self) -> bool {
        matches!(
            self,
            Self::AutopilotCut | Self::AutopilotFlood | Self::AutopilotBaud
        )
    }

    /// Returns true if its sizes are whole numbers.
    #[must_use]
    pub const fn is_counted(self) -> bool {
        matches!(
            self,
            Self::SignError
                | Self::EncoderGlitch
                | Self::IndexMissing
                | Self::LimitSwitch
                | Self::ShutterMissing
                | Self::ReceiverFlood
                | Self::AutopilotFlood
                | Self::SupplyLow
                | Self::PulseMissing
                | Self::SecondOff
        )
    }

    /// Returns true if the fault is one of the satellite receiver's time.
    #[must_use]
    pub const fn is_of_time(self) -> bool {
        matches!(
            self,
            Self::PulseMissing | Self::PulseDouble | Self::PulseMoved | Self::SecondOff
        )
    }
}

impl fmt::Display for InjectedFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Selects a share of the cases, evenly spread.
#[derive(Debug, Clone, Default)]
pub(super) struct Share {
    sum: f64,
}

impl Share {
    /// Returns true if the next case is selected; a share of 1 selects all.
    pub(super) fn hits(&mut self, share: f64) -> bool {
        self.sum += share;
        let hit = self.sum > 1.0 - 1e-9;
        if hit {
            self.sum -= 1.0;
        }
        hit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_kebab_case_and_lead_back_and_usual_sizes_are_in_range() {
        for fault in InjectedFault::ALL {
            assert_eq!(InjectedFault::named(fault.name()), Some(fault));
            let plain = |c: char| c.is_ascii_lowercase() || c == '-';
            assert!(fault.name().chars().all(plain), "{fault}");
            let [least, most] = fault.range();
            let size = fault.default_size();
            assert!(least <= size && size <= most, "{fault}");
        }
        assert_eq!(InjectedFault::named("Stall"), None);
    }

    #[test]
    fn injection_begins_at_its_onset_and_ends_after_its_duration() {
        let injection = Injection::new(InjectedFault::Stall, 2.0).lasting(0.5);
        let on = [1.999, 2.0, 2.499, 2.5].map(|time| injection.is_on(time));
        assert_eq!(on, [false, true, true, false]);
        assert!(Injection::new(InjectedFault::Stall, 2.0).is_on(1e9));
    }

    #[test]
    fn share_is_kept_to_and_evenly_spread() {
        let mut share = Share::default();
        let hits: Vec<bool> = (0..8).map(|_| share.hits(0.25)).collect();
        assert_eq!(hits.iter().filter(|hit| **hit).count(), 2);
        assert!(hits[3] && hits[7]);
        let mut all = Share::default();
        assert!((0..1000).all(|_| all.hits(1.0)));
    }
}
