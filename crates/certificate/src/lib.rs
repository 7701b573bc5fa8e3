//! The certificate of a calibrated camera.

#![forbid(unsafe_code)]

pub mod calibration_summary;
pub mod content;
pub mod details;
pub mod document;
pub mod figure;
pub mod hash;
pub mod html;
pub mod pdf;
pub mod stated;
