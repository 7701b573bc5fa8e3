//! Normal equations of a network, its object points eliminated.

use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector6};

use crate::linear::bordered_factor::{BorderedFactor, Singular};
use crate::linear::bordered_matrix::BorderedMatrix;
use crate::linear::element::{add, element};

use super::eliminated_point::{PointBlock, WeightedRay, coordinate_residuals};
use super::layout::{CAMERA_UNKNOWNS, Layout, PointUnknowns};
use super::network::{ImagePoint, Network, ScaleBar};
use super::state::{State, Step};

/// Normal equations `N·step = right` with the points eliminated.
#[derive(Debug, Clone)]
pub struct Normals {
    /// Reduced matrix.
    pub matrix: BorderedMatrix,
    /// Reduced right-hand side of the images.
    pub right: DMatrix<f64>,
    /// Reduced right-hand side of the border.
    pub border_right: DMatrix<f64>,
    /// Diagonal before the elimination, images first.
    pub diagonal: DVector<f64>,
    /// vᵀPv.
    pub cost: f64,
    damping: f64,
}

impl Normals {
    /// Forms the normal equations at the given values; `damping` multiplies the diagonal.
    ///
    /// # Errors
    /// [`Singular`] if a point is not below a lens that shows it, or is not determined.
    pub fn new(
        network: &Network,
        layout: &Layout,
        state: &State,
        damping: f64,
    ) -> Result<Self, Singular> {
        let images = network.images.len();
        let border = layout.border.len();
        let mut normals = Self {
            matrix: BorderedMatrix::zeros(layout.pairs().clone(), border),
            right: DMatrix::zeros(6 * images, 1),
            border_right: DMatrix::zeros(border, 1),
            diagonal: DVector::zeros(6 * images + border),
            cost: 0.0,
            damping,
        };
        for observed in network.by_point() {
            let point = observed.first().map_or(0, |ray| ray.point);
            match layout.point(point) {
                PointUnknowns::Unused => {}
                PointUnknowns::Eliminated => {
                    let block = PointBlock::new(network, layout, state, observed, damping)
                        .ok_or(Singular)?;
                    normals.add_eliminated(layout, &block);
                }
                PointUnknowns::Held => normals.add_rays(network, layout, state, observed, None)?,
                PointUnknowns::Border(first) => {
                    normals.add_rays(network, layout, state, observed, Some(first))?;
                    normals.add_coordinates(network, state, point, first);
                }
            }
        }
        normals.add_poses(network, layout, state)?;
        let bars = network.scale_bars.iter();
        for bar in bars.filter(|bar| layout.uses_bar(bar)) {
            normals.add_scale_bar(layout, state, bar);
        }
        for prior in &network.priors {
            if let Some(column) = layout.column(prior.parameter) {
                let residual = prior.value - state.parameters.value(prior.parameter);
                let columns = [(column, -1.0 / prior.sigma)];
                normals.add_border_row(&columns, residual / prior.sigma);
            }
        }
        for (index, element) in normals.diagonal.iter().enumerate() {
            let weight = damping * element;
            if index < 6 * images {
                normals.matrix.add_to_diagonal(index / 6, index % 6, weight);
            } else {
                add(
                    &mut normals.matrix.corner,
                    index - 6 * images,
                    index - 6 * images,
                    weight,
                );
            }
        }
        Ok(normals)
    }

    /// Adds the weight of its own observations to elements of the images, which then hold the
    /// datum.
    pub fn hold(&mut self, elements: &[usize]) {
        for &element in elements {
            let weight = self.diagonal.get(element).copied().unwrap_or(0.0);
            self.matrix
                .add_to_diagonal(element / 6, element % 6, weight);
        }
    }

    /// Factors the reduced matrix.
    ///
    /// # Errors
    /// [`Singular`] if the observations do not determine the unknowns.
    pub fn factor(&self, layout: &Layout) -> Result<BorderedFactor, Singular> {
        BorderedFactor::new(&self.matrix, layout.order(), 0.0)
    }

