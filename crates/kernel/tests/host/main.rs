//! Bits of a PC's kernel, which are those of the portable one with all vectors, threads and stores.
//!
//! A machine runs the levels that it has. The NEON level runs on any Linux under QEMU, on Debian
//! with the packages `gcc-aarch64-linux-gnu`, `libc6-dev-arm64-cross` and `qemu-user-static`:
//!
//! ```sh
//! export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
//! export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64-static -L /usr/aarch64-linux-gnu"
//! rustup target add aarch64-unknown-linux-gnu
//! cargo test --release --target aarch64-unknown-linux-gnu -p fmc-camera-kernel --features host --test host
//! ```
//!
//! Without rustup, `RUSTC_BOOTSTRAP=1 cargo test -Zbuild-std` with the same arguments builds the
//! standard library from its sources. The emulated ten million points take some minutes;
//! `-- --skip ten_million` leaves them out.

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
