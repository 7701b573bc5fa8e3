//! Images and object points of an adjusted network with their σ.

use nalgebra::Matrix3;

use crate::calibration::result::network::{ImageStation, ObjectPoint, PointRole as ResultRole};
use crate::calibration::result::residual::TestedResidual;
use crate::linear::element::element;

use super::calibration::BundleCalibration;
use super::cofactors::Cofactors;
use super::eliminated_point::PointBlock;
use super::free_cofactors::{DatumTransformation, point_blocks};
use super::geometry;
use super::network::{ImagePoint, Network, PointRole};
use super::state::State;
use super::tested::OtherObservation;

impl BundleCalibration {
    /// Returns positions and attitudes with their σ.
    pub(super) fn stations(&self) -> Vec<ImageStation> {
        let (network, solution) = (&self.snooped.network, &self.snooped.solution);
        let cofactors = &self.snooped.cofactors;
        let transformation = DatumTransformation::new(network, solution, cofactors);
        let mut counts = vec![(0_usize, 0.0_f64); network.images.len()];
        let tests = network
            .image_points
            .iter()
            .zip(&self.snooped.tests.image_points);
        for (observed, [x, y]) in tests.filter(|(observed, _)| observed.accepted) {
            if let Some((count, squares)) = counts.get_mut(observed.image) {
                *count += 1;
                *squares += x.residual.powi(2) + y.residual.powi(2);
            }
        }
        network
            .images
            .iter()
            .zip(&solution.state.poses)
            .zip(counts)
            .enumerate()
            .map(|(number, ((image, pose), (points, squares)))| {
                let own = cofactors.images.as_ref().map(|images| {
                    let own = images.block(number, number);
                    transformation.as_ref().map_or(own, |transformation| {
                        transformation.image(solution, number, &own)
                    })
                });
                let root = |variance: f64| solution.sigma0() * variance.max(0.0).sqrt();
                let orientation = pose.orientation();
                let of_angles = own
                    .zip(pose.angles_by_rotation())
                    .map(|(own, by_rotation)| {
                        let rotation = own.fixed_view::<3, 3>(3, 3);
                        let [diagonal] = (by_rotation * rotation * by_rotation.transpose())
                            .diagonal()
                            .data
                            .0;
                        diagonal.map(|variance| root(variance).to_degrees())
                    });
                let count = f64::from(u32::try_from(2 * points).unwrap_or(u32::MAX)).max(1.0);
                ImageStation {
                    image: image.name.as_str().into(),
                    position_m: orientation.position_m,
                    position_sigma_m: own
                        .map(|own| [0, 1, 2].map(|axis| root(element(&own, axis, axis)))),
                    attitude_deg: orientation.attitude.map(f64::to_degrees),
                    attitude_sigma_deg: of_angles,
                    points,
                    residual_rms_mm: (squares / count).sqrt(),
                }
            })
            .collect()
    }

    /// Returns the object points with their σ.
    pub(super) fn object_points(&self) -> Vec<ObjectPoint> {
        let (network, solution) = (&self.snooped.network, &self.snooped.solution);
        let cofactors = &self.snooped.cofactors;
        let transformation = DatumTransformation::new(network, solution, cofactors);
        let blocks = point_blocks(network, solution);
        let observed = observed_by_point(network);
        let tests = control_tests(&self.snooped.tests.others, network.points.len());
        let mut points: Vec<ObjectPoint> = Vec::new();
        for (number, point) in network.points.iter().enumerate() {
            let images: Vec<usize> = observed
                .get(number)
                .copied()
                .unwrap_or(&[])
                .iter()
                .filter(|observed| observed.accepted)
                .map(|observed| observed.image)
                .collect();
            let position = solution.state.point(number);
            let own = self.point_cofactors(cofactors, number, blocks.get(number));
            let own = transformation.as_ref().map_or(own, |transformation| {
                if State::is_unknown(&solution.layout, number) {
                    transformation.point(&position, number, &own)
                } else {
                    own
                }
            });
            let sigma_m = [0, 1, 2]
                .map(|axis| solution.sigma0() * f64::max(element(&own, axis, axis), 0.0).sqrt());
            let given = (point.role != PointRole::Tie).then_some(point.given_m);
            let difference = position - point.given_m;
            points.push(ObjectPoint {
                point: point.name.as_str().into(),
                role: match point.role {
                    PointRole::Control => ResultRole::Control,
                    PointRole::Check => ResultRole::Check,
                    PointRole::Tie => ResultRole::New,
                },
                position_m: position.into(),
                sigma_m,
                given_m: given.map(Into::into),
                rays: images.len(),
                intersection_deg: geometry::intersection_deg(network, solution, &images, number),
                test_value: match point.role {
                    PointRole::Check => difference
                        .iter()
                        .zip(sigma_m)
                        .filter(|(_, sigma)| *sigma > 0.0)
                        .map(|(difference, sigma)| difference.abs() / sigma)
                        .reduce(f64::max),
                    _ => tests.get(number).copied().flatten(),
                },
            });
        }
        points
    }

    fn point_cofactors(
        &self,
        cofactors: &Cofactors,
        number: usize,
        block: Option<&Option<PointBlock>>,
    ) -> Matrix3<f64> {
        let block = block.and_then(Option::as_ref);
        cofactors
            .point(&self.snooped.solution.layout, number, block, &[])
            .map_or_else(Matrix3::zeros, |point| point.own)
    }
}

fn observed_by_point(network: &Network) -> Vec<&[ImagePoint]> {
    let mut by_point: Vec<&[ImagePoint]> = vec![&[]; network.points.len()];
    for observed in network.by_point() {
        if let Some(first) = observed.first()
            && let Some(place) = by_point.get_mut(first.point)
        {
            *place = observed;
        }
    }
    by_point
}

/// Returns the largest test value of each point's observed coordinates.
fn control_tests(others: &[(OtherObservation, TestedResidual)], points: usize) -> Vec<Option<f64>> {
    let mut tests = vec![None; points];
    for (observation, tested) in others {
        if let OtherObservation::Coordinate { point, .. } = observation
            && let Some(place) = tests.get_mut(*point)
        {
            *place = Some(tested.test_value.max(place.unwrap_or(0.0)));
        }
    }
    tests
}