    /// Solves for the steps of all unknowns.
    ///
    /// # Errors
    /// [`Singular`] as for [`Self::factor`].
    pub fn solve(
        &self,
        network: &Network,
        layout: &Layout,
        state: &State,
    ) -> Result<Step, Singular> {
        let factor = self.factor(layout)?;
        let mut images = self.right.clone();
        let mut border = self.border_right.clone();
        factor.solve(&mut images, &mut border);
        let mut fall = images.dot(&self.right) + border.dot(&self.border_right);
        let camera = camera_part(layout, &border);
        let own = |image: usize| Vector6::from_fn(|row, _| element(&images, 6 * image + row, 0));
        let mut points = vec![nalgebra::Vector3::zeros(); network.points.len()];
        for observed in network.by_point() {
            let number = observed.first().map_or(0, |ray| ray.point);
            if layout.point(number) == PointUnknowns::Eliminated {
                let block = PointBlock::new(network, layout, state, observed, self.damping)
                    .ok_or(Singular)?;
                fall += block.right.dot(&(block.inverse * block.right));
                if let Some(step) = points.get_mut(number) {
                    *step = block.step(own, &camera);
                }
            }
        }
        Ok(Step {
            images,
            border,
            points,
            fall,
        })
    }

    fn add_eliminated(&mut self, layout: &Layout, block: &PointBlock) {
        let couplings: Vec<_> = block.rays.iter().map(PointBlock::with_image).collect();
        let reduced: Vec<_> = couplings.iter().map(|w| w * block.inverse).collect();
        let mut own_camera = SMatrix::<f64, CAMERA_UNKNOWNS, CAMERA_UNKNOWNS>::zeros();
        let mut camera_right = SVector::<f64, CAMERA_UNKNOWNS>::zeros();
        for (place, (ray, reduced_own)) in block.rays.iter().zip(&reduced).enumerate() {
            let own = ray.pose_block();
            self.add_diagonal(ray, &own);
            self.matrix.add_block(ray.image, ray.image, &own);
            // Image points are in ascending order of image: lower triangle.
            for (other, coupling) in block.rays.iter().zip(&couplings).take(place + 1) {
                let product = -(reduced_own * coupling.transpose());
                self.matrix.add_block(ray.image, other.image, &product);
            }
            // Most columns belong to unknowns that are not estimated.
            for (index, border) in layout.camera_columns() {
                let column = ray.by_camera.column(index);
                let with_camera =
                    ray.by_pose.tr_mul(&column) - reduced_own * block.with_camera.column(index);
                self.add_camera_border(ray.image, border, &with_camera);
                for (other, _) in layout.camera_columns() {
                    let product = column.dot(&ray.by_camera.column(other));
                    add(&mut own_camera, index, other, product);
                }
            }
            let right = -ray.by_pose.tr_mul(&ray.residual) - reduced_own * block.right;
            self.add_right(ray.image, &right);
            camera_right -= ray.by_camera.tr_mul(&ray.residual);
            self.cost += ray.residual.norm_squared();
        }
        self.cost += block.coordinate_cost;
        self.add_camera_diagonal(layout, &own_camera.diagonal());
        let projected = block.inverse * block.with_camera;
        camera_right -= projected.tr_mul(&block.right);
        for (row, place) in layout.camera_columns() {
            let right = element(&camera_right, row, 0);
            add(&mut self.border_right, place, 0, right);
            let by_point = block.with_camera.column(row);
            for (column, other) in layout.camera_columns() {
                let reduction = by_point.dot(&projected.column(column));
                let sum = element(&own_camera, row, column) - reduction;
                add(&mut self.matrix.corner, place, other, sum);
            }
        }
    }

    fn add_diagonal(&mut self, ray: &WeightedRay, own: &nalgebra::Matrix6<f64>) {
        for row in 0..6 {
            add(
                &mut self.diagonal,
                6 * ray.image + row,
                0,
                element(own, row, row),
            );
        }
    }

    fn add_camera_diagonal(&mut self, layout: &Layout, diagonal: &SVector<f64, CAMERA_UNKNOWNS>) {
        let images = self.right.nrows();
        for (element, place) in diagonal.iter().zip(layout.camera) {
            if let Some(place) = place {
                add(&mut self.diagonal, images + place, 0, *element);
            }
        }
    }

    fn add_right(&mut self, image: usize, right: &Vector6<f64>) {
        for (row, element) in right.iter().enumerate() {
            add(&mut self.right, 6 * image + row, 0, *element);
        }
    }

    fn add_camera_border(&mut self, image: usize, place: usize, column: &Vector6<f64>) {
        for (row, element) in column.iter().enumerate() {
            add(&mut self.matrix.border, 6 * image + row, place, *element);
        }
    }

