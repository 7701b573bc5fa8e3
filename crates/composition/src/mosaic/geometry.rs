//! Places of a sub-image in the virtual image, and back.

use super::registration::Registration;
use crate::number::real;
use crate::rig::polynomial::{Polynomial, normalised};

/// Way from a sub-image to the virtual image: its polynomial and, where the virtual image is made
/// by registration, one polynomial over the whole frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Width and height of the sub-image, px.
    pub size_px: [usize; 2],
    /// Polynomial of the sub-image.
    pub polynomial: Polynomial,
    /// Polynomial of the frame, from the mosaic to the virtual image.
    pub registration: Option<Registration>,
}

impl Geometry {
    /// Returns the place in the virtual image of a pixel.
    #[must_use]
    pub fn virtual_px(&self, pixel: [f64; 2]) -> [f64; 2] {
        let place = self.polynomial.value(normalised(self.size_px, pixel));
        match &self.registration {
            Some(registration) => registration.at(place),
            None => place,
        }
    }

    /// Returns the pixel, on the sub-image or beyond, of a place in the virtual image; `None`
    /// beyond the range of the polynomials.
    #[must_use]
    pub fn pixel(&self, place: [f64; 2]) -> Option<[f64; 2]> {
        let place = match &self.registration {
            Some(registration) => registration.inverse(place)?,
            None => place,
        };
        let [xi, eta] = self.polynomial.inverse(place, self.start(place))?;
        let [width, height] = self.size_px.map(real);
        let half = height / 2.0;
        Some([xi * half + width / 2.0, eta * half + half])
    }

    /// Returns the normalised place by the linear part of the polynomial.
    fn start(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let [u0, v0] = self.polynomial.value([0.0; 2]);
        let linear = self.polynomial.derivatives([0.0; 2]).try_inverse();
        linear.map_or([0.0; 2], |inverse| {
            (inverse * nalgebra::Vector2::new(u - u0, v - v0)).into()
        })
    }
}
