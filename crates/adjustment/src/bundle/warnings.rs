//! Doubts about a calibration by a network that its reader must know of.

use crate::calibration::gross_errors::rejection_warning;
use crate::calibration::result::CalibrationResult;
use crate::calibration::result::network::PointRole;

use super::calibration::BundleCalibration;
use super::correlated_pairs;
use super::geometry::{LEAST_ROLL_DEG, is_plane_without_tilt, largest_roll_deg};
use super::interior::InteriorElement;
use super::parameters::Parameter;
use super::tested::OtherObservation;

/// Test value of a check point, in units of its σ, above which it is named.
const MOST_CHECK: f64 = 4.0;

/// Share of the σ of a prior above which the observations say nothing about its unknown.
const MOST_OF_PRIOR: f64 = 0.9;

/// Share of an image's points whose rejection puts the image itself in doubt.
const MOST_REJECTED: f64 = 0.3;

/// Returns the warnings.
#[must_use]
pub fn of(calibration: &BundleCalibration, result: &CalibrationResult) -> Vec<String> {
    let mut warnings = Vec::new();
    geometry(calibration, &mut warnings);
    if InteriorElement::ALL
        .iter()
        .any(|element| calibration.estimates(*element))
    {
        warnings.extend(result.coverage().warning());
    }
    correlations(calibration, result, &mut warnings);
    priors(result, &mut warnings);
    stage(calibration, &mut warnings);
    control(calibration, &mut warnings);
    check_points(result, &mut warnings);
    other_observations(calibration, &mut warnings);
    images(calibration, &mut warnings);
    warnings.extend(rejection_warning(result));
    warnings
}

fn geometry(calibration: &BundleCalibration, warnings: &mut Vec<String>) {
    let solution = &calibration.snooped.solution;
    let roll_deg = largest_roll_deg(&solution.state.poses);
    let has_point = [InteriorElement::X0, InteriorElement::Y0]
        .iter()
        .any(|element| calibration.estimates(*element));
    if has_point && roll_deg < LEAST_ROLL_DEG {
        warnings.push(format!(
            "no image is rolled against another by more than {roll_deg:.0}°, at least {LEAST_ROLL_DEG}° are wanted: the principal \
             point is told from the attitude by the depth of the field alone"
        ));
    }
    if calibration.estimates(InteriorElement::PrincipalDistance) && is_plane_without_tilt(solution)
    {
        warnings.push(
            "the field is plane and no image is tilted: the principal distance is told from the distance of the field by \
             nothing but other observations"
                .to_owned(),
        );
    }
}

fn correlations(
    calibration: &BundleCalibration,
    result: &CalibrationResult,
    warnings: &mut Vec<String>,
) {
    let network = &calibration.snooped.network;
    let border = &calibration.snooped.solution.layout.border;
    let parameter = |name: &str| {
        let mut all = border.iter().copied();
        all.find(|parameter| network.parameter_name(*parameter) == name)
    };
    for (a, b, value) in result.high_correlations() {
        let remedy = parameter(a).zip(parameter(b));
        let remedy = remedy.and_then(|(a, b)| correlated_pairs::remedy(a, b));
        let remedy = remedy.map_or_else(String::new, |words| {
            format!("; {words} would tell them apart")
        });
        warnings.push(format!("{a} and {b} are correlated by {value:.3}{remedy}"));
    }
}

fn priors(result: &CalibrationResult, warnings: &mut Vec<String>) {
    for one in &result.parameters {
        let sigma = result.sigma_a_priori(&one.name);
        let Some((prior, sigma)) = one.prior_sigma.zip(sigma) else {
            continue;
        };
        if sigma >= MOST_OF_PRIOR * prior {
            warnings.push(format!(
                "the observations say nothing about {}: its σ of {sigma:.3e} before σ0 is that of its prior, {prior:.3e}",
                one.name
            ));
        }
    }
}

