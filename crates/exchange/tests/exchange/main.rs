//! Tests of the exchange with other programs, as a user of the library would check it.

#[cfg(test)]
#[cfg(test)]
mod distorting;
#[cfg(test)]
mod document;
#[cfg(test)]
mod exact;
#[cfg(test)]
mod frames;
#[cfg(test)]
mod mistakes;
#[cfg(test)]
mod others;
#[cfg(test)]
mod published;
#[cfg(test)]
mod refused;
#[cfg(test)]
mod round_trip;
#[cfg(test)]
mod support;
#[cfg(test)]
mod unread;
