//! Resampling: bits on every instruction set, grey values and ramps against double precision.
//!
//! `tests/host` says how the NEON level is run on a machine without it.

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
