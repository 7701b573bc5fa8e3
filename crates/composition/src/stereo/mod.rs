//! Stereo check: a bundle of two virtual images over control and check points.

mod adjustment;
mod layout;
mod repetition;
mod ties;

pub use adjustment::{StereoPoint, StereoRequest, StereoResult, adjust};
pub use layout::Layout;
pub use repetition::{BaseAlong, Repetitions, repeated};
pub use ties::matched_ties;
