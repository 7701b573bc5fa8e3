//! The camera in flight: events in, actions out.

pub mod camera;
pub mod controller;
pub mod drive;
pub mod event;
pub mod exposure;
pub mod fault;
pub mod frame_record;
pub mod interior_orientation;
pub mod rig;
pub mod stage;
pub mod time;
pub mod utc;
pub mod vh;
