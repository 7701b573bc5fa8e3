//! What a sweep is asked for.

use fmc_camera_file::Per;
use fmc_reference::exposure::FocusFormula;
use fmc_reference::strict::{Reading, Weight};

/// Options of a sweep; the run-up is the camera's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepOptions {
    /// Standard deviation of the noise on dx and on dy, mm.
    pub noise_mm: f64,
    /// Δz beyond the run-out, mm.
    pub focus_shift_mm: f64,
    /// Which formula turns it into distortion.
    pub focus_formula: FocusFormula,
    /// Seed of the noise.
    pub seed: u64,
    /// What weights the mean over the exposure.
    pub weight: Weight,
    /// How eqs. 12-13 are read.
    pub reading: Reading,
    /// Whether `K_d1` = 2`P_m1` is imposed.
    pub tied: bool,
    /// What `K_d1` and `P_m1` are multiplied by.
    pub regressor: Per,
}

/// What is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// Motion and focus shift, as the camera has them.
    Both,
    /// The mean focus shift of every exposure without motion; the regressor keeps its values.
    FocusAlone,
    /// The motion without focus shift and run-out.
    MotionAlone,
}

impl Case {
    /// All.
    pub const ALL: [Self; 3] = [Self::Both, Self::FocusAlone, Self::MotionAlone];

    /// In `summary.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Both => "both",
            Self::FocusAlone => "focus-alone",
            Self::MotionAlone => "motion-alone",
        }
    }

    /// In reports.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Both => "focus shift and motion",
            Self::FocusAlone => "focus shift alone",
            Self::MotionAlone => "motion alone",
        }
    }
}
