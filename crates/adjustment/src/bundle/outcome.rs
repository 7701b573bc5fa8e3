//! Result of a calibration by a network, in the form that all methods share.

use std::sync::Arc;

use fmc_camera_file::CameraFile;
use fmc_camera_file::static_block::StaticCalibration;
use nalgebra::DMatrix;

use crate::calibration::result::parameter_estimate::ParameterEstimate;
use crate::calibration::result::residual::{ImageResidual, ObservationGroup, ObservationResidual};
use crate::calibration::result::{CalibrationResult, InputFile};
use crate::linear::element::element;

use super::calibration::BundleCalibration;
use super::interior::{Interior, InteriorElement};
use super::network::{Network, PointRole};
use super::parameters::Parameter;
use super::solution::DatumChoice;
use super::tested::OtherObservation;
use super::warnings;

/// Names of the components of a position and attitude.
const POSE_COMPONENTS: [&str; 6] = ["x_m", "y_m", "z_m", "pitch_rad", "roll_rad", "yaw_rad"];

/// Names of the components of a point.
const POINT_COMPONENTS: [&str; 3] = ["x_m", "y_m", "z_m"];

impl BundleCalibration {
    /// Returns the result, with the camera file from which the calibration started and the files of
    /// observations; `method` as the command spells it.
    #[must_use]
    pub fn result(
        &self,
        method: &'static str,
        camera: &CameraFile,
        inputs: Vec<InputFile>,
    ) -> CalibrationResult {
        let (snooped, solution) = (&self.snooped, &self.snooped.solution);
        let (parameters, cofactors) = self.parameters();
        let image_residuals = self.image_residuals();
        let other_residuals = self.other_residuals();
        let mut result = CalibrationResult {
            method,
            camera: camera.clone(),
            calibrated: calibrated(camera, &solution.state.parameters.interior),
            inputs,
            parameters,
            cofactors,
            sigma0: solution.sigma0(),
            has_sigma: self.has_sigma,
            groups: groups(&image_residuals, &other_residuals),
            datum: self.datum_in_words(),
            observations: solution.observations,
            unknowns: solution.unknowns + solution.datum.defects(),
            constraints: solution.datum.defects(),
            iterations: self.unrejected.iterations,
            critical_value: Some(snooped.critical),
            warnings: Vec::new(),
            notes: self.notes(),
            image_residuals,
            other_residuals,
            images: self.stations(),
            points: self.object_points(),
        };
        result.warnings = warnings::of(self, &result);
        result
    }

    fn network(&self) -> &Network {
        &self.snooped.network
    }

    /// Returns the parameters, and the cofactors of those estimated.
    fn parameters(&self) -> (Vec<ParameterEstimate>, DMatrix<f64>) {
        let solution = &self.snooped.solution;
        let (start, layout) = (&self.network().parameters, &solution.layout);
        let values = &solution.state.parameters;
        let mut parameters = Vec::new();
        let prior = |parameter: Parameter| {
            let mut priors = self.network().priors.iter();
            let found = priors.find(|prior| prior.parameter == parameter);
            found.map(|prior| prior.sigma)
        };
        let mut columns = Vec::new();
        for element in InteriorElement::ALL {
            let parameter = Parameter::Interior(element);
            let value = values.value(parameter);
            parameters.push(if let Some(column) = layout.column(parameter) {
                columns.push(column);
                ParameterEstimate::estimated(element.name(), Some(start.value(parameter)), value)
                    .with_prior(prior(parameter))
            } else {
                ParameterEstimate::held(element.name(), value)
            });
        }
        for (column, parameter) in layout.border.iter().enumerate() {
            if matches!(parameter, Parameter::Interior(_) | Parameter::Point { .. }) {
                continue;
            }
            columns.push(column);
            let estimate = ParameterEstimate::estimated(
                self.network().parameter_name(*parameter),
                Some(start.value(*parameter)),
                values.value(*parameter),
            );
            parameters.push(estimate.with_prior(prior(*parameter)));
        }
        let border = &self.snooped.cofactors.border;
        let cofactors = DMatrix::from_fn(columns.len(), columns.len(), |row, column| {
            match (columns.get(row), columns.get(column)) {
                (Some(&row), Some(&column)) => element(border, row, column),
                _ => 0.0,
            }
        });
        (parameters, cofactors)
    }

