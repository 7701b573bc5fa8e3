//! Cameras of several detectors: figures and the page of a composition.

pub mod page;
pub mod panels;
pub mod residual_vectors;
