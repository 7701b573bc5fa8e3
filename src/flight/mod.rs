//! The camera in flight: events in, actions out.

pub mod camera;
pub mod controller;
pub mod drive;
pub mod event;
pub mod event_queue;
pub mod exposure;
pub mod fault;
pub mod flown_deck;
mod following_error;
pub mod frame_record;
pub mod input_levels;
pub mod interior_orientation;
pub mod record_log;
pub mod rig;
pub mod ring;
pub mod round_guard;
pub mod settings;
pub mod shutter_output;
mod slope;
pub mod smear_prediction;
pub mod stage;
pub mod stage_track;
mod stage_watch;
pub mod time;
pub mod unit;
pub mod utc;
pub mod vh;
