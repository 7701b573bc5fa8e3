//! Differences of images.

pub mod kernel_result;
pub mod shift_field;
