//! The camera for a page in a browser: the functions of the library for C, which the page calls as
//! C does, and the error budget of a camera ([`fmc_web_budget`]). `cargo xtask web` links them as
//! WebAssembly and puts the module into the page.

#![no_std]
#![deny(unsafe_op_in_unsafe_fn)]

mod budget;
mod distortion;
mod exposures;
mod smear;

pub use budget::{Assumptions, Budget, SOURCES, fmc_web_budget};
