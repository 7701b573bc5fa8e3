//! The strict reference solver: the same physics as the camera, in double precision, by
//! quadrature, sharing no code with it.

pub mod exposure;
pub mod fitted;
pub mod lens;
pub mod strict;
