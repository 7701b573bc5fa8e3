//! Reports of verifications, calibrations, simulations and budgets: tables, machine-readable files,
//! figures, pages.

#![forbid(unsafe_code)]

pub mod arrow;
pub mod arrow_field;
mod arrow_scale;
#[cfg(feature = "full")]
pub mod block_experiment;
#[cfg(feature = "full")]
pub mod board_inputs;
pub mod budget;
#[cfg(feature = "full")]
pub mod calibration;
#[cfg(feature = "full")]
pub mod calibration_identity;
#[cfg(feature = "full")]
pub mod camera_status;
#[cfg(feature = "full")]
pub mod campaign;
pub mod chart;
#[cfg(feature = "full")]
pub mod composition;
#[cfg(feature = "exchange")]
pub mod exchange;
pub mod figure;
#[cfg(feature = "exchange")]
pub mod hash;
#[cfg(feature = "full")]
pub mod images;
#[cfg_attr(
    not(feature = "full"),
    expect(dead_code, reason = "figures of flights and calibrations use the rest")
)]
mod legend;
mod length;
#[cfg(feature = "full")]
pub mod limits;
#[cfg(feature = "full")]
pub mod mission;
pub mod page;
#[cfg(feature = "full")]
mod picture;
#[cfg(feature = "full")]
pub mod records;
#[cfg(feature = "full")]
pub mod smear;
#[cfg(feature = "full")]
pub mod statistics;
#[cfg(feature = "full")]
pub mod stored_calibration;
#[cfg(feature = "full")]
pub mod strip_experiment;
#[cfg(feature = "full")]
pub mod sweep;
pub mod terminal;
pub mod verification;
pub mod wording;
