//! Inputs that the control loop reads: limit switches and supply.

/// Levels of the lines in a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct InputLevels {
    /// The limit switch at the negative end of the travel is closed.
    pub limit_low: bool,
    /// The one at the positive end.
    pub limit_high: bool,
    /// The supply is too low to move the stage.
    pub supply_low: bool,
}

impl InputLevels {
    /// Levels without a fault.
    pub const GOOD: Self = Self {
        limit_low: false,
        limit_high: false,
        supply_low: false,
    };

    /// Returns `true` if a limit switch has closed since.
    #[must_use]
    pub(crate) const fn has_closed_since(&self, before: &Self) -> bool {
        (self.limit_low && !before.limit_low) || (self.limit_high && !before.limit_high)
    }

    /// Returns the same levels, with each limit switch as last known if its level has just changed.
    pub(crate) const fn with_steady_limits(&self, before: &Self, known: &Self) -> Self {
        Self {
            limit_low: if self.limit_low == before.limit_low {
                self.limit_low
            } else {
                known.limit_low
            },
            limit_high: if self.limit_high == before.limit_high {
                self.limit_high
            } else {
                known.limit_high
            },
            supply_low: self.supply_low,
        }
    }
}
