//! The board under the main loop: chosen by a feature, the same interface for each.
//!
//! A board brings a type `Board` with
//! - `start`: the board and the cause of its start; `None` if the start fails;
//! - `NAME`, and `CAN_POWER_OFF`: `true` if `power_off` switches the power off;
//! - `store` and `records`, where the feature `store` is on: the store of the calibration and the
//!   ring of records in the board's flash;
//! - `reset_at_most_ms`: the longest time from the last round before the start until `now_us`
//!   counted again, if it is known;
//! - `flight_memory`: memory that a reset leaves alone, by the cause of the start;
//! - `deck`: the camera of the link, a type `Deck`, not prepared; `fly`: makes a round of the
//!   control loop if one is due, and never waits;
//! - `receive`: the next byte from the link, kept by an interrupt until it is taken; `overruns`:
//!   bytes lost since the last call;
//! - `send`: passes on as many bytes as the transmitter takes now, and never waits;
//! - `feed_watchdog`, to be called from the main loop alone;
//! - `idle`: sleeps until an interrupt, unless a byte is already there;
//! - `stack_used_bytes`: the greatest depth of the stack since the start;
//! - `reset` and `power_off`, which wait, with a bound, until the last byte has left, and do not
//!   return;
//!
//! and functions `stop_after_panic` and `stop_after_fault`, which do not return either, `now_us`:
//! microseconds since the start, wrapping, also for the log, and `carry_log`, which transports the
//! log's bytes or drops them, without waiting for a reader.

mod cause;
mod flight_memory;
mod hard_fault;
mod log;
mod memory_guard;
mod panic;
mod receive_ring;
mod stack;
#[cfg(feature = "store")]
mod trust;
mod wire_ring;

#[cfg(feature = "board-mps2")]
mod mps2;
#[cfg(feature = "board-nucleo-h743zi")]
mod nucleo_h743zi;

#[cfg(feature = "board-mps2")]
use mps2 as chosen;
#[cfg(feature = "board-nucleo-h743zi")]
use nucleo_h743zi as chosen;

pub(crate) use chosen::{Board, Deck};
use chosen::{stop_after_fault, stop_after_panic};

#[cortex_m_rt::entry]
fn main() -> ! {
    match Board::start() {
        Some((board, start)) => crate::run(board, start),
        None => cortex_m::peripheral::SCB::sys_reset(),
    }
}
