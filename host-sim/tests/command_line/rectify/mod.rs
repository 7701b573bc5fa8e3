//! Whole frames.

mod block;
mod image;
#[cfg(target_os = "linux")]
mod memory;
mod refused;
mod scene;
