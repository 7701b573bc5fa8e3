//! The strip over ground control: true values are found again, standard deviations hold, gains are
//! as stated.

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
