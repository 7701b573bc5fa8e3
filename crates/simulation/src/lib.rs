//! Simulation of the camera in double precision: the physical exposure ([`scene`]), the stage under
//! force ([`mechanics`]), flights with the camera in the loop ([`mission`]), over ground control
//! ([`strip_experiment`]) and of blocks with records ([`block_experiment`]), the judge of what the
//! camera recorded ([`judge`]), and what follows from them for a camera ([`smear`], [`sweep`],
//! [`budget`]), over random missions ([`statistics`]) and for faults in every phase ([`campaign`]).
//! A seed makes every run repeatable.

#![forbid(unsafe_code)]

#[cfg(feature = "full")]
pub mod block_experiment;
pub mod budget;
#[cfg(feature = "full")]
pub mod campaign;
#[cfg(feature = "full")]
pub mod judge;
#[cfg(feature = "full")]
pub mod mechanics;
#[cfg(feature = "full")]
pub mod mission;
#[cfg(feature = "full")]
pub mod noise;
#[cfg(feature = "full")]
mod range;
#[cfg(feature = "full")]
mod scenario_kind;
#[cfg(feature = "full")]
mod scenario_text;
#[cfg(feature = "full")]
pub mod scene;
pub mod smear;
#[cfg(feature = "full")]
pub mod statistics;
#[cfg(feature = "full")]
pub mod strip_experiment;
#[cfg(feature = "full")]
pub mod sweep;
pub mod wording;
