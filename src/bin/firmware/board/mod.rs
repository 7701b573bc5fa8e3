//! The board under the main loop: chosen by a feature, the same interface for each.
//!
//! A board brings its start-up code, which calls [`crate::run`], and a type `Board` with
//! - `NAME`, and `CAN_POWER_OFF`: whether `power_off` does anything;
//! - `receive`: the next byte from the link, kept by an interrupt until asked for; `overruns`: bytes lost since asked last;
//! - `send`: passes on as many bytes as the transmitter takes now, and never waits;
//! - `feed_watchdog`, to be called from the main loop alone;
//! - `now_us`: microseconds since the start, wrapping;
//! - `idle`: sleeps until an interrupt, unless a byte is already there;
//! - `stack_used_bytes`: the deepest the stack has been since the start;
//! - `reset` and `power_off`, which do not return;
//!
//! and a function `stop_after_panic`, which does not return either.

mod inbox;
mod panic;

#[cfg(feature = "board-mps2")]
mod mps2;
#[cfg(feature = "board-mps2")]
pub(crate) use mps2::Board;
#[cfg(feature = "board-mps2")]
use mps2::stop_after_panic;