    fn datum_in_words(&self) -> String {
        let solution = &self.snooped.solution;
        let network = self.network();
        let held = network
            .points
            .iter()
            .filter(|point| point.is_held())
            .count();
        let weighted = network
            .points
            .iter()
            .filter(|point| point.role == PointRole::Control && !point.is_held())
            .count();
        let observed = network
            .images
            .iter()
            .filter(|image| image.observed.is_some())
            .count();
        match solution.datum.defects() {
            0 => format!(
                "by observations: {held} control points held, {weighted} weighted, {observed} images with observed position or attitude"
            ),
            defects => {
                let why = if self.choice == DatumChoice::Free {
                    "as asked for"
                } else {
                    "the observations leave them open"
                };
                format!(
                    "free network: {defects} of 7 parameters by inner constraints over {} object points, {why}",
                    solution.layout.unknown_points()
                )
            }
        }
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = vec![
            "distortion is measured - ideal, a function of the measured point; residuals are those of the corrected point"
                .to_owned(),
        ];
        if !self.snooped.tests.exact {
            notes.push(format!(
                "{} images: redundancy numbers are the mean one, and images have no σ",
                self.network().images.len()
            ));
        }
        if self.unrejected.redundancy() != self.snooped.solution.redundancy() {
            notes.push(format!(
                "with all observations σ0 is {:.6}, redundancy {}",
                self.unrejected.sigma0(),
                self.unrejected.redundancy()
            ));
        }
        notes
    }

    fn image_residuals(&self) -> Vec<ImageResidual> {
        let network = self.network();
        let images: Vec<Arc<str>> = network
            .images
            .iter()
            .map(|image| image.name.as_str().into())
            .collect();
        let points: Vec<Arc<str>> = network
            .points
            .iter()
            .map(|point| point.name.as_str().into())
            .collect();
        let mut residuals: Vec<ImageResidual> = network
            .image_points
            .iter()
            .zip(&self.snooped.tests.image_points)
            .zip(&self.lines)
            .map(|((observed, components), line)| ImageResidual {
                line: *line,
                image: images.get(observed.image).cloned().unwrap_or_default(),
                point: points.get(observed.point).cloned().unwrap_or_default(),
                measured_mm: observed.measured_mm,
                components: *components,
                is_rejected: !observed.accepted,
            })
            .collect();
        residuals.sort_by_key(|residual| residual.line);
        residuals
    }

    fn other_residuals(&self) -> Vec<ObservationResidual> {
        let network = self.network();
        let image = |number: usize| {
            network
                .images
                .get(number)
                .map(|image| Arc::from(image.name.as_str()))
        };
        let point = |number: usize| {
            network
                .points
                .get(number)
                .map(|point| Arc::from(point.name.as_str()))
        };
        let others = self.snooped.tests.others.iter();
        others
            .map(|(observation, tested)| {
                let (group, image, point, component) = match *observation {
                    OtherObservation::Coordinate {
                        point: number,
                        axis,
                    } => (
                        "control",
                        None,
                        point(number),
                        named(&POINT_COMPONENTS, axis),
                    ),
                    OtherObservation::Pose {
                        image: number,
                        element,
                    } => {
                        let group = if element < 3 { "gnss" } else { "attitude" };
                        (group, image(number), None, named(&POSE_COMPONENTS, element))
                    }
                    OtherObservation::ScaleBar(number) => {
                        let ends = network.scale_bars.get(number).map(|bar| bar.ends);
                        let first = ends.and_then(|[first, _]| point(first));
                        ("scale bars", None, first, "length_m")
                    }
                    OtherObservation::Prior(number) => {
                        let prior = network.priors.get(number);
                        let name = prior.map_or("", |prior| match prior.parameter {
                            Parameter::Interior(element) => element.name(),
                            Parameter::Stage(element) => element.name(),
                            _ => "shared unknown",
                        });
                        ("prior", None, None, name)
                    }
                };
                ObservationResidual {
                    group,
                    image,
                    point,
                    component,
                    tested: *tested,
                    is_rejected: false,
                }
            })
            .collect()
    }
}

fn named(names: &[&'static str], index: usize) -> &'static str {
    names.get(index).copied().unwrap_or_default()
}

/// Returns the static calibration with a new interior orientation.
fn calibrated(camera: &CameraFile, interior: &Interior) -> StaticCalibration {
    let mut calibrated = StaticCalibration::of(camera);
    calibrated.principal_distance_mm = interior.principal_distance_mm;
    calibrated.principal_point_mm = interior.principal_point_mm;
    let table = &mut calibrated.distortion;
    [table.k0, table.k1, table.k2, table.k3] = interior.k;
    [table.p1, table.p2] = interior.p;
    [table.b1, table.b2] = interior.b;
    calibrated
}

fn groups(
    image_residuals: &[ImageResidual],
    other_residuals: &[ObservationResidual],
) -> Vec<ObservationGroup> {
    let mut groups = vec![ObservationGroup::of_image_points(image_residuals)];
    for name in ["control", "gnss", "attitude", "scale bars", "prior"] {
        let group = ObservationGroup::new(
            name,
            other_residuals
                .iter()
                .filter(|one| one.group == name)
                .map(|one| (one.tested, one.is_rejected)),
        );
        if group.observations > 0 {
            groups.push(group);
        }
    }
    groups
}
