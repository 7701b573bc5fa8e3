//! Ray of a measured point, for a formula that gives the measured point of a ray.

use crate::pinhole::Pinhole;
use crate::scalar::Sloped;

/// Most steps; quadratic convergence needs six.
const MAX_STEPS: u32 = 50;

/// Length of a step in rays at which the ray is found.
const SMALLEST_STEP: f64 = 1e-15;

/// Largest difference from the measured point that is left, px.
const LARGEST_REST_PX: f64 = 1e-9;

/// Returns the ray of a measured point, px, by Newton's method from the ray without distortion;
/// `None` if none is found. Of a formula that folds it may be a ray beyond the fold.
pub(crate) fn ray(camera: &Pinhole, pixel: [f64; 2]) -> Option<[f64; 2]> {
    let [u, v] = pixel;
    let [fx, fy] = camera.focal_px;
    let [cx, cy] = camera.centre_px;
    let y = (v - cy) / fy;
    let mut ray = [(u - cx - camera.skew_px * y) / fx, y];
    let sloped = camera.map(Sloped::fixed);
    for _ in 0..MAX_STEPS {
        let [x, y] = ray;
        let [u_x, v_x] = sloped.project([Sloped::variable(x), Sloped::fixed(y)]);
        let [u_y, v_y] = sloped.project([Sloped::fixed(x), Sloped::variable(y)]);
        let [du, dv] = [u - u_x.value, v - v_x.value];
        let determinant = u_x.slope * v_y.slope - u_y.slope * v_x.slope;
        let step = [
            (du * v_y.slope - dv * u_y.slope) / determinant,
            (dv * u_x.slope - du * v_x.slope) / determinant,
        ];
        let [step_x, step_y] = step;
        ray = [x + step_x, y + step_y];
        if !(step_x.is_finite() && step_y.is_finite()) {
            return None;
        }
        if step_x.abs().max(step_y.abs()) < SMALLEST_STEP {
            break;
        }
    }
    let [found_u, found_v] = camera.project(ray);
    let rest = (found_u - u).abs().max((found_v - v).abs());
    (rest < LARGEST_REST_PX).then_some(ray)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ray_of_the_pixel_of_a_ray_is_that_ray() {
        let mut camera = Pinhole::ideal(13662.0, [7101.5, 5325.5]);
        camera.radial = [-0.04, 0.03, -0.01, 0.005];
        camera.decentring = [1e-4, -2e-4];
        camera.tilt = [1e-3, -1e-3];
        let [x, y] = ray(&camera, camera.pixel_from_ray([0.5, -0.38])).unwrap();
        assert!((x - 0.5).abs() < 1e-14 && (y + 0.38).abs() < 1e-14);
    }

    #[test]
    fn point_that_no_ray_reaches_has_none() {
        let mut camera = Pinhole::ideal(1000.0, [0.0, 0.0]);
        // x/(1 + x²) is never more than ½.
        camera.divisor[0] = 1.0;
        assert_eq!(ray(&camera, [600.0, 0.0]), None);
        let [x, _] = ray(&camera, [400.0, 0.0]).unwrap();
        assert!((x - 0.5).abs() < 1e-12, "{x}");
    }
}
