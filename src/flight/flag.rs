//! Flags of a frame, for its user.

use super::attitude::AttitudeFinding;
use super::utc::UtcFinding;
use super::vh::{VhFindingKind, WrongUnit};

/// A property of a frame that its user should know. Those from [`Self::VhNotANumber`] to
/// [`Self::VhUnconfirmed`] are findings of the aircraft's instruments: made since the last record,
/// or of the last sample of their source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Flag {
    /// The stage stood still: no compensation.
    NoCompensation,
    /// V/H was older than its source's rate: the last good one was used.
    LastGoodVh,
    /// The exposure opened off the planned place, as the stage started from another place.
    OffCentre,
    /// Predicted smear exceeds the budget.
    SmearOverBudget,
    /// The motion is that of the plan and not measured, since the encoder is not trusted.
    PlannedMotion,
    /// The coordinates are corrected by the static calibration alone.
    StaticCorrection,
    /// A single wrong encoder reading was left out.
    EncoderGlitch,
    /// Encoder readings are missing in the exposure or at one end of it; the path was continued
    /// from the others.
    ExtrapolatedMotion,
    /// Attitude rates were given and are in the predicted smear.
    WithAttitude,
    /// Last light was not seen: the exposure is taken to have lasted as planned.
    LastLightAssumed,
    /// The encoder was not compared with the index mark since the last record, has been found wrong
    /// at the next crossing of it, or no next crossing has come.
    Unreferenced,
    /// A source of V/H gave a NaN or an infinity ([`VhFindingKind::NotANumber`]).
    VhNotANumber,
    /// A source of V/H was outside its range ([`VhFindingKind::OutOfRange`]).
    VhOutOfRange,
    /// A source of V/H had the wrong sign ([`VhFindingKind::WrongSign`]).
    VhWrongSign,
    /// A height came in feet ([`VhFindingKind::WrongUnit`]).
    VhFeet,
    /// A speed came in knots ([`VhFindingKind::WrongUnit`]).
    VhKnots,
    /// A source of V/H jumped farther than it can slew ([`VhFindingKind::Jump`]).
    VhJump,
    /// A source of V/H repeated itself for too long ([`VhFindingKind::Frozen`]).
    VhFrozen,
    /// A sample of V/H came from the past ([`VhFindingKind::FromThePast`]).
    VhFromThePast,
    /// Two ways to V/H disagreed ([`VhFindingKind::Disagreement`]).
    VhDisagreement,
    /// Time pulses did not come ([`UtcFinding::MissingPulses`]).
    UtcMissingPulses,
    /// A time pulse belonged to no second ([`UtcFinding::ExtraPulse`]).
    UtcExtraPulse,
    /// The time pulses have moved within the second ([`UtcFinding::PulsesMoved`]).
    UtcPulsesMoved,
    /// The receiver's time contradicted the count of pulses ([`UtcFinding::WrongSecond`]).
    UtcWrongSecond,
    /// The receiver's time stepped, and is trusted ([`UtcFinding::Stepped`]).
    UtcStepped,
    /// A pulse or a time of the receiver came from the past ([`UtcFinding::FromThePast`]).
    UtcFromThePast,
    /// A time of the receiver had no pulse to name ([`UtcFinding::NoPulse`]).
    UtcNoPulse,
    /// An attitude had a NaN or an infinity ([`AttitudeFinding::NotANumber`]).
    AttitudeNotANumber,
    /// An attitude was out of range ([`AttitudeFinding::OutOfRange`]).
    AttitudeOutOfRange,
    /// No attitude has come near the exposure ([`AttitudeFinding::Silent`]).
    AttitudeSilent,
    /// V/H comes from a source that has jumped and that nothing has confirmed
    /// ([`VhMonitor::is_unconfirmed`](super::vh::VhMonitor::is_unconfirmed)).
    VhUnconfirmed,
    /// Nothing measures the stage: the motion is that of the steps made, by a stepper
    /// ([`DriveKind::Stepper`](super::drive::kind::DriveKind::Stepper)).
    NotMeasured,
    /// The calibration has a focus table, and the temperature is outside it: the focus shift is
    /// that of the nearest row.
    TemperatureOutside,
    /// The calibration has a focus table, and the temperature has not been told for
    /// [`TEMPERATURE_VALID_S`](super::lens_temperature::TEMPERATURE_VALID_S), or not since a reset:
    /// the focus shift is that of the last one told, or 0 before the first.
    TemperatureUnknown,
}

impl Flag {
    /// All flags.
    pub const ALL: [Self; 34] = [
        Self::NoCompensation,
        Self::LastGoodVh,
        Self::OffCentre,
        Self::SmearOverBudget,
        Self::PlannedMotion,
        Self::StaticCorrection,
        Self::EncoderGlitch,
        Self::ExtrapolatedMotion,
        Self::WithAttitude,
        Self::LastLightAssumed,
        Self::Unreferenced,
        Self::VhNotANumber,
        Self::VhOutOfRange,
        Self::VhWrongSign,
        Self::VhFeet,
        Self::VhKnots,
        Self::VhJump,
        Self::VhFrozen,
        Self::VhFromThePast,
        Self::VhDisagreement,
        Self::UtcMissingPulses,
        Self::UtcExtraPulse,
        Self::UtcPulsesMoved,
        Self::UtcWrongSecond,
        Self::UtcStepped,
        Self::UtcFromThePast,
        Self::UtcNoPulse,
        Self::AttitudeNotANumber,
        Self::AttitudeOutOfRange,
        Self::AttitudeSilent,
        Self::VhUnconfirmed,
        Self::NotMeasured,
        Self::TemperatureOutside,
        Self::TemperatureUnknown,
    ];

