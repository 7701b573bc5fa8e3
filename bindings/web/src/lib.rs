//! The camera for a page in a browser: the functions of the library for C, which the page calls as
//! C does, what the motion adds to the distortion over the sensor ([`fmc_web_added`]), and the error
//! budget of a camera ([`fmc_web_budget`]). `cargo xtask web` links them as WebAssembly and puts the
//! module into the page.

#![no_std]
#![deny(unsafe_op_in_unsafe_fn)]

mod added;
mod budget;
mod distortion;
mod exposures;
mod smear;

pub use added::{Added, POINTS, fmc_web_added};
pub use budget::{Assumptions, Budget, SOURCES, fmc_web_budget};
