//! V/H: from the aircraft's samples of speed and height, or given directly.

pub mod agreement;
pub mod channel;
mod estimate;
pub mod finding;
mod held;
pub mod monitor;
mod refusal;
mod sample;
pub mod settings;
mod spread;
mod survey;
#[cfg(test)]
mod tests;
pub mod unit_watch;
mod values;
mod variability;

pub use channel::CONSISTENT_SAMPLES;
pub use estimate::{VhEstimate, VhSource};
pub use finding::{VhChannel, VhCounters, VhFinding, VhFindingKind, WrongUnit};
pub use monitor::VhMonitor;
pub use sample::VhSample;
pub use settings::{ChannelSettings, VhSettings};
