//! Collinearity equations, their Jacobian, and the ray back to the ground.

use nalgebra::{Matrix2x3, SMatrix, Vector2, Vector3};

use crate::exterior_orientation::{ELEMENTS, ExteriorOrientation};

/// Derivatives of an image point by the six elements of the exterior orientation, mm/m and mm/rad.
pub type OrientationJacobian = SMatrix<f64, 2, ELEMENTS>;

/// An image point with its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Ideal image point from the principal point, mm.
    pub image_mm: Vector2<f64>,
    /// Derivatives with respect to the exterior orientation.
    pub by_orientation: OrientationJacobian,
    /// Derivatives with respect to the ground point, mm/m.
    pub by_ground: Matrix2x3<f64>,
}

/// Returns the ideal image of a ground point, from the principal point, mm; `None` for a point that
/// is not below the lens.
///
/// # Model
/// `(x, y) = -f·(P_x, P_y)/P_z`, `P = camera_from_ground·(G - S)`: the collinearity equations for
/// an upright positive image.
///
/// # Examples
/// ```
/// use fmc_adjustment::collinearity::image_point;
/// use fmc_adjustment::exterior_orientation::ExteriorOrientation;
/// let level = ExteriorOrientation { position_m: [0.0, 0.0, 1000.0], attitude: [0.0; 3] };
/// let image = image_point(&level, 100.0, [50.0, 0.0, 0.0]).unwrap(); // 100 mm · 50 m / 1000 m
/// assert!((image[0] - 5.0).abs() < 1e-12 && image[1].abs() < 1e-12);
/// ```
#[must_use]
pub fn image_point(
    orientation: &ExteriorOrientation,
    principal_distance_mm: f64,
    ground_m: [f64; 3],
) -> Option<[f64; 2]> {
    let in_camera = in_camera(orientation, ground_m);
    (in_camera.z < 0.0).then(|| {
        let scale = -principal_distance_mm / in_camera.z;
        [scale * in_camera.x, scale * in_camera.y]
    })
}

/// Returns the image point with its analytic Jacobian; `None` as for [`image_point`].
///
/// # Accuracy
/// Agrees with numeric differences to 1e-7 relative (`jacobian_agrees_with_numeric_differences`).
#[must_use]
pub fn projection(
    orientation: &ExteriorOrientation,
    principal_distance_mm: f64,
    ground_m: [f64; 3],
) -> Option<Projection> {
    let [x, y] = image_point(orientation, principal_distance_mm, ground_m)?;
    let in_camera = in_camera(orientation, ground_m);
    let scale = -principal_distance_mm / in_camera.z;
    // d(-f·P_x/P_z) = scale·(dP_x + (x/f)·dP_z).
    let by_camera = scale
        * Matrix2x3::new(
            1.0,
            0.0,
            x / principal_distance_mm,
            0.0,
            1.0,
            y / principal_distance_mm,
        );
    let by_ground = by_camera * orientation.ground_from_camera().transpose();
    let from_centre = Vector3::from(ground_m) - orientation.position();
    let mut by_orientation = OrientationJacobian::zeros();
    by_orientation
        .fixed_columns_mut::<3>(0)
        .copy_from(&-by_ground);
    for (angle, derivative) in orientation.rotation_derivatives().iter().enumerate() {
        by_orientation
            .fixed_columns_mut::<1>(3 + angle)
            .copy_from(&(by_camera * (derivative.transpose() * from_centre)));
    }
    Some(Projection {
        image_mm: Vector2::new(x, y),
        by_orientation,
        by_ground,
    })
}

/// Returns the point at the height `z_m` on the ray of an ideal image point (from the principal
/// point, mm); `None` if the ray does not come down to it.
#[must_use]
pub fn ground_at_height(
    orientation: &ExteriorOrientation,
    principal_distance_mm: f64,
    [x_mm, y_mm]: [f64; 2],
    z_m: f64,
) -> Option<[f64; 2]> {
    let ray = orientation.ground_from_camera() * Vector3::new(x_mm, y_mm, -principal_distance_mm);
    let centre = orientation.position();
    let distance = (z_m - centre.z) / ray.z;
    (ray.z < 0.0 && distance > 0.0)
        .then(|| [centre.x + distance * ray.x, centre.y + distance * ray.y])
}

fn in_camera(orientation: &ExteriorOrientation, ground_m: [f64; 3]) -> Vector3<f64> {
    orientation
        .ground_from_camera()
        .tr_mul(&(Vector3::from(ground_m) - orientation.position()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const F_MM: f64 = 100.0;
    const ORIENTATION: ExteriorOrientation = ExteriorOrientation {
        position_m: [1200.0, -300.0, 2000.0],
        attitude: [0.03, -0.02, 2.5],
    };

    #[test]
    fn jacobian_agrees_with_numeric_differences() {
        for ground in [
            [900.0, 100.0, 80.0],
            [1500.0, -900.0, -20.0],
            [1200.0, -300.0, 0.0],
        ] {
            let analytic = projection(&ORIENTATION, F_MM, ground).unwrap();
            for element in 0..ELEMENTS {
                let step = if element < 3 { 1e-2 } else { 1e-6 };
                let at = |sign: f64| {
                    let mut elements = ORIENTATION.elements();
                    elements[element] += sign * step;
                    let moved = ExteriorOrientation::from_elements(&elements);
                    Vector2::from(image_point(&moved, F_MM, ground).unwrap())
                };
                let numeric = (at(1.0) - at(-1.0)) / (2.0 * step);
                let column = analytic.by_orientation.column(element);
                assert!((numeric - column).norm() < 1e-7 * (1.0 + column.norm()));
            }
            for axis in 0..3 {
                let at = |sign: f64| {
                    let mut moved = ground;
                    moved[axis] += sign * 1e-2;
                    Vector2::from(image_point(&ORIENTATION, F_MM, moved).unwrap())
                };
                let numeric = (at(1.0) - at(-1.0)) / 2e-2;
                assert!((numeric - analytic.by_ground.column(axis)).norm() < 1e-8);
            }
        }
    }

    #[test]
    fn ray_returns_to_the_ground_point() {
        let ground = [900.0, 100.0, 80.0];
        let image = image_point(&ORIENTATION, F_MM, ground).unwrap();
        let [x, y] = ground_at_height(&ORIENTATION, F_MM, image, 80.0).unwrap();
        assert!((x - 900.0).abs() < 1e-9 && (y - 100.0).abs() < 1e-9);
    }

    #[test]
    fn points_above_the_lens_have_no_image() {
        assert_eq!(
            image_point(&ORIENTATION, F_MM, [1200.0, -300.0, 2500.0]),
            None
        );
        assert_eq!(
            ground_at_height(&ORIENTATION, F_MM, [0.0, 0.0], 2500.0),
            None
        );
    }
}
