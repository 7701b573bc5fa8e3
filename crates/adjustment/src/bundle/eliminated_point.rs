//! Normal equations of one object point and the images that show it.

use nalgebra::{Matrix3, Matrix6, Matrix6x3, SMatrix, SVector, Vector2, Vector3, Vector6};

use super::additional;
use super::layout::{CAMERA_UNKNOWNS, Layout};
use super::network::{ImagePoint, Network};
use super::ray::Ray;
use super::state::State;

/// σ of coordinates that are held beside others of the same point that are not, m.
const HELD_SIGMA_M: f64 = 1e-8;

/// Derivatives by all unknowns of the camera; zero for those not estimated.
pub type CameraJacobian = SMatrix<f64, 2, CAMERA_UNKNOWNS>;

/// Weighted derivatives of one image point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedRay {
    /// Number of the image.
    pub image: usize,
    /// v/σ.
    pub residual: Vector2<f64>,
    /// By the pose, over σ.
    pub by_pose: SMatrix<f64, 2, 6>,
    /// By the object point, over σ.
    pub by_point: SMatrix<f64, 2, 3>,
    /// By the camera, over σ.
    pub by_camera: CameraJacobian,
}

impl WeightedRay {
    /// Linearises an image point; `None` if the point is not below the lens.
    ///
    /// # Model
    /// That of [`Ray`] with what the residual grids add at the measured point taken off:
    /// `v = x̄ - D(x̄) - G + f·(u1, u2)/u3`. D is that of the point as measured, not of one that
    /// the grids have corrected already: between them lies the slope of D times G, 120 nm for 4 %
    /// and 3 µm. G is held, and does not depend on the unknowns.
    #[must_use]
    pub fn new(
        network: &Network,
        layout: &Layout,
        state: &State,
        observed: &ImagePoint,
    ) -> Option<Self> {
        let pose = state.poses.get(observed.image)?;
        let point = state.point(observed.point);
        let interior = &state.parameters.interior;
        let setting = network.images.get(observed.image)?.stage.as_ref();
        let moved = setting.map(|setting| {
            let stage = &state.parameters.stage;
            stage.reduced(setting, observed.measured_mm)
        });
        let reduced_mm = moved.map_or(observed.measured_mm, |moved| moved.reduced_mm);
        let columns = network.additional(observed);
        let corrected_mm = columns.map_or(reduced_mm, |columns| {
            additional::corrected(reduced_mm, columns, &state.parameters.additional)
        });
        let ray = Ray::new(interior, pose, &point, corrected_mm)?;
        let weight = 1.0 / observed.sigma_mm;
        let mut by_camera = CameraJacobian::zeros();
        // An image point moves against the principal point.
        let [_, by_x0, by_y0, ..] = ray.by_interior;
        let by_stage = moved.map_or_else(Default::default, |moved| moved.by_element);
        let by_stage = by_stage.map(|motion| -(by_x0 * motion.x + by_y0 * motion.y));
        let by_additional = columns.copied().unwrap_or_default();
        let by_additional = by_additional.map(|[x, y]| by_x0 * x + by_y0 * y);
        let columns = ray.by_interior.iter().chain(&by_stage);
        let columns = columns.chain(&by_additional);
        for (index, (column, place)) in columns.zip(layout.camera).enumerate() {
            if place.is_some() {
                by_camera.set_column(index, &(weight * column));
            }
        }
        Some(Self {
            image: observed.image,
            residual: weight * (ray.residual_mm - Vector2::from(observed.by_grids_mm)),
            by_pose: weight * ray.by_pose,
            by_point: weight * ray.by_point,
            by_camera,
        })
    }

    /// Part of the images' diagonal block.
    #[must_use]
    pub fn pose_block(&self) -> Matrix6<f64> {
        self.by_pose.tr_mul(&self.by_pose)
    }
}

/// Residuals of the observed coordinates over σ, and one over σ; zero where not observed.
#[must_use]
pub fn coordinate_residuals(
    network: &Network,
    state: &State,
    number: usize,
) -> (Vector3<f64>, Vector3<f64>) {
    let Some(point) = network.points.get(number) else {
        return (Vector3::zeros(), Vector3::zeros());
    };
    let roots = Vector3::from(point.observed_sigmas().map(|sigma| {
        sigma.map_or(0.0, |sigma| {
            1.0 / if sigma > 0.0 { sigma } else { HELD_SIGMA_M }
        })
    }));
    let residuals = (point.given_m - state.point(number)).component_mul(&roots);
    (residuals, roots)
}

/// Normal equations of an object point: its own block, and what couples it.
#[derive(Debug, Clone, PartialEq)]
pub struct PointBlock {
    /// Linearised image points.
    pub rays: Vec<WeightedRay>,
    /// Inverse of the point's block V.
    pub inverse: Matrix3<f64>,
    /// Right-hand side of the point.
    pub right: Vector3<f64>,
    /// Coupling of the point with the camera.
    pub with_camera: SMatrix<f64, 3, CAMERA_UNKNOWNS>,
    /// Diagonal of V before damping.
    pub diagonal: Vector3<f64>,
    /// Sum of the squares of residuals over σ of the coordinates.
    pub coordinate_cost: f64,
}

impl PointBlock {
    /// Forms the block from the image points of an object point; `None` if a ray does not come down
    /// to it, or if the rays do not determine it.
    #[must_use]
    pub fn new(
        network: &Network,
        layout: &Layout,
        state: &State,
        observed: &[ImagePoint],
        damping: f64,
    ) -> Option<Self> {
        let number = observed.first()?.point;
        let rays = observed
            .iter()
            .filter(|observed| observed.accepted)
            .map(|observed| WeightedRay::new(network, layout, state, observed))
            .collect::<Option<Vec<_>>>()?;
        let (residuals, roots) = coordinate_residuals(network, state, number);
        let mut block = Matrix3::from_diagonal(&roots.component_mul(&roots));
        // The residual is given less adjusted: its derivative is -1.
        let mut right = residuals.component_mul(&roots);
        let mut with_camera = SMatrix::zeros();
        for ray in &rays {
            block += ray.by_point.tr_mul(&ray.by_point);
            right -= ray.by_point.tr_mul(&ray.residual);
            with_camera += ray.by_point.tr_mul(&ray.by_camera);
        }
        let diagonal = block.diagonal();
        let damped = block + damping * Matrix3::from_diagonal(&diagonal);
        Some(Self {
            rays,
            inverse: damped.cholesky()?.inverse(),
            right,
            with_camera,
            diagonal,
            coordinate_cost: residuals.norm_squared(),
        })
    }

    /// Coupling of an image with the point.
    #[must_use]
    pub fn with_image(ray: &WeightedRay) -> Matrix6x3<f64> {
        ray.by_pose.tr_mul(&ray.by_point)
    }

    /// Returns the point's step from those of the images and of the camera.
    #[must_use]
    pub fn step(
        &self,
        image_step: impl Fn(usize) -> Vector6<f64>,
        camera_step: &SVector<f64, CAMERA_UNKNOWNS>,
    ) -> Vector3<f64> {
        let mut right = self.right - self.with_camera * camera_step;
        for ray in &self.rays {
            right -= ray.by_point.tr_mul(&(ray.by_pose * image_step(ray.image)));
        }
        self.inverse * right
    }
}
