//! Residuals of an adjusted network with redundancy numbers and test values.

use nalgebra::{DVector, RowVector3, RowVector6, Vector3};

use crate::calibration::result::residual::TestedResidual;
use crate::linear::element::{add, element};

use super::cofactors::{Cofactors, PointCofactors};
use super::eliminated_point::{PointBlock, WeightedRay};
use super::image::ObservedPose;
use super::layout::{Layout, PointUnknowns};
use super::network::{ImagePoint, Network};
use super::pose::Pose;
use super::solution::Solution;

/// An observation that is no image point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OtherObservation {
    /// Coordinate of a control point.
    Coordinate {
        /// Number of the point.
        point: usize,
        /// Axis of the ground frame.
        axis: usize,
    },
    /// Position or attitude observed on board.
    Pose {
        /// Number of the image.
        image: usize,
        /// Element: position, then pitch, roll and yaw.
        element: usize,
    },
    /// Length of a scale bar.
    ScaleBar(usize),
    /// Observed value of a shared unknown.
    Prior(usize),
}

/// Tests of all observations.
#[derive(Debug, Clone, PartialEq)]
pub struct Tests {
    /// Components of the image points, mm, in the order of the network; a rejected one is tested
    /// against its prediction, a point that does not take part has a test value of 0.
    pub image_points: Vec<[TestedResidual; 2]>,
    /// All others, in their own units.
    pub others: Vec<(OtherObservation, TestedResidual)>,
    /// `false` where there were too many images: all then have the mean redundancy number.
    pub exact: bool,
}

impl Tests {
    /// Computes residuals, redundancy numbers `r = 1 - aᵀQa·p` and Pope's test values.
    #[must_use]
    pub fn of(network: &Network, solution: &Solution, cofactors: &Cofactors) -> Self {
        let tester = Tester {
            network,
            solution,
            cofactors,
            sigma0: solution.sigma0(),
            mean: mean_redundancy(solution),
        };
        let mut image_points = Vec::with_capacity(network.image_points.len());
        let mut others = Vec::new();
        for observed in network.by_point() {
            tester.object_point(observed, &mut image_points, &mut others);
        }
        tester.poses(&mut others);
        tester.scale_bars(&mut others);
        tester.priors(&mut others);
        Self {
            image_points,
            others,
            exact: cofactors.images.is_some(),
        }
    }

    /// Tests the observed positions along a direction of the sensor frame, image by image; images
    /// without three observed coordinates are left out.
    ///
    /// # Model
    /// The component `tᵀv` of the residual v along `t = R·e` has the cofactor `tᵀQ_v·t`: a wrong
    /// principal point of one exposure moves the projection centre along t.
    #[must_use]
    pub fn along(
        network: &Network,
        solution: &Solution,
        cofactors: &Cofactors,
        [x, y]: [f64; 2],
    ) -> Vec<(usize, TestedResidual)> {
        let tester = Tester {
            network,
            solution,
            cofactors,
            sigma0: solution.sigma0(),
            mean: mean_redundancy(solution),
        };
        let poses = network.images.iter().zip(&solution.state.poses);
        poses
            .enumerate()
            .filter_map(|(number, (image, pose))| {
                let direction = pose.rotation * Vector3::new(x, y, 0.0);
                let tested = tester.position(number, image.observed?, pose, &direction)?;
                Some((number, tested))
            })
            .collect()
    }
}

fn mean_redundancy(solution: &Solution) -> f64 {
    let count = |number: usize| f64::from(u32::try_from(number).unwrap_or(u32::MAX));
    count(solution.redundancy()) / count(solution.observations).max(1.0)
}

struct Tester<'a> {
    network: &'a Network,
    solution: &'a Solution,
    cofactors: &'a Cofactors,
    sigma0: f64,
    mean: f64,
}

/// Derivatives of one observation over σ.
struct Row {
    image: Option<(usize, RowVector6<f64>)>,
    border: DVector<f64>,
}

