//! Bits of a PC's kernel, which are those of the portable one with all vectors, threads and stores.
//!
//! A machine runs the levels that it has. `cargo xtask aarch64` runs that of NEON on any Linux,
//! under QEMU, but for the ten million points, which would take minutes.

#[cfg(test)]
mod call;
#[cfg(test)]
mod corners;
#[cfg(test)]
mod distort;
#[cfg(test)]
mod form;
#[cfg(test)]
mod places;
#[cfg(test)]
mod random;
#[cfg(test)]
mod runs;
