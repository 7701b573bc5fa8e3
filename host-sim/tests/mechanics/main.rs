//! The library's drive on the simulated stage.

#[cfg(test)]
mod explore;
#[cfg(test)]
mod profile;
#[cfg(test)]
mod support;
