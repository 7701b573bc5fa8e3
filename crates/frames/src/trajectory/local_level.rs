//! Coordinates east, north and up about an origin.

use map_3d::Ellipsoid;
use nalgebra::Matrix3;

use super::image_orientation::{GeographicPlace, ImageOrientation, Place};
use super::rotation::{angles, ground_from_body};
use super::sample::OrientationSigma;

impl ImageOrientation {
    /// Returns the same orientation in coordinates east, north and up of an origin, to whose axes
    /// the angles then refer; one that is Cartesian already stays as it is.
    ///
    /// # Model
    /// By the Earth-centred coordinates of WGS 84, without any projection: the plane of east and
    /// north touches the ellipsoid's parallel surface in the origin, so that a place 10 km off at
    /// the same height has an up of -7.8 m.
    #[must_use]
    pub fn about(&self, origin: &GeographicPlace) -> Self {
        let Place::Geographic(place) = self.place else {
            return *self;
        };
        let (east, north, up) = map_3d::geodetic2enu(
            place.latitude_rad,
            place.longitude_rad,
            place.height_m,
            origin.latitude_rad,
            origin.longitude_rad,
            origin.height_m,
            Ellipsoid::WGS84,
        );
        let rotation = origin_from_place(origin, &place);
        let body = ground_from_body(&self.attitude).to_rotation_matrix();
        let velocity = rotation * nalgebra::Vector3::from(self.velocity_m_s);
        let turned = |sigma: &OrientationSigma| {
            let variance = nalgebra::Vector3::from(sigma.position_m.map(|sigma| sigma * sigma));
            let variance = rotation.component_mul(&rotation) * variance;
            OrientationSigma {
                position_m: variance.map(f64::sqrt).into(),
                angles_rad: sigma.angles_rad,
            }
        };
        Self {
            place: Place::Cartesian([east, north, up]),
            attitude: angles(&(rotation * body.matrix())),
            velocity_m_s: velocity.into(),
            trajectory_sigma: self.trajectory_sigma.as_ref().map(turned),
            time_sigma: turned(&self.time_sigma),
            interpolation_sigma: turned(&self.interpolation_sigma),
        }
    }
}

/// Returns the rotation from east, north and up of a place to those of an origin.
fn origin_from_place(origin: &GeographicPlace, place: &GeographicPlace) -> Matrix3<f64> {
    let column = |[east, north, up]: [f64; 3]| {
        let (u, v, w) = map_3d::enu2uvw(east, north, up, place.latitude_rad, place.longitude_rad);
        let (east, north, up) = map_3d::uvw2enu(u, v, w, origin.latitude_rad, origin.longitude_rad);
        nalgebra::Vector3::new(east, north, up)
    };
    Matrix3::from_columns(&[
        column([1.0, 0.0, 0.0]),
        column([0.0, 1.0, 0.0]),
        column([0.0, 0.0, 1.0]),
    ])
}
