//! V/H: from the aircraft's samples of speed and height, or given directly.

pub mod channel;
mod estimate;
pub mod finding;
pub mod monitor;
mod sample;
pub mod settings;
#[cfg(test)]
mod tests;

pub use channel::CONSISTENT_SAMPLES;
pub use estimate::{VhEstimate, VhSource};
pub use finding::{VhChannel, VhCounters, VhFinding, VhFindingKind, WrongUnit};
pub use monitor::VhMonitor;
pub use sample::VhSample;
pub use settings::{ChannelSettings, VhSettings};
