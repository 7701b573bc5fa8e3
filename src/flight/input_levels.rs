//! Inputs that the control loop looks at: limit switches and supply.

/// What the lines say in a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InputLevels {
    /// The limit switch at the negative end of the travel is closed.
    pub limit_low: bool,
    /// The one at the positive end.
    pub limit_high: bool,
    /// The supply is too low to move the stage.
    pub supply_low: bool,
}

impl InputLevels {
    /// Nothing is wrong.
    pub const GOOD: Self = Self {
        limit_low: false,
        limit_high: false,
        supply_low: false,
    };

    /// Whether a limit switch has closed since.
    #[must_use]
    pub const fn has_closed_since(&self, before: &Self) -> bool {
        (self.limit_low && !before.limit_low) || (self.limit_high && !before.limit_high)
    }
}