    /// The name in documents and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoCompensation => "no compensation",
            Self::LastGoodVh => "last good V/H",
            Self::OffCentre => "off centre",
            Self::SmearOverBudget => "smear over budget",
            Self::PlannedMotion => "planned motion",
            Self::StaticCorrection => "static correction",
            Self::EncoderGlitch => "encoder glitch",
            Self::ExtrapolatedMotion => "extrapolated motion",
            Self::WithAttitude => "with attitude",
            Self::LastLightAssumed => "last light assumed",
            Self::Unreferenced => "unreferenced",
            Self::VhNotANumber => "V/H not a number",
            Self::VhOutOfRange => "V/H out of range",
            Self::VhWrongSign => "V/H wrong sign",
            Self::VhFeet => "V/H feet for metres",
            Self::VhKnots => "V/H knots for metres per second",
            Self::VhJump => "V/H jump",
            Self::VhFrozen => "V/H frozen",
            Self::VhFromThePast => "V/H from the past",
            Self::VhDisagreement => "V/H disagreement",
            Self::UtcMissingPulses => "UTC missing pulses",
            Self::UtcExtraPulse => "UTC extra pulse",
            Self::UtcPulsesMoved => "UTC pulses moved",
            Self::UtcWrongSecond => "UTC wrong second",
            Self::UtcStepped => "UTC stepped",
            Self::UtcFromThePast => "UTC from the past",
            Self::UtcNoPulse => "UTC no pulse",
            Self::AttitudeNotANumber => "attitude not a number",
            Self::AttitudeOutOfRange => "attitude out of range",
            Self::AttitudeSilent => "attitude silent",
            Self::VhUnconfirmed => "V/H unconfirmed",
            Self::NotMeasured => "not measured",
            Self::TemperatureOutside => "temperature outside the table",
            Self::TemperatureUnknown => "temperature unknown",
        }
    }

    /// Returns `true` if the flag concerns an instrument of the aircraft, and not the camera.
    #[must_use]
    pub const fn is_of_instrument(self) -> bool {
        self as u32 >= Self::VhNotANumber as u32 && self as u32 <= Self::VhUnconfirmed as u32
    }

    /// Returns the flag of a finding of V/H; `None` for a recovery.
    #[must_use]
    pub const fn of_vh(kind: VhFindingKind) -> Option<Self> {
        Some(match kind {
            VhFindingKind::NotANumber => Self::VhNotANumber,
            VhFindingKind::OutOfRange => Self::VhOutOfRange,
            VhFindingKind::WrongSign => Self::VhWrongSign,
            VhFindingKind::WrongUnit(WrongUnit::Feet) => Self::VhFeet,
            VhFindingKind::WrongUnit(WrongUnit::Knots) => Self::VhKnots,
            VhFindingKind::Jump => Self::VhJump,
            VhFindingKind::Frozen => Self::VhFrozen,
            VhFindingKind::FromThePast => Self::VhFromThePast,
            VhFindingKind::Disagreement => Self::VhDisagreement,
            VhFindingKind::Recovered => return None,
        })
    }

    /// Returns the flag of a finding of time.
    #[must_use]
    pub const fn of_utc(finding: UtcFinding) -> Self {
        match finding {
            UtcFinding::MissingPulses(_) => Self::UtcMissingPulses,
            UtcFinding::ExtraPulse => Self::UtcExtraPulse,
            UtcFinding::PulsesMoved => Self::UtcPulsesMoved,
            UtcFinding::WrongSecond(_) => Self::UtcWrongSecond,
            UtcFinding::Stepped(_) => Self::UtcStepped,
            UtcFinding::FromThePast => Self::UtcFromThePast,
            UtcFinding::NoPulse => Self::UtcNoPulse,
        }
    }

    /// Returns the flag of a finding of attitude.
    #[must_use]
    pub const fn of_attitude(finding: AttitudeFinding) -> Self {
        match finding {
            AttitudeFinding::NotANumber => Self::AttitudeNotANumber,
            AttitudeFinding::OutOfRange => Self::AttitudeOutOfRange,
            AttitudeFinding::Silent => Self::AttitudeSilent,
        }
    }

    const fn bit(self) -> u64 {
        1 << self as u32
    }
}

/// A set of flags. `serde` writes it as one number, each flag 1 << its place in [`Flag::ALL`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Flags {
    bits: u64,
}

impl Flags {
    /// The empty set.
    pub const NONE: Self = Self { bits: 0 };

    /// Adds a flag.
    pub const fn insert(&mut self, flag: Flag) {
        self.bits |= flag.bit();
    }

    /// Adds all of another set.
    pub const fn insert_all(&mut self, others: Self) {
        self.bits |= others.bits;
    }

    /// Returns `true` if the flag is in the set.
    #[must_use]
    pub const fn contains(self, flag: Flag) -> bool {
        self.bits & flag.bit() != 0
    }

    /// Returns `true` if the set is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.bits == 0
    }

    /// Returns the flags of the set.
    pub fn iter(self) -> impl Iterator<Item = Flag> {
        Flag::ALL
            .into_iter()
            .filter(move |flag| self.contains(*flag))
    }
}
