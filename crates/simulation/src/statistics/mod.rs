//! Statistics over random missions: cameras, mechanisms, settings and flights drawn from a seed.
//!
//! A σ is tested by its coverage: over many flights, none of which was chosen, error/σ of every
//! quantity has a root mean square of 1, and nothing that was not injected ends a flight.

pub mod draw;
mod drawn_fault;
pub mod mission;
mod random;
pub mod summary;
