//! `rectify`: whole frames as a camera without distortion would have recorded them.

mod block;
mod exposure;
mod frame;
pub(in crate::command) mod frame_flow;
mod manifest;
mod notes;
mod options;
mod progress;
mod recorded_frame;
mod rectified_camera;
mod request;
mod sidecar;
mod task;

pub(super) use block::run;

/// Version that wrote a rectified frame.
const VERSION: &str = env!("CARGO_PKG_VERSION");
