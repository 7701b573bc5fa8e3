//! Proof that a formula of rays is one-to-one over a field, by intervals and subdivision.

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
struct Rectangle {
    least: [f64; 2],
    most: [f64; 2],
}

impl Rectangle {
    fn point(at: [f64; 2]) -> Self {
        Self {
            least: at,
            most: at,
        }
    }

    fn middle(&self) -> [f64; 2] {
        let ([left, low], [right, high]) = (self.least, self.most);
        [0.5 * (left + right), 0.5 * (low + high)]
    }

    fn corners(&self) -> [[f64; 2]; 4] {
        let ([left, low], [right, high]) = (self.least, self.most);
        [[left, low], [right, low], [right, high], [left, high]]
    }

    /// Returns `count` x `count` parts.
    fn parts(&self, count: u32) -> impl Iterator<Item = Self> {
        let ([left, low], [right, high]) = (self.least, self.most);
        let edge = move |least: f64, most: f64, index: u32| {
            least + (most - least) * f64::from(index) / f64::from(count)
        };
        (0..count * count).map(move |cell| {
            let (row, column) = (cell / count, cell % count);
            Self {
                least: [edge(left, right, column), edge(low, high, row)],
                most: [edge(left, right, column + 1), edge(low, high, row + 1)],
            }
        })
    }

    fn intervals(&self) -> [Interval; 2] {
        let ([left, low], [right, high]) = (self.least, self.most);
        [Interval::new(left, right), Interval::new(low, high)]
    }
}

/// The smallest convex field that holds given rays.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    bounds: Rectangle,
    /// Corners, anticlockwise.
    hull: Vec<[f64; 2]>,
}

impl Field {
    /// Returns the convex hull of the rays.
    pub(crate) fn around(rays: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut rays: Vec<_> = rays.into_iter().collect();
        rays.sort_by(|[ax, ay], [bx, by]| ax.total_cmp(bx).then(ay.total_cmp(by)));
        let hull = [half_hull(rays.iter()), half_hull(rays.iter().rev())].concat();
        let nothing = Rectangle {
            least: [f64::INFINITY; 2],
            most: [f64::NEG_INFINITY; 2],
        };
        let bounds = hull.iter().fold(nothing, |bounds, [x, y]| {
            let ([left, low], [right, high]) = (bounds.least, bounds.most);
            Rectangle {
                least: [left.min(*x), low.min(*y)],
                most: [right.max(*x), high.max(*y)],
            }
        });
        Self { bounds, hull }
    }

    /// Returns `true` if an edge of the hull has the rectangle on its outer side.
    fn excludes(&self, rectangle: &Rectangle) -> bool {
        let ends = self.hull.iter().zip(self.hull.iter().cycle().skip(1));
        ends.into_iter().any(|(from, to)| {
            let corners = rectangle.corners();
            corners.iter().all(|corner| turn(from, to, corner) < 0.0)
        })
    }
}

/// Returns the lower half of the hull of points that are sorted, without its last point.
fn half_hull<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Vec<[f64; 2]> {
    let mut hull: Vec<[f64; 2]> = Vec::new();
    for point in points {
        while let [.., before, last] = hull.as_slice()
            && turn(before, last, point) <= 0.0
        {
            hull.pop();
        }
        hull.push(*point);
    }
    hull.pop();
    hull
}

/// Returns a number that is positive if the third point is to the left of the way from the first to
/// the second.
fn turn([ax, ay]: &[f64; 2], [bx, by]: &[f64; 2], [x, y]: &[f64; 2]) -> f64 {
    (bx - ax) * (y - ay) - (by - ay) * (x - ax)
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
    let mut boxes: Vec<Rectangle> = field.bounds.parts(BOXES).collect();
    let mut examined = 0;
    while let Some(part) = boxes.pop() {
        if field.excludes(&part) {
            continue;
        }
        examined += 1;
        let middle = part.middle();
        // The middle alone is a box, too: its bounds are exact.
        let point = Rectangle::point(middle);
        if !field.excludes(&point) {
            if !is_positive(camera, &point) {
                return Err(Fault::Pole(middle));
            }
            if !is_increasing(camera, &point) {
                return Err(Fault::Fold(middle));
            }
        }
        if is_positive(camera, &part) && is_increasing(camera, &part) {
            continue;
        }
        if examined > MAX_BOXES {
            return Err(Fault::Undecided(middle));
        }
        boxes.extend(part.parts(2));
    }
    Ok(())
}

/// Returns `true` if the denominator is positive over the box.
fn is_positive(camera: &Pinhole, part: &Rectangle) -> bool {
    divisor(camera, part).least > 0.0
}

/// Returns bounds of the denominator over a box.
fn divisor(camera: &Pinhole, part: &Rectangle) -> Interval {
    let [x, y] = part.intervals();
    let [offset_x, offset_y] = camera.offset.map(Interval::constant);
    let r2 = (x - offset_x).squared() + (y - offset_y).squared();
    camera.map(Interval::constant).denominator(r2)
}

/// Returns `true` if the symmetric part of the derivative is positive definite over the box.
fn is_increasing(camera: &Pinhole, part: &Rectangle) -> bool {
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
        Field::around([
            [-0.6, -0.5],
            [0.6, -0.5],
            [0.0, 0.0],
            [0.6, 0.5],
            [-0.6, 0.5],
        ])
    }

    #[test]
    fn field_is_the_hull_of_its_rays() {
        let field = field();
        assert_eq!(field.hull.len(), 4);
        for (x, y, is_outside) in [(0.0, 0.0, false), (0.59, 0.49, false), (0.61, 0.0, true)] {
            assert_eq!(field.excludes(&Rectangle::point([x, y])), is_outside, "{x}");
        }
        // A rectangle across the edge is neither outside nor left out.
        let across = Rectangle {
            least: [0.5, 0.4],
            most: [0.7, 0.6],
        };
        assert!(!field.excludes(&across));
    }

    #[test]
    fn fold_beyond_the_corner_that_the_field_does_not_have_is_allowed() {
        // The rays of an octagon: its bounding square has corners beyond the fold.
        let mut camera = Pinhole::ideal(1000.0, [0.0, 0.0]);
        camera.radial[0] = -1.0 / (3.0 * 0.7 * 0.7);
        let octagon = (0..8).map(|index| {
            let (sine, cosine) = (f64::from(index) * std::f64::consts::FRAC_PI_4).sin_cos();
            [0.6 * cosine, 0.6 * sine]
        });
        assert_eq!(show(&camera, &Field::around(octagon)), Ok(()));
        let square = [[-0.6, -0.6], [0.6, -0.6], [0.6, 0.6], [-0.6, 0.6]];
        assert!(matches!(
            show(&camera, &Field::around(square)),
            Err(Fault::Fold(_))
        ));
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
