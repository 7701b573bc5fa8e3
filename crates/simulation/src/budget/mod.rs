//! Error budget of a camera: the effect of each source of error on image and ground coordinates.

pub mod assumptions;
pub mod result;
pub mod run;
