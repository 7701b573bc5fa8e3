//! Datum of a network: what its observations leave undetermined of position, attitude and scale,
//! and the inner constraints that take their place.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SymmetricEigen, Vector3, Vector6};

use super::layout::Layout;
use super::network::Network;
use super::parameters::Parameter;
use super::pose::Pose;
use super::state::State;
use crate::linear::element::{add, element};

/// Eigenvalue, of derivatives in units of the network's extent, below which a combination of
/// position, attitude and scale is not observed.
const LEAST_EIGENVALUE: f64 = 1e-9;

/// Parameters of a similarity transformation: shift in units of the extent, rotation vector, scale.
pub const SIMILARITY: usize = 7;

/// Datum of a network.
#[derive(Debug, Clone, PartialEq)]
pub struct Datum {
    /// Centre of the object points, m.
    pub centre_m: Vector3<f64>,
    /// Root mean square distance of the object points from it, m.
    pub extent_m: f64,
    /// Combinations of the parameters of a similarity transformation that no observation
    /// determines, one in each column.
    pub free: DMatrix<f64>,
    /// Names of shared unknowns that no observation tells from the datum.
    pub inseparable: Vec<Parameter>,
}

impl Datum {
    /// Finds what the observations of a network leave undetermined.
    #[must_use]
    pub fn of(network: &Network, layout: &Layout, state: &State) -> Self {
        let mut datum = Self::about(layout, state);
        let own: Vec<Parameter> = layout
            .border
            .iter()
            .copied()
            .filter(|parameter| {
                !matches!(
                    parameter,
                    Parameter::Interior(_)
                        | Parameter::Stage(_)
                        | Parameter::Additional(_)
                        | Parameter::Point { .. }
                )
            })
            .collect();
        let columns = SIMILARITY + own.len();
        let mut matrix = DMatrix::zeros(columns, columns);
        let mut observe = |row: &DVector<f64>| matrix += row * row.transpose();
        for (number, point) in network.points.iter().enumerate() {
            let by_similarity = datum.of_point(&state.point(number));
            let takes_part = layout.point(number) != super::layout::PointUnknowns::Unused;
            for (axis, sigma) in point.observed_sigmas().into_iter().enumerate() {
                if sigma.is_some() && takes_part {
                    let row = by_similarity.row(axis) / datum.extent_m;
                    observe(&padded(row.iter().copied(), columns));
                }
            }
        }
        for (image, pose) in network.images.iter().zip(&state.poses) {
            let Some(observed) = image.observed else {
                continue;
            };
            let Some(linear) = observed.residuals(pose, &state.parameters) else {
                continue;
            };
            let by_similarity = linear.by_pose * datum.of_pose(pose);
            for (row, sigma) in observed.sigmas.into_iter().enumerate() {
                if sigma.is_none() {
                    continue;
                }
                let scale = if row < 3 { datum.extent_m } else { 1.0 };
                let mut all = padded(by_similarity.row(row).iter().copied(), columns);
                for (parameter, column) in &linear.by_parameter {
                    if let Some(place) = own.iter().position(|other| other == parameter) {
                        add(
                            &mut all,
                            SIMILARITY + place,
                            0,
                            column.get(row).copied().unwrap_or(0.0),
                        );
                    }
                }
                observe(&(all / scale));
            }
        }
        if network.scale_bars.iter().any(|bar| layout.uses_bar(bar)) {
            observe(&padded(
                [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].into_iter(),
                columns,
            ));
        }
        for prior in &network.priors {
            if let Some(place) = own.iter().position(|other| *other == prior.parameter) {
                let mut row = DVector::zeros(columns);
                add(&mut row, SIMILARITY + place, 0, 1.0);
                observe(&row);
            }
        }
        datum.take_null_space(&matrix, &own);
        datum
    }

    fn about(layout: &Layout, state: &State) -> Self {
        let used: Vec<Vector3<f64>> = state
            .points_m
            .iter()
            .enumerate()
            .filter(|(number, _)| layout.point(*number) != super::layout::PointUnknowns::Unused)
            .map(|(_, point)| *point)
            .collect();
        let count = f64::from(u32::try_from(used.len()).unwrap_or(u32::MAX)).max(1.0);
        let centre_m = used.iter().sum::<Vector3<f64>>() / count;
        let squares: f64 = used
            .iter()
            .map(|point| (point - centre_m).norm_squared())
            .sum();
        Self {
            centre_m,
            extent_m: (squares / count).sqrt().max(f64::MIN_POSITIVE),
            free: DMatrix::zeros(SIMILARITY, 0),
            inseparable: Vec::new(),
        }
    }

