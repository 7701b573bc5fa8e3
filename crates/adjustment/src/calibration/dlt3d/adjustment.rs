//! Adjustment of the eleven unknowns of a direct linear transformation together with distortion.

use nalgebra::{Rotation3, Vector3};

use super::super::least_squares::{Linearised, Model};
use super::pinhole::{ELEVEN, Pinhole};

/// Coefficients that can be estimated beside the eleven: K1, K2, K3, P1, P2.
pub(super) const COEFFICIENTS: usize = 5;

/// An image point of a known object point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub(super) measured_mm: [f64; 2],
    /// Distortion that the residual grids of the camera file add at it, mm.
    pub(super) by_grids_mm: [f64; 2],
    pub(super) sigma_mm: f64,
    /// From the mean of all points, m.
    pub(super) object_m: Vector3<f64>,
}

/// The camera of the moment, with its observations.
#[derive(Debug, Clone)]
pub(super) struct Resected<'a> {
    pub(super) camera: Pinhole,
    pub(super) pairs: &'a [Pair],
    pub(super) is_estimated: [bool; COEFFICIENTS],
}

impl Resected<'_> {
    fn coefficients(&self) -> impl Iterator<Item = usize> {
        let flags = self.is_estimated.into_iter().enumerate();
        flags.filter_map(|(index, is_estimated)| is_estimated.then_some(index))
    }
}

/// Order of the unknowns: f, x0, y0, B1, B2; S; rotation in camera axes; coefficients.
impl Model<2> for Resected<'_> {
    fn unknowns(&self) -> usize {
        ELEVEN + self.coefficients().count()
    }

    fn observations(&self) -> usize {
        self.pairs.len()
    }

    fn sigma_mm(&self, index: usize) -> f64 {
        self.pairs.get(index).map_or(1.0, |pair| pair.sigma_mm)
    }

    /// # Model
    /// With u = radial and decentring distortion + residual grids + collinearity,
    /// `v_x = x̄ - (u_x + B2·u_y)/(1 - B1)`, `v_y = ȳ - u_y`: the corrected point less the
    /// collinearity point, in the scale of the measured coordinates.
    fn linearised(&self, index: usize) -> Option<Linearised<2>> {
        let pair = self.pairs.get(index)?;
        let camera = &self.camera;
        let [x, y] = pair.measured_mm;
        let [x0, y0] = camera.principal_point_mm;
        let point = [x - x0, y - y0];
        let [xr, yr] = point;
        let ([dx, dy], [[dxx, dxy], [dyx, dyy]]) = camera.radial_and_decentring(point);
        let direction = camera.in_camera(&pair.object_m);
        if direction.z >= 0.0 {
            return None;
        }
        let f = camera.principal_distance_mm;
        let scale = -f / direction.z;
        let [ix, iy] = [scale * direction.x, scale * direction.y];
        let [of_grids_x, of_grids_y] = pair.by_grids_mm;
        let [ux, uy] = [dx + of_grids_x + ix, dy + of_grids_y + iy];
        let [b1, b2] = camera.affinity;
        let stretch = (1.0 - b1).recip();
        // Derivatives of u by an unknown, carried to the residual.
        let of_u = |by_x: f64, by_y: f64| [-stretch * (by_x + b2 * by_y), -by_y];
        // Derivatives of the collinearity point by the direction in camera axes.
        let of_direction = |by: Vector3<f64>| {
            of_u(
                scale * (by.x + ix / f * by.z),
                scale * (by.y + iy / f * by.z),
            )
        };
        let mut columns: Vec<[f64; 2]> = Vec::with_capacity(self.unknowns());
        columns.push(of_u(ix / f, iy / f));
        let [by_x0, by_y0] = [of_u(-dxx, -dyx), of_u(-dxy, -dyy)];
        columns.push([by_x0[0] - 1.0, by_x0[1]]);
        columns.push([by_y0[0], by_y0[1] - 1.0]);
        columns.push([-(ux + b2 * uy) * stretch * stretch, 0.0]);
        columns.push([-uy * stretch, 0.0]);
        for axis in camera.camera_from_ground.column_iter() {
            columns.push(of_direction(-axis.into_owned()));
        }
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            columns.push(of_direction(axis.cross(&direction)));
        }
        let coefficients = Pinhole::by_coefficients(point);
        for index in self.coefficients() {
            let [by_x, by_y] = coefficients.get(index).copied()?;
            columns.push(of_u(by_x, by_y));
        }
        Some(Linearised {
            residual: [xr - stretch * (ux + b2 * uy), yr - uy],
            derivatives: [
                columns.iter().map(|[by_x, _]| *by_x).collect(),
                columns.iter().map(|[_, by_y]| *by_y).collect(),
            ],
        })
    }

    fn moved(&self, step: &[f64]) -> Option<Self> {
        let (&[f, x0, y0, b1, b2, sx, sy, sz, ax, ay, az], coefficients) =
            step.split_first_chunk::<ELEVEN>()?;
        let mut next = self.clone();
        let camera = &mut next.camera;
        camera.principal_distance_mm += f;
        camera.principal_point_mm[0] += x0;
        camera.principal_point_mm[1] += y0;
        camera.affinity[0] += b1;
        camera.affinity[1] += b2;
        camera.centre_m += Vector3::new(sx, sy, sz);
        camera.camera_from_ground =
            Rotation3::new(Vector3::new(ax, ay, az)).into_inner() * camera.camera_from_ground;
        for (index, change) in self.coefficients().zip(coefficients) {
            camera.add(index, *change)?;
        }
        let [b1, _] = camera.affinity;
        (camera.principal_distance_mm > 0.0 && b1 < 1.0).then_some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_the_limits_of_differences() {
        let camera = Pinhole {
            principal_distance_mm: 51.4,
            principal_point_mm: [0.06, -0.02],
            affinity: [2e-3, -1e-3],
            radial: [-1.6e-5, 6e-9, -1.3e-12],
            decentring: [2e-6, 4.5e-6],
            centre_m: Vector3::new(0.3, -0.2, 6.5),
            camera_from_ground: Rotation3::from_euler_angles(0.1, -0.2, 0.4).into_inner(),
        };
        let pairs = [Pair {
            measured_mm: [17.0, -11.0],
            by_grids_mm: [0.03, -0.02],
            sigma_mm: 1e-3,
            object_m: Vector3::new(1.7, -1.3, 0.4),
        }];
        let model = Resected {
            camera,
            pairs: &pairs,
            is_estimated: [true; COEFFICIENTS],
        };
        let row = model.linearised(0).unwrap();
        let steps = [
            1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-5, 1e-5, 1e-5, 1e-6, 1e-6, 1e-6, 1e-9, 1e-12, 1e-15,
            1e-9, 1e-9,
        ];
        for (unknown, size) in steps.into_iter().enumerate() {
            let at = |sign: f64| {
                let mut step = vec![0.0; steps.len()];
                step[unknown] = sign * size;
                let moved = model.moved(&step).unwrap();
                moved.linearised(0).unwrap().residual
            };
            let (plus, minus) = (at(1.0), at(-1.0));
            for component in 0..2 {
                let difference = (plus[component] - minus[component]) / (2.0 * size);
                let exact = row.derivatives[component][unknown];
                let tolerance = 1e-6 * exact.abs() + 1e-13 / size;
                assert!(
                    (difference - exact).abs() < tolerance,
                    "{unknown} {difference} {exact}"
                );
            }
        }
    }
}
