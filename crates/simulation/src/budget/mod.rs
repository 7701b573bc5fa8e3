//! What each source of error costs a camera.

pub mod assumptions;
pub mod result;
pub mod run;
