//! Directions of a transformation.

use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::left_out_terms::LeftOut;
use fmc_camera::geometry::sensor::SensorPoint;

use crate::coordinate::Coordinate;

/// Direction of a transformation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Measured -> ideal.
    Correct,
    /// Ideal -> measured.
    Distort,
}

impl Direction {
    /// Sign with which the distortion is added.
    const fn sign(self) -> f32 {
        match self {
            Self::Correct => -1.0,
            Self::Distort => 1.0,
        }
    }

    /// Returns the terms that are left out at the measured point of a pair.
    pub(crate) fn left_out(
        self,
        terms: &LeftOut,
        given: SensorPoint,
        found: SensorPoint,
    ) -> Displacement {
        terms.displacement(match self {
            Self::Correct => given,
            Self::Distort => found,
        })
    }

    /// Returns the answer to a point.
    pub(crate) fn changed<T: Coordinate>(
        self,
        [x, y]: [T; 2],
        found: SensorPoint,
        distortion: [Displacement; 2],
    ) -> [T; 2] {
        let sign = self.sign();
        [
            x.changed(found.x_mm, distortion.map(|part| sign * part.dx_mm)),
            y.changed(found.y_mm, distortion.map(|part| sign * part.dy_mm)),
        ]
    }
}
