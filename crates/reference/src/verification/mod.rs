//! Verification: every coordinate of real cameras, compared with the strict reference solver.

pub mod cameras;
pub mod device;
pub mod grid;
pub mod result;
pub mod run;