impl Tester<'_> {
    fn layout(&self) -> &Layout {
        &self.solution.layout
    }

    /// Tests the image points of an object point, and its coordinates.
    fn object_point(
        &self,
        observed: &[ImagePoint],
        image_points: &mut Vec<[TestedResidual; 2]>,
        others: &mut Vec<(OtherObservation, TestedResidual)>,
    ) {
        let Some(&ImagePoint { point, .. }) = observed.first() else {
            return;
        };
        let (network, state) = (self.network, &self.solution.state);
        let unknowns = self.layout().point(point);
        let block = (unknowns == PointUnknowns::Eliminated)
            .then(|| PointBlock::new(network, self.layout(), state, observed, 0.0))
            .flatten();
        let wanted: Vec<usize> = observed.iter().map(|observed| observed.image).collect();
        let own = self
            .cofactors
            .point(self.layout(), point, block.as_ref(), &wanted);
        for (place, observed) in observed.iter().enumerate() {
            let ray = WeightedRay::new(network, self.layout(), state, observed);
            let tested = match ray {
                Some(ray) if unknowns != PointUnknowns::Unused => {
                    self.ray(&ray, observed, own.as_ref(), place)
                }
                _ => [TestedResidual::default(); 2],
            };
            image_points.push(tested);
        }
        let Some(given) = network.points.get(point) else {
            return;
        };
        if !super::state::State::is_unknown(self.layout(), point) {
            return;
        }
        let difference = given.given_m - state.point(point);
        for (axis, sigma) in given.observed_sigmas().into_iter().enumerate() {
            let Some(sigma) = sigma.filter(|sigma| *sigma > 0.0) else {
                continue;
            };
            let leverage = own.as_ref().map_or(1.0 - self.mean, |own| {
                element(&own.own, axis, axis) / (sigma * sigma)
            });
            let tested = TestedResidual::new(
                element(&difference, axis, 0),
                sigma,
                bounded(1.0 - leverage),
                self.sigma0,
            );
            others.push((OtherObservation::Coordinate { point, axis }, tested));
        }
    }

    fn ray(
        &self,
        ray: &WeightedRay,
        observed: &ImagePoint,
        own: Option<&PointCofactors>,
        place: usize,
    ) -> [TestedResidual; 2] {
        [0, 1].map(|component| {
            let mut border = DVector::zeros(self.layout().border.len());
            for (index, column) in self.layout().camera.iter().enumerate() {
                if let Some(column) = column {
                    add(
                        &mut border,
                        *column,
                        0,
                        element(&ray.by_camera, component, index),
                    );
                }
            }
            let row = Row {
                image: Some((ray.image, ray.by_pose.row(component).into_owned())),
                border,
            };
            let by_point = ray.by_point.row(component).into_owned();
            let leverage = self.leverage(&row, own.map(|own| (own, &by_point, place)));
            let redundancy = if observed.accepted {
                bounded(1.0 - leverage)
            } else {
                1.0 + leverage
            };
            let residual = element(&ray.residual, component, 0) * observed.sigma_mm;
            let tested = TestedResidual::new(residual, observed.sigma_mm, redundancy, self.sigma0);
            TestedResidual {
                redundancy: if observed.accepted { redundancy } else { 0.0 },
                ..tested
            }
        })
    }

    /// Returns aᵀQa of an observation over σ.
    fn leverage(
        &self,
        row: &Row,
        point: Option<(&PointCofactors, &RowVector3<f64>, usize)>,
    ) -> f64 {
        let Some(images) = &self.cofactors.images else {
            return 1.0 - self.mean;
        };
        let mut sum = row.border.dot(&(&self.cofactors.border * &row.border));
        if let Some((image, own)) = &row.image {
            sum += (own * images.block(*image, *image) * own.transpose()).to_scalar();
            let with_border = images.with_border.columns(6 * image, 6) * own.transpose();
            sum += 2.0 * row.border.dot(&with_border);
        }
        if let Some((point, by_point, place)) = point {
            sum += (by_point * point.own * by_point.transpose()).to_scalar();
            sum += 2.0 * row.border.dot(&(&point.with_border * by_point.transpose()));
            if let (Some((_, own)), Some(with_image)) = (&row.image, point.with_images.get(place)) {
                sum += 2.0 * (own * with_image * by_point.transpose()).to_scalar();
            }
        }
        sum
    }

    fn poses(&self, others: &mut Vec<(OtherObservation, TestedResidual)>) {
        let state = &self.solution.state;
        for (number, (image, pose)) in self.network.images.iter().zip(&state.poses).enumerate() {
            let Some(observed) = image.observed else {
                continue;
            };
            let Some(linear) = observed.residuals(pose, &state.parameters) else {
                continue;
            };
            let elements = linear
                .residuals
                .into_iter()
                .zip(observed.sigmas)
                .enumerate();
            for (element, (residual, sigma)) in elements {
                let Some(sigma) = sigma else { continue };
                let mut border = DVector::zeros(self.layout().border.len());
                for (parameter, column) in &linear.by_parameter {
                    if let (Some(place), Some(value)) =
                        (self.layout().column(*parameter), column.get(element))
                    {
                        add(&mut border, place, 0, value / sigma);
                    }
                }
                let own = linear.by_pose.row(element).into_owned() / sigma;
                let row = Row {
                    image: Some((number, own)),
                    border,
                };
                let redundancy = bounded(1.0 - self.leverage(&row, None));
                others.push((
                    OtherObservation::Pose {
                        image: number,
                        element,
                    },
                    TestedResidual::new(residual, sigma, redundancy, self.sigma0),
                ));
            }
        }
    }

    /// Tests the component of an observed position along a direction of the ground frame.
    fn position(
        &self,
        image: usize,
        observed: ObservedPose,
        pose: &Pose,
        direction: &Vector3<f64>,
    ) -> Option<TestedResidual> {
        let linear = observed.residuals(pose, &self.solution.state.parameters)?;
        let [x, y, z, ..] = observed.sigmas;
        let sigma = direction.component_mul(&Vector3::new(x?, y?, z?)).norm();
        let share = direction / sigma;
        let mut border = DVector::zeros(self.layout().border.len());
        for (parameter, [x, y, z, ..]) in &linear.by_parameter {
            if let Some(place) = self.layout().column(*parameter) {
                add(&mut border, place, 0, share.dot(&Vector3::new(*x, *y, *z)));
            }
        }
        let own = share.transpose() * linear.by_pose.fixed_rows::<3>(0);
        let row = Row {
            image: Some((image, own)),
            border,
        };
        let [x, y, z, ..] = linear.residuals;
        Some(TestedResidual::new(
            direction.dot(&Vector3::new(x, y, z)),
            sigma,
            bounded(1.0 - self.leverage(&row, None)),
            self.sigma0,
        ))
    }

    fn scale_bars(&self, others: &mut Vec<(OtherObservation, TestedResidual)>) {
        let state = &self.solution.state;
        for (number, bar) in self.network.scale_bars.iter().enumerate() {
            if !self.layout().uses_bar(bar) {
                continue;
            }
            let [a, b] = bar.ends;
            let difference = state.point(b) - state.point(a);
            let length = difference.norm();
            let mut border = DVector::zeros(self.layout().border.len());
            for (end, sign) in [(a, 1.0), (b, -1.0)] {
                if let PointUnknowns::Border(first) = self.layout().point(end) {
                    let part = difference * (sign / (length * bar.sigma_m));
                    border.rows_mut(first, 3).copy_from(&part);
                }
            }
            let leverage = border.dot(&(&self.cofactors.border * &border));
            others.push((
                OtherObservation::ScaleBar(number),
                TestedResidual::new(
                    bar.length_m - length,
                    bar.sigma_m,
                    bounded(1.0 - leverage),
                    self.sigma0,
                ),
            ));
        }
    }

    fn priors(&self, others: &mut Vec<(OtherObservation, TestedResidual)>) {
        for (number, prior) in self.network.priors.iter().enumerate() {
            let Some(place) = self.layout().column(prior.parameter) else {
                continue;
            };
            let value = self.solution.state.parameters.value(prior.parameter);
            let leverage = element(&self.cofactors.border, place, place) / prior.sigma.powi(2);
            others.push((
                OtherObservation::Prior(number),
                TestedResidual::new(
                    prior.value - value,
                    prior.sigma,
                    bounded(1.0 - leverage),
                    self.sigma0,
                ),
            ));
        }
    }
}

/// Redundancy numbers lie between 0 and 1 but for rounding.
fn bounded(redundancy: f64) -> f64 {
    redundancy.clamp(0.0, 1.0)
}
