//! Faults in flight, each with a code that never changes.

use core::fmt;

/// A fault. The code is in records and messages; `docs/integration.md` has cause and remedy of
/// each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Fault {
    /// The stage does not follow: it stands, or falls behind.
    Stall,
    /// The stage moves farther or faster than it is told to.
    Runaway,
    /// The stage moves against its command: motor or encoder is wired the wrong way round.
    WrongDirection,
    /// A limit switch has closed.
    LimitSwitch,
    /// The encoder's readings jump by more than the stage can move, again and again, fail, or
    /// differ from those at the last crossing of the index mark.
    Encoder,
    /// The drive reports that it cannot move the stage.
    Drive,
    /// The stage has been moved across its index mark, and no crossing came.
    IndexMark,
    /// The shutter opened later than it should have.
    ShutterLate,
    /// The shutter did not open.
    ShutterMissing,
    /// The shutter opened or closed without a command, or twice.
    ShutterUnexpected,
    /// The shutter stayed open for too long.
    ShutterLong,
    /// The shutter closed too early.
    ShutterShort,
    /// The control loop came round late.
    Overload,
    /// The clock jumped, or events came from the past.
    Clock,
    /// The supply voltage is low.
    BrownOut,
    /// The camera has started again after its watchdog bit.
    Watchdog,
    /// V/H is lost: every source is silent for longer than its validity, or not trusted.
    VhLost,
}

impl Fault {
    /// All faults, in the order of their codes.
    pub const ALL: [Self; 17] = [
        Self::Stall,
        Self::Runaway,
        Self::WrongDirection,
        Self::LimitSwitch,
        Self::Encoder,
        Self::Drive,
        Self::IndexMark,
        Self::ShutterLate,
        Self::ShutterMissing,
        Self::ShutterUnexpected,
        Self::ShutterLong,
        Self::ShutterShort,
        Self::Overload,
        Self::Clock,
        Self::BrownOut,
        Self::Watchdog,
        Self::VhLost,
    ];

    /// The code: 1x stage, 2x shutter, 3x camera, 4x V/H.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Stall => 10,
            Self::Runaway => 11,
            Self::WrongDirection => 12,
            Self::LimitSwitch => 13,
            Self::Encoder => 14,
            Self::Drive => 15,
            Self::IndexMark => 16,
            Self::ShutterLate => 20,
            Self::ShutterMissing => 21,
            Self::ShutterUnexpected => 22,
            Self::ShutterLong => 23,
            Self::ShutterShort => 24,
            Self::Overload => 30,
            Self::Clock => 31,
            Self::BrownOut => 32,
            Self::Watchdog => 33,
            Self::VhLost => 40,
        }
    }

    /// The name in documents, logs and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Stall => "stall",
            Self::Runaway => "runaway",
            Self::WrongDirection => "wrong direction",
            Self::LimitSwitch => "limit switch",
            Self::Encoder => "encoder",
            Self::Drive => "drive",
            Self::IndexMark => "index mark",
            Self::ShutterLate => "shutter late",
            Self::ShutterMissing => "shutter missing",
            Self::ShutterUnexpected => "shutter unexpected",
            Self::ShutterLong => "shutter long",
            Self::ShutterShort => "shutter short",
            Self::Overload => "overload",
            Self::Clock => "clock",
            Self::BrownOut => "brown-out",
            Self::Watchdog => "watchdog",
            Self::VhLost => "V/H lost",
        }
    }

    const fn bit(self) -> u32 {
        1 << self as u32
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.name(), self.code())
    }
}

/// A set of faults.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Faults {
    bits: u32,
}

impl Faults {
    /// The empty set.
    pub const NONE: Self = Self { bits: 0 };

    /// Adds a fault.
    pub const fn insert(&mut self, fault: Fault) {
        self.bits |= fault.bit();
    }

    /// Adds all of another set.
    pub const fn insert_all(&mut self, others: Self) {
        self.bits |= others.bits;
    }

    /// Returns `true` if the fault is in the set.
    #[must_use]
    pub const fn contains(self, fault: Fault) -> bool {
        self.bits & fault.bit() != 0
    }

    /// Returns `true` if the set is empty.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.bits == 0
    }

    /// Returns the faults in the order of their codes.
    pub fn iter(self) -> impl Iterator<Item = Fault> {
        Fault::ALL
            .into_iter()
            .filter(move |fault| self.contains(*fault))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_rise_and_sets_keep_their_members() {
        for (one, next) in Fault::ALL.iter().zip(Fault::ALL.iter().skip(1)) {
            assert!(one.code() < next.code());
        }
        let mut faults = Faults::NONE;
        assert!(faults.is_empty());
        for fault in Fault::ALL {
            assert!(!faults.contains(fault));
            faults.insert(fault);
            assert!(faults.contains(fault));
        }
        assert!(faults.iter().eq(Fault::ALL));
    }
}
