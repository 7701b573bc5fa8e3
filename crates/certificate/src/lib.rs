//! The certificate of a calibrated camera, and the signature by which a camera stores its
//! calibration.

#![forbid(unsafe_code)]

pub mod bundle;
pub mod calibration_signature;
pub mod calibration_summary;
pub mod check;
pub mod content;
pub mod details;
pub mod document;
pub mod figure;
pub mod flown_calibrations;
pub mod html;
pub mod pdf;
pub mod pdf_reader;
pub mod requirement;
pub mod signature;
pub mod stated;
