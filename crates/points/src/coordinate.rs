//! Coordinates in single and in double precision.

use fmc_camera_file::number::single;

use crate::slices::{Answers, Points, PointsMut};

/// A coordinate of a point, mm.
pub trait Coordinate: Copy + Send + Sync + 'static {
    /// A coordinate that a point does not have.
    const NAN: Self;

    /// Returns the coordinate in the camera's precision.
    fn single(self) -> f32;

    /// Returns the coordinate in double precision.
    fn double(self) -> f64;

    /// Returns a coordinate that was computed in double precision.
    fn rounded(value: f64) -> Self;

    /// Returns the answer to this coordinate: `found` as the camera computes it, which is this one
    /// plus the first of the `changes`. The second is what the camera leaves out of it.
    ///
    /// # Accuracy
    /// In single precision it is `found`. In double precision the coordinate keeps its digits: the
    /// changes, computed in single precision, are added to it.
    #[must_use]
    fn changed(self, found: f32, changes: [f32; 2]) -> Self;

    /// Returns points that are read.
    fn points(points: &[[Self; 2]]) -> Points<'_>;

    /// Returns points that are replaced.
    fn points_mut(points: &mut [[Self; 2]]) -> PointsMut<'_>;

    /// Returns points with the places of their answers.
    fn answers<'a>(of: &'a [[Self; 2]], to: &'a mut [[Self; 2]]) -> Answers<'a>;

    /// Returns points as those of single precision, if they are.
    fn singles(points: &[[Self; 2]]) -> Option<&[[f32; 2]]> {
        match Self::points(points) {
            Points::Single(points) => Some(points),
            Points::Double(_) => None,
        }
    }

    /// Returns points as those of single precision, if they are, to be replaced.
    fn singles_mut(points: &mut [[Self; 2]]) -> Option<&mut [[f32; 2]]> {
        match Self::points_mut(points) {
            PointsMut::Single(points) => Some(points),
            PointsMut::Double(_) => None,
        }
    }
}

impl Coordinate for f32 {
    const NAN: Self = f32::NAN;

    fn single(self) -> f32 {
        self
    }

    fn double(self) -> f64 {
        f64::from(self)
    }

    fn rounded(value: f64) -> Self {
        single(value)
    }

    fn changed(self, found: f32, _changes: [f32; 2]) -> Self {
        found
    }

    fn points(points: &[[Self; 2]]) -> Points<'_> {
        Points::Single(points)
    }

    fn points_mut(points: &mut [[Self; 2]]) -> PointsMut<'_> {
        PointsMut::Single(points)
    }

    fn answers<'a>(of: &'a [[Self; 2]], to: &'a mut [[Self; 2]]) -> Answers<'a> {
        Answers::Single { of, to }
    }
}

impl Coordinate for f64 {
    const NAN: Self = f64::NAN;

    fn single(self) -> f32 {
        single(self)
    }

    fn double(self) -> f64 {
        self
    }

    fn rounded(value: f64) -> Self {
        value
    }

    fn changed(self, _found: f32, changes: [f32; 2]) -> Self {
        let [change, left_out] = changes.map(f64::from);
        self + (change + left_out)
    }

    fn points(points: &[[Self; 2]]) -> Points<'_> {
        Points::Double(points)
    }

    fn points_mut(points: &mut [[Self; 2]]) -> PointsMut<'_> {
        PointsMut::Double(points)
    }

    fn answers<'a>(of: &'a [[Self; 2]], to: &'a mut [[Self; 2]]) -> Answers<'a> {
        Answers::Double { of, to }
    }
}
