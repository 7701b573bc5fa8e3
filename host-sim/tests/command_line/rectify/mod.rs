//! Whole frames.

mod block;
mod image;
mod refused;
mod scene;
