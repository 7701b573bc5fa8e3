//! Network: images, object points and all observations.

use nalgebra::Vector3;

use super::additional::AdditionalColumns;
use super::image::NetworkImage;
use super::parameters::{Parameter, Prior, SharedValues};

/// Part that an object point plays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointRole {
    /// Its given coordinates are observed or held.
    Control,
    /// Its given coordinates are compared with the adjusted ones and have no influence.
    Check,
    /// Its coordinates are unknown.
    Tie,
}

/// An object point.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectPoint {
    /// Name.
    pub name: String,
    /// Given coordinates, those of a tie point approximate, ground frame, m.
    pub given_m: Vector3<f64>,
    /// σ of the given coordinates, m; 0: held; `None`: not given.
    pub sigmas_m: [Option<f64>; 3],
    /// Part that it plays.
    pub role: PointRole,
}

impl ObjectPoint {
    /// Returns true if all three coordinates are held.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.role == PointRole::Control
            && self
                .sigmas_m
                .iter()
                .all(|sigma| sigma.is_some_and(|sigma| sigma <= 0.0))
    }

    /// σ of the coordinates that are observed, m.
    #[must_use]
    pub fn observed_sigmas(&self) -> [Option<f64>; 3] {
        if self.role == PointRole::Control {
            self.sigmas_m
        } else {
            [None; 3]
        }
    }
}

/// Image point of an object point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImagePoint {
    /// Number of the image.
    pub image: usize,
    /// Number of the object point.
    pub point: usize,
    /// Measured point, in an image with a record reduced by it to the calibrated principal point
    /// and principal distance; sensor frame, mm.
    pub measured_mm: [f64; 2],
    /// Distortion that the residual grids of the camera add at the measured point,
    /// measured - ideal, in the scale of `measured_mm`, mm.
    pub by_grids_mm: [f64; 2],
    /// σ of either coordinate, mm.
    pub sigma_mm: f64,
    /// Number of its row in [`Network::additional`]; `None` for one that additional parameters do
    /// not move.
    pub additional: Option<u32>,
    /// `false` for one that gross error detection rejected.
    pub accepted: bool,
}

/// Measured distance of two object points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaleBar {
    /// Numbers of the points.
    pub ends: [usize; 2],
    /// Length, m.
    pub length_m: f64,
    /// σ, m.
    pub sigma_m: f64,
}

/// Images, object points, observations and shared unknowns.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    /// Images.
    pub images: Vec<NetworkImage>,
    /// Object points.
    pub points: Vec<ObjectPoint>,
    /// Image points, in ascending order of object point, then image.
    pub image_points: Vec<ImagePoint>,
    /// Distortion of image points by the additional parameters.
    pub additional: Vec<AdditionalColumns>,
    /// Scale bars.
    pub scale_bars: Vec<ScaleBar>,
    /// Names of the strips.
    pub strips: Vec<String>,
    /// Initial values of the shared unknowns.
    pub parameters: SharedValues,
    /// Shared unknowns that are estimated.
    pub estimated: Vec<Parameter>,
    /// Observed values of shared unknowns.
    pub priors: Vec<Prior>,
}

impl Network {
    /// Brings the image points into their order.
    pub fn sort(&mut self) {
        self.image_points
            .sort_by_key(|observed| (observed.point, observed.image));
    }

    /// Distortion of an image point by the additional parameters; `None` without any.
    #[must_use]
    pub fn additional(&self, observed: &ImagePoint) -> Option<&AdditionalColumns> {
        let row = usize::try_from(observed.additional?).ok()?;
        self.additional.get(row)
    }

    /// Image points of one object point after another, accepted or not.
    pub fn by_point(&self) -> impl Iterator<Item = &[ImagePoint]> {
        self.image_points.chunk_by(|a, b| a.point == b.point)
    }

    /// Name of a shared unknown.
    #[must_use]
    pub fn parameter_name(&self, parameter: Parameter) -> String {
        parameter.name(&self.strips, |point| {
            self.points
                .get(point)
                .map_or_else(String::new, |point| point.name.clone())
        })
    }
}
