//! The camera's state machine: one frame from trigger to record.

pub mod state;
