//! Library of the program `host-sim`: command line, commands, devices with the client of the
//! camera, and file formats.

pub mod cli;
pub mod command;
pub mod device;
pub mod failure;
pub mod formats;
