//! Simulation of the camera in double precision: the physical exposure ([`scene`]), the stage under
//! force ([`mechanics`]), flights with the camera in the loop ([`mission`]), over ground control
//! ([`strip_experiment`]) and of blocks with records ([`block_experiment`]), the judge of what the
//! camera recorded ([`judge`]), and what follows from them for a camera ([`smear`], [`sweep`],
//! [`budget`]), over random missions ([`statistics`]) and for faults in every phase ([`campaign`]).
//! A seed makes every run repeatable.

#![forbid(unsafe_code)]

pub mod block_experiment;
pub mod budget;
pub mod campaign;
pub mod judge;
pub mod mechanics;
pub mod mission;
pub mod noise;
mod range;
mod scenario_kind;
mod scenario_text;
pub mod scene;
pub mod smear;
pub mod statistics;
pub mod strip_experiment;
pub mod sweep;
pub mod wording;
