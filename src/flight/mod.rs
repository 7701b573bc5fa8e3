//! The camera in flight: events in, actions out. So far the prediction of one exposure.

pub mod camera;
pub mod exposure;
pub mod frame_record;
pub mod stage;
