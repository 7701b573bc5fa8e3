//! Movements that all polynomials and an orientation have in common.

use super::control::Place;
use super::description::Rig;
use super::polynomial::{basis, normalised, terms};
use crate::number::real;

/// Places along a side of each sub-image at which the fields are compared.
const PLACES: usize = 5;

/// A movement of the whole virtual image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Movement {
    /// To the right: a tilt, or the principal point.
    Right,
    /// Downwards.
    Down,
    /// A turn about the optical axis.
    Turn,
    /// Enlargement: the principal distance, or the height.
    Scale,
    /// Keystone along the columns' axis: the principal point, or a tilt with a shift.
    KeystoneRight,
    /// Keystone along the rows' axis.
    KeystoneDown,
}

impl Movement {
    /// All movements: three that are turns of the camera, three that flat ground does not show.
    pub const ALL: [Self; 6] = [
        Self::Right,
        Self::Down,
        Self::Turn,
        Self::Scale,
        Self::KeystoneRight,
        Self::KeystoneDown,
    ];

    /// Returns true for a turn of the camera, which no data separate from the orientations.
    #[must_use]
    pub const fn is_turn(self) -> bool {
        matches!(self, Self::Right | Self::Down | Self::Turn)
    }

    /// The quantity that it stands for, in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Right => "mean place of the sub-images along the columns",
            Self::Down => "mean place of the sub-images along the rows",
            Self::Turn => "turn of the sub-images about the optical axis",
            Self::Scale => "principal distance",
            Self::KeystoneRight => "principal point along the columns",
            Self::KeystoneDown => "principal point along the rows",
        }
    }

    /// Displacement, px, of a place from the centre, in units of the half diagonal.
    const fn field(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Right => [1.0, 0.0],
            Self::Down => [0.0, 1.0],
            Self::Turn => [-y, x],
            Self::Scale => [x, y],
            Self::KeystoneRight => [x * x, x * y],
            Self::KeystoneDown => [x * y, y * y],
        }
    }
}

/// A movement as a weighted sum of coefficients: its size, px (root mean square over the
/// sub-images), is the sum of `rows` times the coefficients less `nominal_px`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Functional {
    pub(super) movement: Movement,
    /// Factors of the coefficients of u and of v of each sub-image.
    pub(super) rows: Vec<[Vec<f64>; 2]>,
    pub(super) nominal_px: f64,
}

/// Places of a grid over all sub-images, with the displacements of the movements there, made
/// orthogonal to each other and of root mean square 1.
fn fields(rig: &Rig) -> (Vec<Place>, Vec<Vec<[f64; 2]>>) {
    let [half_u, half_v] = rig.frame.centre_px();
    let radius = half_u.hypot(half_v);
    let mut places = Vec::new();
    for (number, sub) in rig.sub.iter().enumerate() {
        for index in 0..PLACES * PLACES {
            let part =
                |number: usize, side: usize| real(number) / real(PLACES - 1) * (real(side) - 1.0);
            let [width, height] = sub.size_px();
            places.push(Place {
                sub: number,
                pixel: [part(index % PLACES, width), part(index / PLACES, height)],
            });
        }
    }
    let mut fields: Vec<Vec<[f64; 2]>> = Vec::new();
    for movement in Movement::ALL {
        let mut field: Vec<[f64; 2]> = places
            .iter()
            .filter_map(|Place { sub, pixel }| {
                let sub = rig.sub.get(*sub)?;
                let [u, v] = sub
                    .nominal(rig.frame)
                    .value(normalised(sub.size_px(), *pixel));
                Some(movement.field([(u - half_u) / radius, (v - half_v) / radius]))
            })
            .collect();
        for other in &fields {
            let along = product(&field, other);
            for (slot, of_other) in field.iter_mut().zip(other) {
                *slot = [slot[0] - along * of_other[0], slot[1] - along * of_other[1]];
            }
        }
        let size = product(&field, &field).sqrt();
        for slot in &mut field {
            *slot = slot.map(|value| value / size.max(f64::MIN_POSITIVE));
        }
        fields.push(field);
    }
    (places, fields)
}

fn product(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let sum: f64 = a
        .iter()
        .zip(b)
        .map(|(a, b)| a[0] * b[0] + a[1] * b[1])
        .sum();
    sum / real(a.len().max(1))
}

/// Returns the sizes of all movements as functions of the coefficients of polynomials of a degree.
pub(super) fn functionals(rig: &Rig, degree: usize) -> Vec<Functional> {
    let (places, fields) = fields(rig);
    let count = real(places.len().max(1));
    let mut functionals = Vec::new();
    for (movement, field) in Movement::ALL.into_iter().zip(&fields) {
        let mut rows = vec![[vec![0.0; terms(degree)], vec![0.0; terms(degree)]]; rig.sub.len()];
        let mut nominal_px = 0.0;
        for (Place { sub: number, pixel }, [right, down]) in places.iter().zip(field) {
            let (Some(sub), Some([of_u, of_v])) = (rig.sub.get(*number), rows.get_mut(*number))
            else {
                continue;
            };
            let place = normalised(sub.size_px(), *pixel);
            for ((slot_u, slot_v), value) in of_u.iter_mut().zip(of_v).zip(basis(degree, place)) {
                *slot_u += right * value / count;
                *slot_v += down * value / count;
            }
            let [u, v] = sub.nominal(rig.frame).value(place);
            nominal_px += (right * u + down * v) / count;
        }
        functionals.push(Functional {
            movement,
            rows,
            nominal_px,
        });
    }
    functionals
}

/// Removes all six movements from differences of places: those of the calibrated rig that the
/// orientation takes up. Returns what is left; `None` with fewer than seven places.
#[must_use]
pub(crate) fn without_movements(
    rig: &Rig,
    places: &[[f64; 2]],
    differences: &[[f64; 2]],
) -> Option<Vec<[f64; 2]>> {
    if places.len() < 7 || places.len() != differences.len() {
        return None;
    }
    let [half_u, half_v] = rig.frame.centre_px();
    let radius = half_u.hypot(half_v);
    let field = |[u, v]: [f64; 2], movement: Movement| {
        movement.field([(u - half_u) / radius, (v - half_v) / radius])
    };
    let (mut normals, mut right) = (nalgebra::Matrix6::zeros(), nalgebra::Vector6::zeros());
    for (place, difference) in places.iter().zip(differences) {
        for axis in 0..2 {
            let pick = |pair: [f64; 2]| pair.get(axis).copied().unwrap_or_default();
            let values = Movement::ALL.map(|movement| pick(field(*place, movement)));
            let row = nalgebra::Vector6::from(values);
            normals += row * row.transpose();
            right += row * pick(*difference);
        }
    }
    let sizes = normals.cholesky()?.solve(&right);
    let left = places.iter().zip(differences).map(|(place, difference)| {
        let mut left = *difference;
        for (movement, size) in Movement::ALL.into_iter().zip(sizes.iter()) {
            let [x, y] = field(*place, movement);
            left = [left[0] - size * x, left[1] - size * y];
        }
        left
    });
    Some(left.collect())
}
