//! What each source of error costs a camera.

pub mod assumptions;
mod image_motion;
pub mod result;
pub mod run;
