//! Reports of verifications, calibrations, simulations and budgets: tables, machine-readable files,
//! figures, pages.

#![forbid(unsafe_code)]

pub mod arrow;
pub mod arrow_field;
mod arrow_scale;
pub mod block_experiment;
pub mod budget;
pub mod calibration;
pub mod calibration_identity;
pub mod camera_status;
pub mod campaign;
pub mod chart;
pub mod composition;
pub mod exchange;
pub mod figure;
pub mod hash;
pub mod images;
mod legend;
mod length;
pub mod limits;
pub mod mission;
pub mod page;
mod picture;
pub mod records;
pub mod smear;
pub mod statistics;
pub mod stored_calibration;
pub mod strip_experiment;
pub mod sweep;
pub mod terminal;
pub mod verification;
pub mod wording;
