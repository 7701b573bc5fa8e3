//! The simulated stage, and the library's drive on it.

#![allow(
    clippy::large_types_passed_by_value,
    reason = "a stage is described anew in each test"
)]

#[cfg(test)]
mod convergence;
#[cfg(test)]
mod faults;
#[cfg(test)]
mod following_error;
#[cfg(test)]
mod margins;
#[cfg(test)]
mod profile;
#[cfg(test)]
mod stage;
#[cfg(test)]
mod stall;
#[cfg(test)]
mod support;
