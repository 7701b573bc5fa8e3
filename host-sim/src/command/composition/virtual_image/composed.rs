//! An exposure, composed, and the choices of its composition.

use fmc_composition::mosaic::registration::Registration;
use fmc_composition::mosaic::{Composite, GreenMatch, SeamStep};
use fmc_composition::rig::control::Tie;
use fmc_rectification::Resampling;

use crate::cli::OrderName;

/// An exposure, composed.
#[derive(Debug)]
pub(in crate::command::composition) struct Composed {
    pub(in crate::command::composition) composite: Composite,
    pub(in crate::command::composition) steps: Vec<SeamStep>,
    pub(in crate::command::composition) green: Option<(GreenMatch, Registration)>,
    pub(in crate::command::composition) ties: Vec<Tie>,
}

/// Choices of a composition.
#[derive(Debug, Clone, Copy)]
pub(in crate::command::composition) struct Choices {
    pub(in crate::command::composition) order: OrderName,
    pub(in crate::command::composition) kernel: Resampling,
    pub(in crate::command::composition) feather_px: usize,
}
