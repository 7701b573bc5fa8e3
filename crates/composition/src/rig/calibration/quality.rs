//! Quality of a calibration, and its refusal.

use fmc_camera_file::InputError;

use super::outcome::{Correlation, MovementEstimate, RigCalibration, RigResidual, SubQuality};
use super::refusal::{counts, name};
use super::system::{HELD_PX, State, System, variance};
use crate::number::real;
use crate::rig::description::{CalibrationTable, SubImage};
use crate::rig::normals::Solved;
use crate::rig::polynomial::{basis, normalised};

/// Places along a side of a sub-image at which σ is looked at.
const PLACES: usize = 9;
/// Largest σ of a place of a sub-image, px: beyond it the points do not determine it.
const LARGEST_SIGMA_PX: f64 = 3.0;

/// Makes the result of an adjustment.
pub(super) fn result(
    system: &System,
    state: &State,
    movements: Vec<MovementEstimate>,
) -> Result<RigCalibration, InputError> {
    let observations = 2 * system.numbers().count();
    let held = movements.iter().filter(|one| one.held).count();
    let redundancy = (observations + held).saturating_sub(system.unknowns());
    // Orientations take the movements up, which are no uncertainty of the rig: σ is that of
    // held movements.
    let normals = system.normals(state, &vec![HELD_PX; system.functionals.len()]);
    let solved = normals
        .solve()
        .map_err(|undetermined| system.not_determined(undetermined))?;
    let squares = normals.squares;
    let sigma0 = if redundancy == 0 {
        1.0
    } else {
        (squares / real(redundancy)).sqrt()
    };
    let mut rig = system.rig.clone();
    rig.calibration = Some(CalibrationTable {
        heights: system.options.heights,
    });
    let mut subs = Vec::new();
    let all = counts(system.rig, system.measurements, Some(&system.accepted));
    let each = rig
        .sub
        .iter_mut()
        .zip(&state.polynomials)
        .zip(all)
        .enumerate();
    for (number, ((sub, polynomial), [control, ties])) in each {
        let quality = of_sub(system, &solved, sigma0, number, [control, ties]);
        if quality.sigma_px > LARGEST_SIGMA_PX * sigma0.max(1.0) {
            return Err(InputError::invalid(format!(
                "{}: sub-image {}: {control} control points and {ties} ties leave a σ of {:.1} px at its worst place; allowed: {LARGEST_SIGMA_PX} px; add points where there are none",
                system.measurements.control_file, sub.id, quality.sigma_px
            )));
        }
        let mut polynomial = polynomial.clone();
        polynomial.sigma_px = quality.sigma_px;
        sub.polynomial = Some(polynomial);
        subs.push(quality);
    }
    Ok(RigCalibration {
        rig,
        exposures: system
            .exposures
            .iter()
            .cloned()
            .zip(state.orientations.iter().copied())
            .collect(),
        sigma0,
        redundancy,
        movements,
        residuals: residuals(system, state),
        subs,
    })
}

fn of_sub(
    system: &System,
    solved: &Solved,
    sigma0: f64,
    number: usize,
    [control, ties]: [usize; 2],
) -> SubQuality {
    let terms = system.terms();
    let first = 2 * terms * number;
    let size = system.rig.sub.get(number).map_or([1, 1], SubImage::size_px);
    let mut sigmas = Vec::new();
    for index in 0..PLACES * PLACES {
        let part =
            |number: usize, side: usize| real(number) / real(PLACES - 1) * (real(side) - 1.0);
        let pixel = [part(index % PLACES, size[0]), part(index / PLACES, size[1])];
        let values = basis(system.options.degree, normalised(size, pixel));
        let of_axis = |first: usize| {
            let row: Vec<(usize, f64)> = values
                .iter()
                .enumerate()
                .map(|(term, value)| (first + term, *value))
                .collect();
            variance(&row, &solved.cofactors)
        };
        sigmas.push(sigma0 * of_axis(first).max(of_axis(first + terms)).sqrt());
    }
    let cofactor = |a: usize, b: usize| {
        let element = solved.cofactors.get((first + a, first + b));
        element.copied().unwrap_or_default()
    };
    let sigma = |unknown: usize| sigma0 * cofactor(unknown, unknown).max(0.0).sqrt();
    let pairs = (0..2 * terms).flat_map(|a| (a + 1..2 * terms).map(move |b| [a, b]));
    let correlations = pairs.map(|[a, b]| Correlation {
        names: [name(a, terms), name(b, terms)],
        value: cofactor(a, b) / (cofactor(a, a) * cofactor(b, b)).sqrt(),
    });
    SubQuality {
        control,
        ties,
        sigma_px: sigmas.iter().copied().fold(0.0, f64::max),
        mean_sigma_px: sigmas.iter().sum::<f64>() / real(sigmas.len()),
        sigma_u: (0..terms).map(sigma).collect(),
        sigma_v: (terms..2 * terms).map(sigma).collect(),
        correlations: correlations.collect(),
    }
}

fn residuals(system: &System, state: &State) -> Vec<RigResidual> {
    let control = system.measurements.control.iter();
    let control = control.map(|point| (&point.id, &point.exposure, &point.place, false));
    let ties = system.measurements.ties.iter().map(|tie| {
        let [place, _] = &tie.places;
        (&tie.id, &tie.exposure, place, true)
    });
    let points = control.chain(ties).zip(&system.accepted).enumerate();
    let residuals = points.filter_map(|(number, ((id, exposure, place, is_tie), accepted))| {
        let equations = system.equations(state, number)?;
        Some(RigResidual {
            id: id.clone(),
            exposure: exposure.clone(),
            sub: place.sub,
            place_px: system.place(state, place)?,
            residual_px: equations.misclosure_px.map(|misclosure| -misclosure),
            sigma_px: equations.sigma_px,
            is_tie,
            accepted: *accepted,
        })
    });
    residuals.collect()
}
