//! Faults of a random mission.

use std::fmt::Write;

use super::random::Random;
use crate::mission::fault::InjectedFault;
use crate::mission::file::VhSourceName;

/// Shortest and longest duration of a fault that ends, s.
const DURATION_S: [f64; 2] = [0.001, 3.0];

/// Instruments of a random mission, on which its faults depend.
#[derive(Debug, Clone)]
pub(super) struct Instruments {
    /// Sources of V/H.
    pub(super) sources: Vec<VhSourceName>,
    /// `true` if the receiver has a wire.
    pub(super) has_receiver_wire: bool,
    /// `true` if the autopilot has a wire.
    pub(super) has_autopilot_wire: bool,
}

impl Instruments {
    /// Returns true if a fault can happen with these instruments.
    const fn can_have(&self, fault: InjectedFault) -> bool {
        (self.has_receiver_wire || !fault.is_of_receiver())
            && (self.has_autopilot_wire || !fault.is_of_autopilot())
    }
}

/// Appends a fault to a scenario with so many exposures.
pub(super) fn append(
    text: &mut String,
    random: &mut Random,
    exposures: u32,
    interval_s: f64,
    instruments: &Instruments,
) {
    // The faults that came later are left to `campaign`, so that a seed keeps its missions.
    let possible: Vec<InjectedFault> = InjectedFault::ALL
        .into_iter()
        .filter(|fault| *fault <= InjectedFault::AutopilotBaud)
        .filter(|fault| instruments.can_have(*fault))
        .collect();
    let fault = random.of(&possible, InjectedFault::Stall);
    let frame = 1 + random.below(exposures);
    let after_s = random.between(-0.3 * interval_s, 0.5 * interval_s);
    // Writing to a string does not fail.
    let _ = write!(
        text,
        "\n[[fault]]\nname = \"{fault}\"\nat_frame = {frame}\nonset_s = {after_s:.6}\nsize = {}\n",
        size(fault, random)
    );
    if fault.is_of_vh() {
        let source = random.of(&instruments.sources, VhSourceName::Altimeter);
        let _ = writeln!(text, "source = \"{}\"", source.name());
    }
    if !fault.is_momentary() && !fault.is_sized_by_its_duration() && random.chance(0.7) {
        let [least_s, most_s] = DURATION_S;
        let _ = writeln!(text, "duration_s = {:.6}", random.scaled(least_s, most_s));
    }
}

/// Returns the size of a fault, as a scenario writes it.
fn size(fault: InjectedFault, random: &mut Random) -> String {
    let signed = |size: f64, random: &mut Random| if random.chance(0.5) { size } else { -size };
    let size = match fault {
        InjectedFault::VhDropOut | InjectedFault::VhNan | InjectedFault::VhWrongSign => {
            random.between(0.1, 1.0)
        }
        InjectedFault::VhJump => {
            let size = random.scaled(1.0, 99.0);
            signed(size, random)
        }
        InjectedFault::VhFrozen => random.between(0.0, 3.0),
        InjectedFault::VhWrongUnit => {
            random.of(&[0.3048, 0.514_444, 1.943_844, 3.280_84, 3.6], 1.943_844)
        }
        InjectedFault::Stall => random.scaled(0.3, 100.0),
        InjectedFault::SignError => f64::from(1 + random.below(2)),
        InjectedFault::Runaway => random.between(-1.0, 1.0),
        InjectedFault::EncoderGlitch => {
            let size = random.scaled(1.0, 10_000.0).round();
            signed(size, random)
        }
        InjectedFault::CountsLost => {
            let size = random.scaled(0.01, 900.0);
            signed(size, random)
        }
        InjectedFault::LimitSwitch | InjectedFault::IndexMissing => 1.0,
        InjectedFault::ShutterLate => random.scaled(0.05, 50.0),
        InjectedFault::ShutterMissing => f64::from(random.below(3)),
        InjectedFault::ShutterDouble => random.scaled(0.05, 30.0),
        InjectedFault::TriggerOverlap => random.scaled(0.1, 200.0),
        InjectedFault::UartCut | InjectedFault::ReceiverCut | InjectedFault::AutopilotCut => {
            random.scaled(0.01, 6.0)
        }
        InjectedFault::ReceiverFlood | InjectedFault::AutopilotFlood => {
            random.scaled(1.0, 1000.0).round()
        }
        InjectedFault::ReceiverBaud | InjectedFault::AutopilotBaud => random.scaled(0.1, 10.0),
        InjectedFault::EncoderScale
        | InjectedFault::PlayGrows
        | InjectedFault::SupplyLow
        | InjectedFault::LateRounds
        | InjectedFault::PulseMissing
        | InjectedFault::PulseDouble
        | InjectedFault::PulseMoved
        | InjectedFault::SecondOff
        | InjectedFault::AttitudeFrozen
        | InjectedFault::AttitudeWrong => fault.default_size(),
    };
    if fault.is_counted() {
        format!("{size:.1}")
    } else {
        format!("{size:.6}")
    }
}
