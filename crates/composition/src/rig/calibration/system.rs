//! Observation equations of a rig, and their solution.

use fmc_adjustment::collinearity::projection;
use fmc_adjustment::exterior_orientation::{ELEMENTS, ExteriorOrientation};
use fmc_camera_file::InputError;
use nalgebra::DMatrix;

use super::outcome::{MovementEstimate, RigOptions};
use super::refusal::{check_accepted, not_determined};
use crate::number::median;
use crate::rig::control::{Measurements, Place};
use crate::rig::description::{Heights, Rig, SubImage};
use crate::rig::gauge::Functional;
use crate::rig::normals::{Normals, Solved, Undetermined};
use crate::rig::polynomial::{Polynomial, basis, normalised, terms};
use crate::rig::start::Start;

/// σ of a turn of the camera, px, that is held.
pub(super) const HELD_PX: f64 = 1e-3;
/// σ of the nominal value of another movement that is held, px: detectors are mounted as well. Held
/// without it, an error of a movement that relief shows a little would bend the polynomials.
const NOMINAL_PX: f64 = 0.5;
/// σ with which a movement is known before, px, when it is asked what the data say of it.
const LOOSE_PX: f64 = 20.0;
/// σ of a movement, px, up to which the data separate it from the orientations.
const SEPARATE_PX: f64 = 0.3;
/// Largest number of rounds of the linearised adjustment, which ends when no coefficient changes
/// by more than [`CLOSE_SIGMA`] of the σ of an image point: with large errors every round takes
/// only a third of what is left.
const ROUNDS: usize = 60;
const CLOSE_SIGMA: f64 = 4e-7;
/// Residual in σ, or in robust deviations, beyond which a point is a gross error.
const GROSS: f64 = 4.5;
/// One point in so many may be rejected.
const REJECTED_PART: usize = 8;

/// Coefficients and orientations.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub(super) polynomials: Vec<Polynomial>,
    pub(super) orientations: Vec<ExteriorOrientation>,
}

/// Observations of a calibration.
#[derive(Debug)]
pub(super) struct System<'a> {
    pub(super) rig: &'a Rig,
    pub(super) measurements: &'a Measurements,
    pub(super) options: &'a RigOptions,
    pub(super) exposures: &'a [String],
    pub(super) starts: &'a [Start],
    pub(super) functionals: Vec<Functional>,
    pub(super) movement_sigmas: Vec<f64>,
    /// Of control, then of ties.
    pub(super) accepted: Vec<bool>,
}

/// Two equations of a point: derivatives of u and v, observed minus computed, σ.
pub(super) struct Equations {
    pub(super) rows: [Vec<(usize, f64)>; 2],
    pub(super) misclosure_px: [f64; 2],
    pub(super) sigma_px: f64,
}

