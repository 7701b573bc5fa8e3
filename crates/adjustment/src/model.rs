//! Models of correction that are compared.

/// Correction of image coordinates before and in the adjustment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// No correction.
    Uncorrected,
    /// Static calibration about the calibrated principal point: Yuan et al. 2012, eq. 1.
    Static,
    /// Static calibration, and eqs. 20-21 as printed.
    Printed,
    /// Static calibration, and the enlargement by the focus shift that the camera is told; without
    /// motion.
    Focus,
    /// Static calibration, and `K_m0` alone from self-calibration, which shows how much of the gain
    /// is scale.
    Scale,
    /// All five coefficients from self-calibration, eq. 22.
    FiveCoefficient,
    /// The camera's own correction: exposure mean of the calibration about the moving principal
    /// point.
    Exact,
}

impl Model {
    /// All models, in the order of tables.
    pub const ALL: [Self; 7] = [
        Self::Uncorrected,
        Self::Static,
        Self::Printed,
        Self::Focus,
        Self::Scale,
        Self::FiveCoefficient,
        Self::Exact,
    ];

    /// Returns the name in tables and figures.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Uncorrected => "no correction",
            Self::Static => "static",
            Self::Printed => "static + printed (20)-(21)",
            Self::Focus => "static + known focus shift",
            Self::Scale => "static + fitted K_m0",
            Self::FiveCoefficient => "five coefficients, fitted",
            Self::Exact => "exact",
        }
    }

    /// Returns the name in `summary.json` and `repetitions.csv`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Uncorrected => "none",
            Self::Static => "static",
            Self::Printed => "printed",
            Self::Focus => "focus",
            Self::Scale => "scale",
            Self::FiveCoefficient => "five",
            Self::Exact => "exact",
        }
    }

    /// Returns `true` for each of `K_m0`, `K_m1`, `K_m2`, `K_d1`, `P_m1` that the adjustment
    /// estimates.
    #[must_use]
    pub const fn estimated(self) -> [bool; 5] {
        match self {
            Self::Scale => [true, false, false, false, false],
            Self::FiveCoefficient => [true; 5],
            _ => [false; 5],
        }
    }

    /// Returns the number of coefficients that the adjustment estimates.
    #[must_use]
    pub fn coefficients(self) -> usize {
        self.estimated().iter().filter(|is_free| **is_free).count()
    }

    /// Returns the index in [`Self::ALL`].
    #[must_use]
    pub fn index(self) -> usize {
        Self::ALL
            .iter()
            .position(|model| *model == self)
            .unwrap_or(0)
    }
}
