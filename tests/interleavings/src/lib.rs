//! Memory that interrupts and the main loop share, in every order of their steps.
//!
//! `loom` runs each model once for every order in which its threads can take their steps, and for
//! every value that a load may see. The code is that of the library and of the board's firmware,
//! copied by `build.rs` with atomics that `loom` controls. Each model is also run over copies with
//! one fault, which it must find.

#![cfg(test)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::indexing_slicing,
    reason = "tests"
)]

#[allow(unreachable_pub, reason = "items of the ring's public trait")]
mod atomic;
mod ring;
mod round_guard;
mod runs;
mod shutter;
#[allow(
    clippy::needless_pass_by_value,
    clippy::unused_self,
    reason = "registers are used as those of the board's crate"
)]
mod timer;
