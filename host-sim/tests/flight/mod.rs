//! The flight over ground control: truth comes back, standard deviations hold, gains are as stated.

#[cfg(test)]
mod coverage;
#[cfg(test)]
mod paper;
#[cfg(test)]
mod separability;
#[cfg(test)]
mod support;
#[cfg(test)]
mod truth;
