//! Coordinates in single and in double precision.

use fmc_camera_file::number::single;

/// A coordinate of a point, mm.
pub(crate) trait Coordinate: Copy + Send + Sync + 'static {
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
    fn changed(self, found: f32, changes: [f32; 2]) -> Self;

    /// Returns points as those of single precision, if they are.
    fn singles(points: &[[Self; 2]]) -> Option<&[[f32; 2]]>;

    /// Returns points as those of single precision, if they are, to be replaced.
    fn singles_mut(points: &mut [[Self; 2]]) -> Option<&mut [[f32; 2]]>;
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

    fn singles(points: &[[Self; 2]]) -> Option<&[[f32; 2]]> {
        Some(points)
    }

    fn singles_mut(points: &mut [[Self; 2]]) -> Option<&mut [[f32; 2]]> {
        Some(points)
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

    fn singles(_: &[[Self; 2]]) -> Option<&[[f32; 2]]> {
        None
    }

    fn singles_mut(_: &mut [[Self; 2]]) -> Option<&mut [[f32; 2]]> {
        None
    }
}
