//! Rectification against double precision: windows, places, rows, geometry.

#[cfg(test)]
mod cameras;
#[cfg(test)]
mod comparison;
#[cfg(test)]
mod geometry;
#[cfg(test)]
mod places;
#[cfg(test)]
mod rows;
#[cfg(test)]
mod truth;
#[cfg(test)]
mod windows;
