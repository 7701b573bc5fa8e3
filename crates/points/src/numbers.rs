//! Numbers of points that are computed together.

use fmc_camera::geometry::evaluation_form::Displacement;
use fmc_camera::geometry::left_out_terms::LeftOut;
use fmc_camera::geometry::sensor::SensorPoint;

use crate::TOGETHER;
use crate::coordinate::Coordinate;
use crate::direction::Direction;

/// Numbers of points that are computed together, x and y apart.
pub(crate) struct Numbers {
    pub(crate) given: [[f32; TOGETHER]; 2],
    pub(crate) found: [[f32; TOGETHER]; 2],
    distortion: [[f32; TOGETHER]; 2],
}

impl Numbers {
    pub(crate) const fn new() -> Self {
        Self {
            given: [[0.0; TOGETHER]; 2],
            found: [[0.0; TOGETHER]; 2],
            distortion: [[0.0; TOGETHER]; 2],
        }
    }

    pub(crate) fn take<T: Coordinate>(&mut self, points: &[[T; 2]]) {
        let [xs, ys] = &mut self.given;
        for (([x, y], to_x), to_y) in points.iter().zip(xs).zip(ys) {
            (*to_x, *to_y) = (x.single(), y.single());
        }
    }

    pub(crate) fn slices(&mut self, count: usize) -> [[&mut [f32]; 2]; 3] {
        let Self {
            given,
            found,
            distortion,
        } = self;
        [given, found, distortion].map(|numbers| {
            numbers
                .each_mut()
                .map(|numbers| numbers.split_at_mut(count.min(TOGETHER)).0)
        })
    }

    /// Computes point by point.
    pub(crate) fn each(
        &mut self,
        count: usize,
        answer: impl Fn(SensorPoint) -> Option<(SensorPoint, Displacement)>,
    ) {
        let [[xs, ys], found, distortion] = self.slices(count);
        let given = xs.iter().zip(ys.iter());
        for ((x, y), place) in given.zip(places(found, distortion)) {
            put(place, answer(SensorPoint::new(*x, *y)));
        }
    }

    /// Computes the points whose x is NaN so far.
    pub(crate) fn each_left(
        &mut self,
        count: usize,
        answer: impl Fn(SensorPoint) -> Option<(SensorPoint, Displacement)>,
    ) {
        let [[xs, ys], found, distortion] = self.slices(count);
        let given = xs.iter().zip(ys.iter());
        for ((x, y), place) in given.zip(places(found, distortion)) {
            if place[0].is_nan() {
                put(place, answer(SensorPoint::new(*x, *y)));
            }
        }
    }

    /// Replaces points by their answers.
    pub(crate) fn answer<T: Coordinate>(
        &self,
        direction: Direction,
        left_out: &LeftOut,
        points: &mut [[T; 2]],
    ) {
        let Self {
            found: [xs, ys],
            distortion: [dxs, dys],
            ..
        } = self;
        let found = xs.iter().zip(ys).zip(dxs.iter().zip(dys));
        for (point, ((x, y), (dx, dy))) in points.iter_mut().zip(found) {
            let [given, found] = [
                SensorPoint::new(point[0].single(), point[1].single()),
                SensorPoint::new(*x, *y),
            ];
            let distortion = Displacement {
                dx_mm: *dx,
                dy_mm: *dy,
            };
            let left_out = direction.left_out(left_out, given, found);
            *point = direction.changed(*point, found, [distortion, left_out]);
        }
    }
}

/// Place of an answer: x, y, dx and dy.
type Place<'a> = [&'a mut f32; 4];

fn places<'a>(
    [xs, ys]: [&'a mut [f32]; 2],
    [dxs, dys]: [&'a mut [f32]; 2],
) -> impl Iterator<Item = Place<'a>> {
    let points = xs.iter_mut().zip(ys);
    let both = points.zip(dxs.iter_mut().zip(dys));
    both.map(|((x, y), (dx, dy))| [x, y, dx, dy])
}

/// Puts an answer into its place; NaN where there is none.
fn put([x, y, dx, dy]: Place<'_>, answer: Option<(SensorPoint, Displacement)>) {
    let (point, distortion) = answer.unwrap_or((
        SensorPoint::new(f32::NAN, f32::NAN),
        Displacement {
            dx_mm: f32::NAN,
            dy_mm: f32::NAN,
        },
    ));
    (*x, *y) = (point.x_mm, point.y_mm);
    (*dx, *dy) = (distortion.dx_mm, distortion.dy_mm);
}
