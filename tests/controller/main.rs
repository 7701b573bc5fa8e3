//! The camera's state machine, as firmware and simulator drive it.

mod bench;
mod faults;
mod nominal;
mod table;
