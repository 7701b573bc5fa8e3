//! Exterior orientation of an image.

use super::sample::{Attitude, OrientationSigma};

/// A place on or above the ellipsoid of WGS 84.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeographicPlace {
    /// Latitude, rad, north positive.
    pub latitude_rad: f64,
    /// Longitude, rad, east positive.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
}

/// Place of the navigation body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// On the ellipsoid of WGS 84.
    Geographic(GeographicPlace),
    /// x, y, z with z up, m.
    Cartesian([f64; 3]),
}

/// Exterior orientation of an image: that of the navigation body at its centroid.
///
/// It is that of the body, to whose reference point and axes the trajectory refers: neither lever
/// arm nor boresight of the camera is applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageOrientation {
    /// Place of the reference point.
    pub place: Place,
    /// Angles against east, north and up in the place, or against x, y and z.
    pub attitude: Attitude,
    /// Velocity east, north and up, or along x, y and z, m/s.
    pub velocity_m_s: [f64; 3],
    /// σ of the trajectory, where it is stated.
    pub trajectory_sigma: Option<OrientationSigma>,
    /// σ by that of the centroid's time.
    pub time_sigma: OrientationSigma,
    /// σ of the interpolation.
    pub interpolation_sigma: OrientationSigma,
}

impl ImageOrientation {
    /// Returns σ of the orientation; `None` without that of the trajectory, of which the others are
    /// a small part.
    #[must_use]
    pub fn sigma(&self) -> Option<OrientationSigma> {
        let sigma = self.trajectory_sigma?;
        Some(sigma.with(&self.time_sigma).with(&self.interpolation_sigma))
    }
}