    /// Adds the image points of an object point that is held, or whose coordinates are unknowns of
    /// the border from column `first` on.
    fn add_rays(
        &mut self,
        network: &Network,
        layout: &Layout,
        state: &State,
        observed: &[ImagePoint],
        first: Option<usize>,
    ) -> Result<(), Singular> {
        for observed in observed.iter().filter(|observed| observed.accepted) {
            let ray = WeightedRay::new(network, layout, state, observed).ok_or(Singular)?;
            let camera = layout.camera.iter().enumerate();
            let mut columns: Vec<(usize, [f64; 2])> = camera
                .filter_map(|(index, place)| {
                    let column = ray.by_camera.column(index);
                    place.map(|place| (place, [column.x, column.y]))
                })
                .collect();
            if let Some(first) = first {
                let coordinates = ray.by_point.column_iter().enumerate();
                columns
                    .extend(coordinates.map(|(axis, column)| (first + axis, [column.x, column.y])));
            }
            for row in 0..2 {
                let own = Vector6::from_fn(|place, _| element(&ray.by_pose, row, place));
                let columns: Vec<(usize, f64)> = columns
                    .iter()
                    .map(|(place, [x, y])| (*place, if row == 0 { *x } else { *y }))
                    .collect();
                self.add_row(ray.image, &own, &columns, element(&ray.residual, row, 0));
            }
        }
        Ok(())
    }

    fn add_coordinates(&mut self, network: &Network, state: &State, point: usize, first: usize) {
        let (residuals, roots) = coordinate_residuals(network, state, point);
        for (axis, (residual, root)) in residuals.iter().zip(roots.iter()).enumerate() {
            self.add_border_row(&[(first + axis, -root)], *residual);
        }
    }

    fn add_poses(
        &mut self,
        network: &Network,
        layout: &Layout,
        state: &State,
    ) -> Result<(), Singular> {
        for (number, (image, pose)) in network.images.iter().zip(&state.poses).enumerate() {
            let Some(observed) = image.observed else {
                continue;
            };
            let linear = observed
                .residuals(pose, &state.parameters)
                .ok_or(Singular)?;
            let elements = linear
                .residuals
                .into_iter()
                .zip(observed.sigmas)
                .enumerate();
            for (row, (residual, sigma)) in elements {
                let Some(sigma) = sigma else { continue };
                let own = linear.by_pose.row(row).transpose() / sigma;
                let columns: Vec<(usize, f64)> = linear
                    .by_parameter
                    .iter()
                    .filter_map(|(parameter, column)| {
                        let place = layout.column(*parameter)?;
                        Some((place, column.get(row)? / sigma))
                    })
                    .collect();
                self.add_row(number, &own, &columns, residual / sigma);
            }
        }
        Ok(())
    }

    fn add_scale_bar(&mut self, layout: &Layout, state: &State, bar: &ScaleBar) {
        let [a, b] = bar.ends;
        let difference = state.point(b) - state.point(a);
        let length = difference.norm();
        let direction = difference / length;
        let mut columns = Vec::new();
        for (end, sign) in [(a, 1.0), (b, -1.0)] {
            if let PointUnknowns::Border(first) = layout.point(end) {
                let parts = direction.iter().enumerate();
                columns.extend(parts.map(|(axis, part)| (first + axis, sign * part / bar.sigma_m)));
            }
        }
        self.add_border_row(&columns, (bar.length_m - length) / bar.sigma_m);
    }

    /// Adds one observation of an image and of the border, its derivatives and residual over σ.
    fn add_row(
        &mut self,
        image: usize,
        own: &Vector6<f64>,
        columns: &[(usize, f64)],
        residual: f64,
    ) {
        let block = own * own.transpose();
        self.matrix.add_block(image, image, &block);
        self.add_right(image, &(-residual * own));
        for row in 0..6 {
            add(
                &mut self.diagonal,
                6 * image + row,
                0,
                element(&block, row, row),
            );
            for (place, value) in columns {
                add(
                    &mut self.matrix.border,
                    6 * image + row,
                    *place,
                    element(own, row, 0) * value,
                );
            }
        }
        self.add_border_row(columns, residual);
    }

    fn add_border_row(&mut self, columns: &[(usize, f64)], residual: f64) {
        let images = self.right.nrows();
        for (place, value) in columns {
            for (other, factor) in columns {
                add(&mut self.matrix.corner, *place, *other, value * factor);
            }
            add(&mut self.border_right, *place, 0, -(value * residual));
            add(&mut self.diagonal, images + place, 0, value * value);
        }
        self.cost += residual * residual;
    }
}

/// Returns the steps of the camera out of those of the border.
#[must_use]
pub fn camera_part(layout: &Layout, border: &DMatrix<f64>) -> SVector<f64, CAMERA_UNKNOWNS> {
    let mut part = SVector::<f64, CAMERA_UNKNOWNS>::zeros();
    for (step, place) in part.iter_mut().zip(layout.camera) {
        *step = place.map_or(0.0, |place| element(border, place, 0));
    }
    part
}