fn stage(calibration: &BundleCalibration, warnings: &mut Vec<String>) {
    let border = calibration.snooped.solution.layout.border.iter();
    let names: Vec<&str> = border
        .filter_map(|parameter| match parameter {
            Parameter::Stage(element) => Some(element.name()),
            _ => None,
        })
        .collect();
    if !names.is_empty() {
        warnings.push(format!(
            "{} of a flight do not go into the camera file: it holds no σ of the laboratory's, and theirs would have to be larger",
            names.join(", ")
        ));
    }
}

fn control(calibration: &BundleCalibration, warnings: &mut Vec<String>) {
    let snooped = &calibration.snooped;
    for misfit in &snooped.misfits {
        let name = snooped
            .network
            .points
            .get(misfit.point)
            .map_or("", |point| &point.name);
        let [x, y, z]: [f64; 3] = misfit.difference_m.into();
        warnings.push(format!(
            "control point {name} does not fit: without it as control it lies at {x:.6}, {y:.6}, {z:.6} m from its given \
             coordinates, and σ0 is {:.4} instead of {:.4}",
            snooped.sigma0_without_misfits,
            snooped.solution.sigma0()
        ));
    }
}

fn check_points(result: &CalibrationResult, warnings: &mut Vec<String>) {
    for point in result
        .points
        .iter()
        .filter(|point| point.role == PointRole::Check)
    {
        let Some(given) = point.given_m else { continue };
        if point.rays < 2 {
            warnings.push(format!(
                "check point {} has fewer than two image points",
                point.point
            ));
            continue;
        }
        let axes = ["x", "y", "z"]
            .into_iter()
            .zip(point.position_m)
            .zip(given)
            .zip(point.sigma_m);
        for (((axis, adjusted), given), sigma) in axes {
            let difference = adjusted - given;
            if difference.abs() > MOST_CHECK * sigma && sigma > 0.0 {
                warnings.push(format!(
                    "check point {}: {axis} is off by {difference:.4} m, {:.1} times its σ of {sigma:.4} m",
                    point.point,
                    difference.abs() / sigma
                ));
            }
        }
    }
}

fn other_observations(calibration: &BundleCalibration, warnings: &mut Vec<String>) {
    let snooped = &calibration.snooped;
    let network = &snooped.network;
    for (observation, tested) in &snooped.tests.others {
        if tested.test_value <= snooped.critical {
            continue;
        }
        let point = |number: usize| network.points.get(number).map_or("", |point| &point.name);
        let what = match *observation {
            OtherObservation::Coordinate {
                point: number,
                axis,
            } => {
                let axis = super::parameters::AXES
                    .get(axis)
                    .copied()
                    .unwrap_or_default();
                format!("control point {}, {axis}", point(number))
            }
            OtherObservation::Pose { image, element } => {
                let image = network.images.get(image).map_or("", |image| &image.name);
                let element = crate::exterior_orientation::ELEMENT_NAMES.get(element);
                format!("image {image}, {}", element.copied().unwrap_or_default())
            }
            OtherObservation::ScaleBar(number) => network
                .scale_bars
                .get(number)
                .map_or_else(String::new, |bar| {
                    format!("scale bar {} to {}", point(bar.ends[0]), point(bar.ends[1]))
                }),
            OtherObservation::Prior(number) => network
                .priors
                .get(number)
                .map_or_else(String::new, |prior| {
                    format!("prior of {}", network.parameter_name(prior.parameter))
                }),
        };
        warnings.push(format!(
            "{what}: test value {:.1} exceeds {:.1}; the observation does not fit",
            tested.test_value, snooped.critical
        ));
    }
}

fn images(calibration: &BundleCalibration, warnings: &mut Vec<String>) {
    let network = &calibration.snooped.network;
    let mut counts = vec![(0_u32, 0_u32); network.images.len()];
    for observed in &network.image_points {
        if let Some((all, rejected)) = counts.get_mut(observed.image) {
            *all += 1;
            *rejected += u32::from(!observed.accepted);
        }
    }
    for (image, (all, rejected)) in network.images.iter().zip(counts) {
        if f64::from(rejected) > MOST_REJECTED * f64::from(all) {
            warnings.push(format!(
                "image {}: {rejected} of {all} image points are rejected; the image itself is in doubt",
                image.name
            ));
        }
    }
}
