//! Resampling: bits on every instruction set, grey values and ramps against double precision.
//!
//! `cargo xtask aarch64` runs the NEON level on a machine without it.

#![cfg_attr(
    test,
    expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "places of pixels and samples, which are in range"
    )
)]

#[cfg(test)]
mod border;
#[cfg(test)]
mod grey;
#[cfg(test)]
mod image;
#[cfg(test)]
mod levels;
#[cfg(test)]
mod ramp;