    fn take_null_space(&mut self, matrix: &DMatrix<f64>, own: &[Parameter]) {
        // Columns of the shared unknowns to unit length; a column of zeros stays one.
        let lengths = matrix
            .diagonal()
            .map(|element| if element > 0.0 { element.sqrt() } else { 1.0 });
        let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |row, column| {
            let scale = |index: usize| {
                if index < SIMILARITY {
                    1.0
                } else {
                    element(&lengths, index, 0)
                }
            };
            element(matrix, row, column) / (scale(row) * scale(column))
        });
        let largest = scaled.amax().max(f64::MIN_POSITIVE);
        let eigen = SymmetricEigen::new(scaled);
        let mut free = Vec::new();
        for (value, vector) in eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
        {
            if *value > LEAST_EIGENVALUE * largest {
                continue;
            }
            for (parameter, share) in own.iter().zip(vector.iter().skip(SIMILARITY)) {
                if share.abs() > 0.1 && !self.inseparable.contains(parameter) {
                    self.inseparable.push(*parameter);
                }
            }
            free.push(vector.rows(0, SIMILARITY).into_owned());
        }
        if !free.is_empty() {
            self.free = DMatrix::from_columns(&free);
        }
    }

    /// Number of combinations that no observation determines.
    #[must_use]
    pub fn defects(&self) -> usize {
        self.free.ncols()
    }

    /// Derivatives of an object point by the parameters of the similarity transformation, m.
    #[must_use]
    pub fn of_point(&self, point_m: &Vector3<f64>) -> SMatrix<f64, 3, SIMILARITY> {
        let from_centre = point_m - self.centre_m;
        let mut derivatives = SMatrix::<f64, 3, SIMILARITY>::zeros();
        derivatives
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&(self.extent_m * Matrix3::identity()));
        derivatives
            .fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&-from_centre.cross_matrix());
        derivatives.set_column(6, &from_centre);
        derivatives
    }

    /// Derivatives of a pose by the parameters of the similarity transformation, m and rad.
    #[must_use]
    pub fn of_pose(&self, pose: &Pose) -> SMatrix<f64, 6, SIMILARITY> {
        let mut derivatives = SMatrix::<f64, 6, SIMILARITY>::zeros();
        derivatives
            .fixed_view_mut::<3, SIMILARITY>(0, 0)
            .copy_from(&self.of_point(&pose.position_m));
        derivatives
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&Matrix3::identity());
        derivatives
    }

    /// Chooses elements of images, one for each defect, that hold the datum during the iterations:
    /// those that determine the free combinations best, in units of their own σ.
    #[must_use]
    pub fn held_elements(&self, state: &State, diagonal: &DVector<f64>) -> Vec<usize> {
        let mut rows: Vec<(usize, DVector<f64>)> = Vec::new();
        for (image, pose) in state.poses.iter().enumerate() {
            let by_free = self.of_pose(pose) * &self.free;
            for row in 0..6 {
                let element = 6 * image + row;
                let weight = diagonal.get(element).copied().unwrap_or(0.0).sqrt();
                rows.push((element, by_free.row(row).transpose() * weight));
            }
        }
        let mut held = Vec::new();
        for _ in 0..self.defects() {
            let Some((element, pivot)) = rows
                .iter()
                .max_by(|(_, a), (_, b)| a.norm_squared().total_cmp(&b.norm_squared()))
                .cloned()
            else {
                break;
            };
            let square = pivot.norm_squared();
            if square <= 0.0 {
                break;
            }
            for (_, row) in &mut rows {
                let share = row.dot(&pivot) / square;
                row.axpy(-share, &pivot, 1.0);
            }
            held.push(element);
        }
        held
    }

    /// Transforms a state so that the corrections of all unknown object points since `initial` meet
    /// the inner constraints: no part of them lies in the free combinations.
    ///
    /// # Model
    /// `Gᵀ(X - X_initial) = 0` over all object points, G their derivatives by the free
    /// combinations.
    #[must_use]
    pub fn aligned(&self, layout: &Layout, state: &State, initial: &State) -> Option<State> {
        let defects = self.defects();
        let mut aligned = state.clone();
        if defects == 0 {
            return Some(aligned);
        }
        for _ in 0..5 {
            let mut matrix = DMatrix::zeros(defects, defects);
            let mut right = DVector::zeros(defects);
            let points = aligned.points_m.iter().zip(&initial.points_m).enumerate();
            for (_, (point, before)) in
                points.filter(|(number, _)| State::is_unknown(layout, *number))
            {
                let by_free = self.of_point(point) * &self.free;
                matrix += by_free.tr_mul(&by_free);
                right += by_free.tr_mul(&(before - point));
            }
            let parameters = &self.free * matrix.cholesky()?.solve(&right);
            self.transform(&mut aligned, &parameters);
        }
        Some(aligned)
    }

    fn transform(&self, state: &mut State, parameters: &DVector<f64>) {
        let part = |first: usize| Vector3::from_fn(|row, _| parameters[first + row]);
        let shift = self.extent_m * part(0);
        let turn = nalgebra::Rotation3::from_scaled_axis(part(3));
        let scale = 1.0 + parameters[6];
        let moved =
            |point: &Vector3<f64>| self.centre_m + shift + scale * (turn * (point - self.centre_m));
        for point in &mut state.points_m {
            *point = moved(point);
        }
        for pose in &mut state.poses {
            pose.position_m = moved(&pose.position_m);
            let step = Vector6::new(0.0, 0.0, 0.0, parameters[3], parameters[4], parameters[5]);
            *pose = pose.moved(&step);
        }
    }
}

fn padded(values: impl Iterator<Item = f64>, length: usize) -> DVector<f64> {
    let mut row = DVector::zeros(length);
    for (element, value) in row.iter_mut().zip(values) {
        *element = value;
    }
    row
}
