//! Proof that a formula of rays is one-to-one over a field, by intervals and subdivision.

use std::cmp::Ordering;

use fmc_camera_file::InputError;

use crate::pinhole::Pinhole;
use crate::scalar::{Interval, Scalar, Sloped};

/// Most boxes that are examined.
const MAX_BOXES: usize = 200_000;

/// Boxes along each side before the first subdivision.
const BOXES: u32 = 8;

/// Fault of a formula within a field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fault {
    /// The denominator of the radial quotient, or that of the tilt, is zero at this ray.
    Pole([f64; 2]),
    /// Two rays are measured at one place near this ray: the image folds.
    Fold([f64; 2]),
    /// Neither is found, nor can it be excluded near this ray.
    Undecided([f64; 2]),
}

impl Fault {
    /// Creates the error of a model that cannot be used over the sensor.
    pub(crate) fn refused(self, what: &str) -> InputError {
        let (fault, [x, y]) = match self {
            Self::Pole(ray) => ("has a zero of its denominator", ray),
            Self::Fold(ray) => ("folds", ray),
            Self::Undecided(ray) => ("cannot be shown to be one-to-one", ray),
        };
        InputError::invalid(format!(
            "{what}: the model {fault} within the sensor, near the ray ({x:.4}, {y:.4})"
        ))
    }
}

/// A rectangle of rays.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Field {
    least: [f64; 2],
    most: [f64; 2],
}

impl Field {
    /// Returns the smallest rectangle that holds the rays.
    pub(crate) fn around(rays: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let nothing = Self {
            least: [f64::INFINITY; 2],
            most: [f64::NEG_INFINITY; 2],
        };
        rays.into_iter().fold(nothing, |field, [x, y]| Self {
            least: [field.least[0].min(x), field.least[1].min(y)],
            most: [field.most[0].max(x), field.most[1].max(y)],
        })
    }

    fn middle(&self) -> [f64; 2] {
        [
            0.5 * (self.least[0] + self.most[0]),
            0.5 * (self.least[1] + self.most[1]),
        ]
    }

    /// Returns `count` x `count` parts.
    fn parts(&self, count: u32) -> impl Iterator<Item = Self> {
        let (least, most) = (self.least, self.most);
        let edge = move |axis: usize, index: u32| {
            let part = f64::from(index) / f64::from(count);
            let ends = [least, most].map(|end| end.get(axis).copied().unwrap_or(0.0));
            ends[0] + (ends[1] - ends[0]) * part
        };
        (0..count * count).map(move |cell| {
            let (row, column) = (cell / count, cell % count);
            Self {
                least: [edge(0, column), edge(1, row)],
                most: [edge(0, column + 1), edge(1, row + 1)],
            }
        })
    }

    fn intervals(&self) -> [Interval; 2] {
        [
            Interval::new(self.least[0], self.most[0]),
            Interval::new(self.least[1], self.most[1]),
        ]
    }
}

/// Shows that the formula is one-to-one over the field and has no pole there.
///
/// # Model
/// On a convex field a map is one-to-one if the symmetric part of its derivative is positive
/// definite everywhere. Each box is accepted if the bounds of the derivative by interval arithmetic
/// show that, refused if its middle contradicts, and divided into four otherwise.
///
/// # Errors
/// The [`Fault`], with a ray near it.
pub(crate) fn show(camera: &Pinhole, field: &Field) -> Result<(), Fault> {
    let mut boxes: Vec<Field> = field.parts(BOXES).collect();
    let mut examined = 0;
    while let Some(part) = boxes.pop() {
        examined += 1;
        let middle = part.middle();
        // The middle alone is a box, too: its bounds are exact.
        let [x, y] = middle;
        let point = Field {
            least: [x, y],
            most: [x, y],
        };
        if divisor(camera, &point).least.partial_cmp(&0.0) != Some(Ordering::Greater) {
            return Err(Fault::Pole(middle));
        }
        if !is_increasing(camera, &point) {
            return Err(Fault::Fold(middle));
        }
        if divisor(camera, &part).least > 0.0 && is_increasing(camera, &part) {
            continue;
        }
        if examined > MAX_BOXES {
            return Err(Fault::Undecided(middle));
        }
        boxes.extend(part.parts(2));
    }
    Ok(())
}

/// Returns bounds of the denominator over a box.
fn divisor(camera: &Pinhole, part: &Field) -> Interval {
    let [x, y] = part.intervals();
    let [offset_x, offset_y] = camera.offset.map(Interval::constant);
    let r2 = (x - offset_x).squared() + (y - offset_y).squared();
    camera.map(Interval::constant).denominator(r2)
}

/// Returns `true` if the symmetric part of the derivative is positive definite over the box.
fn is_increasing(camera: &Pinhole, part: &Field) -> bool {
    let camera = camera.map(|number| Sloped::fixed(Interval::constant(number)));
    let [x, y] = part.intervals();
    let along_x = camera.distorted([Sloped::variable(x), Sloped::fixed(y)]);
    let along_y = camera.distorted([Sloped::fixed(x), Sloped::variable(y)]);
    let [xx, yx] = along_x.map(|bent| bent.slope);
    let [xy, yy] = along_y.map(|bent| bent.slope);
    let across = (xy + yx).squared();
    xx.least > 0.0 && yy.least > 0.0 && 4.0 * xx.least * yy.least > across.most
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field() -> Field {
        Field::around([[-0.6, -0.5], [0.6, 0.5]])
    }

    #[test]
    fn lens_that_folds_within_the_field_is_refused_and_beyond_it_is_not() {
        let mut camera = Pinhole::ideal(1000.0, [0.0, 0.0]);
        // r + k1 r³ has its maximum at r = 1/√(-3 k1); the corner is at 0.781.
        camera.radial[0] = -1.0 / (3.0 * 0.85 * 0.85);
        assert_eq!(show(&camera, &field()), Ok(()));
        camera.radial[0] = -1.0 / (3.0 * 0.75 * 0.75);
        assert!(matches!(show(&camera, &field()), Err(Fault::Fold(_))));
    }

    #[test]
    fn zero_of_the_denominator_is_found_however_narrow() {
        let mut camera = Pinhole::ideal(1000.0, [0.0, 0.0]);
        camera.divisor[0] = -1.0 / (0.6 * 0.6);
        assert!(matches!(
            show(&camera, &field()),
            Err(Fault::Pole(_) | Fault::Fold(_))
        ));
        camera.divisor[0] = f64::NAN;
        assert!(show(&camera, &field()).is_err());
    }

    #[test]
    fn numerator_and_denominator_that_nearly_cancel_are_decided() {
        let mut camera = Pinhole::ideal(1000.0, [0.0, 0.0]);
        camera.radial = [0.018, -0.076, 0.376, 0.0];
        camera.divisor = [0.060, -0.122, 0.408];
        camera.decentring = [-2.2e-4, 1.0e-4];
        assert_eq!(show(&camera, &field()), Ok(()));
    }
}
