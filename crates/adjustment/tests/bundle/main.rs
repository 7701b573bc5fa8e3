//! Bundle and resection, as a user of the crate calls them.

#[cfg(test)]
mod aerial;
#[cfg(test)]
mod camcal;
#[cfg(test)]
mod checkerboard;
#[cfg(test)]
mod convergence;
#[cfg(test)]
mod coverage;
#[cfg(test)]
mod data;
#[cfg(test)]
mod datum;
#[cfg(test)]
mod geometry;
#[cfg(test)]
mod gridded;
#[cfg(test)]
mod platform;
#[cfg(test)]
mod refused;
#[cfg(test)]
mod simulated;
#[cfg(test)]
mod snooping;
#[cfg(test)]
mod stage;
#[cfg(test)]
mod strasbourg;
#[cfg(test)]
mod units;
#[cfg(test)]
mod vertical;
