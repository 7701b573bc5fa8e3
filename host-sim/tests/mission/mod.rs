//! Flights with the camera's own code in the loop, against the physical exposure.

#[cfg(test)]
mod determinism;
mod drawn;
mod encoders;
#[cfg(test)]
mod faults;
#[cfg(test)]
mod hardware;
mod judged;
mod lost_counts;
#[cfg(test)]
mod nominal;
#[cfg(test)]
mod position_command;
mod safety_document;
mod senders;
#[cfg(test)]
mod stall;
#[cfg(test)]
mod support;
#[cfg(test)]
mod sweep;
#[cfg(test)]
mod temperature;
#[cfg(test)]
mod vh_statistics;
mod wires;
