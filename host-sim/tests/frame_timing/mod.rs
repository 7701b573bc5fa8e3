//! One frame on an ideal stage: the timing diagram and the table of times of `docs/integration.md`.

#[cfg(test)]
mod document;
#[cfg(test)]
mod drawing;
#[cfg(test)]
mod flight;
