//! Points of one frame.

use fmc_points::{Answers, FramePoints, Points, PointsMut};
use pyo3::prelude::*;

use crate::array::Work;
use crate::error;

impl Work for FramePoints<'_> {
    fn check(&self, points: Points<'_>) -> PyResult<()> {
        FramePoints::check(self, points).map_err(error::of_points)
    }

    fn replace(&self, _from: usize, points: PointsMut<'_>) {
        FramePoints::replace(self, points);
    }

    fn write(&self, _from: usize, answers: Answers<'_>) {
        FramePoints::write(self, answers);
    }
}
