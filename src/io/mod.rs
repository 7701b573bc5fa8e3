//! What crosses the camera's boundary.

#[cfg(feature = "link")]
pub mod link;
