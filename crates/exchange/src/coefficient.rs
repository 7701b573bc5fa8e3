//! Coefficients of the pinhole formula that a fit may choose.

use crate::pinhole::Pinhole;

/// A number of [`Pinhole`] that is free in a fit; the others are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coefficient {
    /// k1..k4, counted from 0.
    Radial(usize),
    /// d1..d3, counted from 0: k4..k6 of `OpenCV`.
    Divisor(usize),
    /// p1, p2, counted from 0.
    Decentring(usize),
    /// s1..s4, counted from 0.
    Prism(usize),
    /// τx, τy, counted from 0.
    Tilt(usize),
    /// fx, while fy is held.
    FocalX,
    /// Skew.
    Skew,
}

impl Coefficient {
    /// Returns its place in a camera; `None` for a number that the formula does not have.
    pub(crate) fn of<T>(self, camera: &mut Pinhole<T>) -> Option<&mut T> {
        match self {
            Self::Radial(index) => camera.radial.get_mut(index),
            Self::Divisor(index) => camera.divisor.get_mut(index),
            Self::Decentring(index) => camera.decentring.get_mut(index),
            Self::Prism(index) => camera.prism.get_mut(index),
            Self::Tilt(index) => camera.tilt.get_mut(index),
            Self::FocalX => camera.focal_px.first_mut(),
            Self::Skew => Some(&mut camera.skew_px),
        }
    }
}