impl System<'_> {
    pub(super) fn terms(&self) -> usize {
        terms(self.options.degree)
    }

    /// Number of coefficients of all sub-images.
    fn coefficients(&self) -> usize {
        2 * self.terms() * self.rig.sub.len()
    }

    pub(super) fn unknowns(&self) -> usize {
        let of_orientations = match self.options.heights {
            Heights::Use => ELEMENTS * self.exposures.len(),
            Heights::Ignore => 0,
        };
        self.coefficients() + of_orientations
    }

    fn first_state(&self) -> State {
        let nominal = self.rig.sub.iter().map(|sub| {
            let mut polynomial = sub.nominal(self.rig.frame);
            polynomial.degree = self.options.degree;
            polynomial.u.resize(self.terms(), 0.0);
            polynomial.v.resize(self.terms(), 0.0);
            polynomial
        });
        State {
            polynomials: nominal.collect(),
            orientations: self.starts.iter().map(|start| start.orientation).collect(),
        }
    }

    /// Terms of a place, as derivatives by the coefficients of u and of v.
    fn place_rows(&self, place: &Place, factor: f64) -> [Vec<(usize, f64)>; 2] {
        let size = self
            .rig
            .sub
            .get(place.sub)
            .map_or([1, 1], SubImage::size_px);
        let values = basis(self.options.degree, normalised(size, place.pixel));
        let first = 2 * self.terms() * place.sub;
        [first, first + self.terms()].map(|first| {
            let terms = values.iter().enumerate();
            terms
                .map(|(term, value)| (first + term, factor * value))
                .collect()
        })
    }

    pub(super) fn place(&self, state: &State, place: &Place) -> Option<[f64; 2]> {
        let sub = self.rig.sub.get(place.sub)?;
        let polynomial = state.polynomials.get(place.sub)?;
        Some(polynomial.value(normalised(sub.size_px(), place.pixel)))
    }

    /// Returns the equations of a point, control first, then ties.
    pub(super) fn equations(&self, state: &State, number: usize) -> Option<Equations> {
        let sigma_px = self.options.sigma_px;
        let controls = self.measurements.control.len();
        let Some(point) = self.measurements.control.get(number) else {
            let tie = self.measurements.ties.get(number - controls)?;
            let [first, second] = &tie.places;
            let (here, there) = (self.place(state, first)?, self.place(state, second)?);
            let [mut of_u, mut of_v] = self.place_rows(first, 1.0);
            let [more_u, more_v] = self.place_rows(second, -1.0);
            of_u.extend(more_u);
            of_v.extend(more_v);
            return Some(Equations {
                rows: [of_u, of_v],
                misclosure_px: [there[0] - here[0], there[1] - here[1]],
                sigma_px: sigma_px * std::f64::consts::SQRT_2,
            });
        };
        let exposure = self
            .exposures
            .iter()
            .position(|name| *name == point.exposure)?;
        let start = self.starts.get(exposure)?;
        let [u, v] = self.place(state, &point.place)?;
        let [centre_u, centre_v] = self.rig.frame.centre_px();
        let [mut of_u, mut of_v] = self.place_rows(&point.place, 1.0);
        let [x, y] = match self.options.heights {
            Heights::Ignore => {
                let [x, y, _] = point.ground_m;
                start.similarity.place_px([x, y])
            }
            Heights::Use => {
                let orientation = state.orientations.get(exposure)?;
                let f_px = self.rig.principal_distance_px();
                let seen = projection(orientation, f_px, point.ground_m)?;
                let first = self.coefficients() + ELEMENTS * exposure;
                let derivatives = seen.by_orientation;
                of_u.extend(
                    derivatives
                        .row(0)
                        .iter()
                        .enumerate()
                        .map(|(element, by)| (first + element, -by)),
                );
                of_v.extend(
                    derivatives
                        .row(1)
                        .iter()
                        .enumerate()
                        .map(|(element, by)| (first + element, *by)),
                );
                [seen.image_mm.x, seen.image_mm.y]
            }
        };
        Some(Equations {
            rows: [of_u, of_v],
            misclosure_px: [centre_u + x - u, centre_v - y - v],
            sigma_px: sigma_px.hypot(point.sigma_m / start.similarity.scale()),
        })
    }

    pub(super) fn normals(&self, state: &State, movement_sigmas: &[f64]) -> Normals {
        let mut normals = Normals::new(self.unknowns());
        for number in self.numbers() {
            let Some(equations) = self.equations(state, number) else {
                continue;
            };
            for (row, misclosure) in equations.rows.iter().zip(equations.misclosure_px) {
                normals.add(row, misclosure, equations.sigma_px);
            }
        }
        let squares = normals.squares;
        for (functional, sigma) in self.functionals.iter().zip(movement_sigmas) {
            let row = Self::functional_row(functional);
            let size: f64 = row
                .iter()
                .map(|(unknown, a)| a * self.value(state, *unknown))
                .sum();
            normals.add(&row, functional.nominal_px - size, *sigma);
        }
        normals.squares = squares;
        normals
    }

    /// Numbers of the accepted points.
    pub(super) fn numbers(&self) -> impl Iterator<Item = usize> {
        self.accepted
            .iter()
            .enumerate()
            .filter(|(_, accepted)| **accepted)
            .map(|(number, _)| number)
    }

    fn functional_row(functional: &Functional) -> Vec<(usize, f64)> {
        let flat = functional.rows.iter().flatten().flatten();
        flat.copied().enumerate().collect()
    }

    /// Value of a coefficient.
    fn value(&self, state: &State, unknown: usize) -> f64 {
        let (sub, rest) = (unknown / (2 * self.terms()), unknown % (2 * self.terms()));
        let polynomial = state.polynomials.get(sub);
        let value = polynomial.and_then(|polynomial| {
            let of_u = polynomial.u.get(rest);
            of_u.or_else(|| polynomial.v.get(rest - self.terms()))
        });
        value.copied().unwrap_or_default()
    }

    /// Adjusts from the start until nothing changes.
    fn adjust(&self) -> Result<(State, Solved), InputError> {
        let mut state = self.first_state();
        for _ in 0..ROUNDS {
            let solved = self
                .normals(&state, &self.movement_sigmas)
                .solve()
                .map_err(|undetermined| self.not_determined(undetermined))?;
            let mut largest: f64 = 0.0;
            let width = 2 * self.terms();
            for (sub, polynomial) in state.polynomials.iter_mut().enumerate() {
                let list = polynomial.u.iter_mut().chain(&mut polynomial.v);
                for (slot, way) in list.zip(solved.way.iter().skip(width * sub)) {
                    *slot += way;
                    largest = largest.max(way.abs());
                }
            }
            if self.options.heights == Heights::Use {
                for (number, orientation) in state.orientations.iter_mut().enumerate() {
                    let first = self.coefficients() + ELEMENTS * number;
                    let way = solved.way.rows(first, ELEMENTS);
                    let elements = orientation.elements() + way;
                    *orientation = ExteriorOrientation::from_elements(&elements);
                }
            }
            if largest < CLOSE_SIGMA * self.options.sigma_px {
                return Ok((state, solved));
            }
        }
        Err(InputError::invalid(format!(
            "{}: the adjustment does not converge within {ROUNDS} rounds; control or rig do not belong together",
            self.measurements.control_file
        )))
    }

    pub(super) fn not_determined(&self, undetermined: Undetermined) -> InputError {
        not_determined(
            self.rig,
            self.measurements,
            self.options.degree,
            undetermined,
        )
    }

    /// Finds what the data say of the movements, and holds those that they do not tell.
    pub(super) fn separate(&mut self) -> Result<Vec<MovementEstimate>, InputError> {
        for (functional, sigma) in self.functionals.iter().zip(&mut self.movement_sigmas) {
            *sigma = if functional.movement.is_turn() {
                HELD_PX
            } else {
                LOOSE_PX
            };
        }
        if self.functionals.is_empty() {
            return Ok(Vec::new());
        }
        let (_, solved) = self.adjust()?;
        let mut estimates = Vec::new();
        for (number, functional) in self.functionals.iter().enumerate() {
            let row = Self::functional_row(functional);
            let sigma_px = variance(&row, &solved.cofactors).sqrt();
            let is_turn = functional.movement.is_turn();
            let held = is_turn || sigma_px > SEPARATE_PX;
            if let Some(slot) = self.movement_sigmas.get_mut(number) {
                *slot = match (is_turn, held) {
                    (true, _) => HELD_PX,
                    (false, true) => NOMINAL_PX,
                    (false, false) => LOOSE_PX,
                };
            }
            estimates.push(MovementEstimate {
                movement: functional.movement,
                sigma_px: if is_turn { 0.0 } else { sigma_px },
                held,
            });
        }
        Ok(estimates)
    }

    /// Adjusts, rejecting one gross error after the other.
    pub(super) fn without_gross_errors(&mut self) -> Result<State, InputError> {
        let allowed = self.accepted.len() / REJECTED_PART;
        for round in 0.. {
            let (state, _) = self.adjust()?;
            if self.options.heights == Heights::Ignore {
                // Relief looks like gross errors.
                return Ok(state);
            }
            let sizes: Vec<(usize, f64)> = self
                .numbers()
                .filter_map(|number| {
                    let equations = self.equations(&state, number)?;
                    let [by_u, by_v] = equations.misclosure_px;
                    Some((number, by_u.hypot(by_v) / equations.sigma_px))
                })
                .collect();
            let middle = median(sizes.iter().map(|(_, size)| *size).collect()).unwrap_or(0.0);
            // Median of a Rayleigh distribution: 1.177 σ.
            let limit = GROSS * (middle / 1.177).max(0.5);
            let worst = sizes.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((number, _)) = worst.filter(|(_, size)| *size > limit) else {
                return Ok(state);
            };
            if round >= allowed {
                return Err(InputError::invalid(format!(
                    "{}: more than {allowed} of {} points are gross errors; control, ties or rig do not belong together",
                    self.measurements.control_file,
                    self.accepted.len()
                )));
            }
            if let Some(slot) = self.accepted.get_mut(*number) {
                *slot = false;
            }
            check_accepted(
                self.rig,
                self.measurements,
                self.options.degree,
                &self.accepted,
            )?;
        }
        Ok(self.adjust()?.0)
    }
}

/// Variance of a weighted sum of unknowns.
pub(super) fn variance(row: &[(usize, f64)], cofactors: &DMatrix<f64>) -> f64 {
    let mut sum = 0.0;
    for (first, a) in row {
        for (second, b) in row {
            sum += a
                * b
                * cofactors
                    .get((*first, *second))
                    .copied()
                    .unwrap_or_default();
        }
    }
    sum.max(0.0)
}
