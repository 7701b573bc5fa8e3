//! Rectification against double precision: windows, places, rows, geometry.

#![cfg_attr(
    test,
    expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "places of pixels and samples, which are in range"
    )
)]

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
