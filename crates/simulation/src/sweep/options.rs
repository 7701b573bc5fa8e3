//! Options of a sweep.

use fmc_camera_file::Per;
use fmc_reference::exposure::FocusFormula;
use fmc_reference::strict::{Reading, Weight};

/// Options of a sweep; the run-up is that of the camera file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepOptions {
    /// Standard deviation of the noise on dx and on dy, mm.
    pub noise_mm: f64,
    /// Δz beyond the run-out, mm.
    pub focus_shift_mm: f64,
    /// Formula that converts it into distortion.
    pub focus_formula: FocusFormula,
    /// Seed of the noise.
    pub seed: u64,
    /// Weight of the mean over the exposure.
    pub weight: Weight,
    /// Reading of eqs. 12-13.
    pub reading: Reading,
    /// `true` if `K_d1` = 2`P_m1` is imposed.
    pub tied: bool,
    /// Factor of `K_d1` and `P_m1` in the model.
    pub regressor: Per,
}

/// Case of a simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Case {
    /// Motion and focus shift of the camera.
    Both,
    /// Mean focus shift of every exposure, without motion; the regressor keeps its values.
    FocusAlone,
    /// Motion without focus shift and run-out.
    MotionAlone,
}

impl Case {
    /// All cases.
    pub const ALL: [Self; 3] = [Self::Both, Self::FocusAlone, Self::MotionAlone];

    /// Returns the name in `summary.json`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Both => "both",
            Self::FocusAlone => "focus-alone",
            Self::MotionAlone => "motion-alone",
        }
    }

    /// Returns the name in reports.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Both => "focus shift and motion",
            Self::FocusAlone => "focus shift alone",
            Self::MotionAlone => "motion alone",
        }
    }
}
