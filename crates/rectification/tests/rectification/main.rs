//! Rectification against double precision: windows, places, grey values, geometry.

#[cfg(test)]
mod cameras;
#[cfg(test)]
mod places;
#[cfg(test)]
mod windows;
