//! Data that determine no polynomials.

use fmc_camera_file::InputError;

use crate::rig::control::Measurements;
use crate::rig::description::Rig;
use crate::rig::normals::Undetermined;
use crate::rig::polynomial::{DEGREES, terms};

/// Returns the numbers of control points and ties of each sub-image.
pub(super) fn counts(
    rig: &Rig,
    measurements: &Measurements,
    accepted: Option<&[bool]>,
) -> Vec<[usize; 2]> {
    let mut counts = vec![[0, 0]; rig.sub.len()];
    let is_accepted =
        |number: usize| accepted.is_none_or(|list| list.get(number).copied().unwrap_or(false));
    for (number, point) in measurements.control.iter().enumerate() {
        if let Some([control, _]) = counts.get_mut(point.place.sub)
            && is_accepted(number)
        {
            *control += 1;
        }
    }
    for (number, tie) in measurements.ties.iter().enumerate() {
        for place in &tie.places {
            if let Some([_, ties]) = counts.get_mut(place.sub)
                && is_accepted(measurements.control.len() + number)
            {
                *ties += 1;
            }
        }
    }
    counts
}

/// Refuses sub-images with too few points for the coefficients.
pub(super) fn check_counts(
    rig: &Rig,
    measurements: &Measurements,
    degree: usize,
) -> Result<(), InputError> {
    if !DEGREES.contains(&degree) {
        return Err(InputError::invalid(format!(
            "degree = {degree}; allowed: 2 to 5"
        )));
    }
    check(rig, measurements, degree, &counts(rig, measurements, None))
}

/// The same once gross errors are rejected.
pub(super) fn check_accepted(
    rig: &Rig,
    measurements: &Measurements,
    degree: usize,
    accepted: &[bool],
) -> Result<(), InputError> {
    let counts = counts(rig, measurements, Some(accepted));
    check(rig, measurements, degree, &counts)
}

fn check(
    rig: &Rig,
    measurements: &Measurements,
    degree: usize,
    counts: &[[usize; 2]],
) -> Result<(), InputError> {
    let file = &measurements.control_file;
    for (sub, [control, ties]) in rig.sub.iter().zip(counts) {
        if control + ties == 0 {
            return Err(InputError::invalid(format!(
                "{file}: no control point and no tie in sub-image {}; every sub-image of the rig ({}) needs some",
                sub.id,
                rig.ids()
            )));
        }
        let wanted = terms(degree);
        if control + ties <= wanted {
            return Err(InputError::invalid(format!(
                "{file}: {control} control points and {ties} ties in sub-image {} for {wanted} coefficients of each axis (degree {degree}); more points than coefficients are needed, 20 or more are advised",
                sub.id
            )));
        }
    }
    Ok(())
}

/// Returns the error of an unknown that is not determined.
pub(super) fn not_determined(
    rig: &Rig,
    measurements: &Measurements,
    degree: usize,
    Undetermined(unknown): Undetermined,
) -> InputError {
    let terms = terms(degree);
    let what = match rig.sub.get(unknown / (2 * terms)) {
        Some(sub) => format!(
            "{} of sub-image {}",
            name(unknown % (2 * terms), terms),
            sub.id
        ),
        None => "the orientation of an exposure".to_owned(),
    };
    InputError::invalid(format!(
        "{}: {what} is not determined; spread the points over the whole sub-image, or take a lower degree",
        measurements.control_file
    ))
}

/// Name of a coefficient.
pub(super) fn name(unknown: usize, terms: usize) -> String {
    if unknown < terms {
        format!("a{unknown}")
    } else {
        format!("b{}", unknown - terms)
    }
}
