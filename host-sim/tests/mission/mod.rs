//! Flights with the camera's own code in the loop, against the physical exposure.

#[cfg(test)]
mod determinism;
#[cfg(test)]
mod faults;
#[cfg(test)]
mod hardware;
#[cfg(test)]
mod nominal;
#[cfg(test)]
mod stall;
#[cfg(test)]
mod support;
#[cfg(test)]
mod sweep;
