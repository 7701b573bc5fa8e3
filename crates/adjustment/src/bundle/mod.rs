//! Resection and self-calibrating bundle of a network of images.
//!
//! Frames and signs as in the [crate]: ground metres, camera axes x right, y forward,
//! optical axis -z. Image coordinates are millimetres of the sensor frame.

pub mod additional;
pub mod calibration;
pub mod cofactors;
pub mod correlated_pairs;
pub mod datum;
pub mod eliminated_point;
pub mod error;
pub mod free_cofactors;
pub mod geometry;
pub mod image;
pub mod interior;
pub mod layout;
pub mod network;
pub mod network_of_tables;
pub mod normals;
pub mod orientation;
pub mod outcome;
pub mod parameters;
mod part_of_block;
pub mod plausibility;
pub mod pose;
pub mod ray;
pub mod record_tests;
pub mod records;
pub mod separation;
pub mod snooping;
pub mod solution;
pub mod stage;
pub mod state;
mod stations;
pub mod suspect_control;
pub mod tables;
pub mod tested;
pub mod trial;
pub mod warnings;
