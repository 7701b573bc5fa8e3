//! Points of many frames.

use fmc_points::{Answers, FlightPoints, Points, PointsMut};
use pyo3::prelude::*;

use crate::array::{self, Work};
use crate::error;

impl Work for FlightPoints<'_> {
    fn check_shape(&mut self, shape: &[usize]) -> PyResult<()> {
        let (rows, each) = match *shape {
            [rows, 2] => (rows, 1),
            [rows, each, 2] => (rows, each),
            _ => return Err(array::of_shape(shape, "(N, 2), or (frames, N, 2)")),
        };
        if self.index.len() != rows {
            let fault = format!("{} numbers for {rows} rows of points", self.index.len());
            return Err(error::of_layout("index", &fault));
        }
        self.each = each;
        Ok(())
    }

    fn check(&self, points: Points<'_>) -> PyResult<()> {
        FlightPoints::check(self, points).map_err(error::of_points)
    }

    fn replace(&self, from: usize, points: PointsMut<'_>) {
        FlightPoints::replace(self, from, points);
    }

    fn write(&self, from: usize, answers: Answers<'_>) {
        FlightPoints::write(self, from, answers);
    }
}
