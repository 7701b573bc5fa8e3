//! Points of many frames.

use std::ops::Range;

use fmc_camera_kernel::host::{Run, Runs, STREAMED_FROM_BYTES};
use pyo3::prelude::*;

use crate::answer::Answer;
use crate::array::{self, Work};
use crate::coordinate::Coordinate;
use crate::correction_kernel::{Direction, Numbers};
use crate::error;
use crate::frame_corrections;
use crate::frame_in_use::FrameInUse;
use crate::frames::Frames;
use crate::index::repeated;
use crate::off_sensor::OffSensor;

/// Correction or distortion of the points of many frames.
pub(crate) struct FlightPoints<'a> {
    pub(crate) frames: &'a Frames,
    /// Places of the frames.
    pub(crate) index: &'a [i64],
    pub(crate) direction: Direction,
    pub(crate) answer: Answer,
    pub(crate) off_sensor: OffSensor,
    /// Points of a number of the index.
    pub(crate) each: usize,
}

impl FlightPoints<'_> {
    /// Returns the place of a frame by the number with that place in the index.
    fn place(&self, at: usize, number: i64) -> PyResult<usize> {
        let count = self.frames.table.rows().len();
        let place = usize::try_from(number).ok().filter(|place| *place < count);
        place.ok_or_else(|| error::of_index(at, number, count))
    }

    /// Checks the numbers of the index, and that their frames have the answer.
    fn check_index(&self) -> PyResult<()> {
        let mut at = 0;
        while let Some(number) = self.index.get(at).copied() {
            let place = self.place(at, number)?;
            if self.answer == Answer::MeasuredShifted
                && let Some(frame) = self.frames.in_use(place)
                && !frame.has_shifted_points()
            {
                let row = self.frames.table.rows().get(place);
                return Err(error::of_printed_sign(row.map_or(0, |row| row.sequence)));
            }
            at += repeated(number, self.index.get(at..).unwrap_or_default());
        }
        Ok(())
    }

    /// Returns the places of the frames whose points follow each other, with the range that these
    /// have among `count` points, of which the first is that with the number `from`. The index has
    /// been checked.
    fn runs(&self, from: usize, count: usize) -> impl Iterator<Item = (usize, Range<usize>)> {
        let end = from + count;
        let mut start = from;
        std::iter::from_fn(move || {
            if start >= end {
                return None;
            }
            let at = start / self.each;
            let last = (end - 1) / self.each;
            let behind = self.index.get(at..=last).unwrap_or_default();
            let number = *behind.first()?;
            let next = end.min((at + repeated(number, behind)) * self.each);
            let run = start - from..next - from;
            start = next;
            Some((usize::try_from(number).unwrap_or(usize::MAX), run))
        })
    }

    /// Returns true if the correction of a point is all that is asked.
    fn is_plain(&self) -> bool {
        self.answer == Answer::Ideal
            && (self.direction == Direction::Distort || self.off_sensor != OffSensor::Nan)
    }

    /// Returns true if the kernel takes the points of all frames together.
    fn is_of_kernel(&self) -> bool {
        self.is_plain()
            && self.direction == Direction::Correct
            && self.frames.camera.is_polynomial()
    }

    fn kernel_runs(&self, from: usize, count: usize) -> impl Iterator<Item = Run> {
        self.runs(from, count)
            .map(|(place, run)| frame_corrections::run(self.frames.correction(place), run.len()))
    }

    fn replace_run<T: Coordinate>(
        &self,
        numbers: &mut Numbers,
        frame: Option<&FrameInUse<'_>>,
        points: &mut [[T; 2]],
    ) {
        match frame {
            None => points.fill([T::NAN; 2]),
            Some(frame) => {
                frame.replace(
                    numbers,
                    self.direction,
                    self.answer,
                    self.off_sensor,
                    points,
                );
            }
        }
    }

    /// Checks that points have answers on the sensor.
    fn check_points<T: Coordinate>(&self, points: &[[T; 2]]) -> PyResult<()> {
        let mut numbers = Numbers::new();
        for (place, run) in self.runs(0, points.len()) {
            let start = run.start;
            let points = points.get(run).unwrap_or_default();
            let Some(frame) = self.frames.in_use(place) else {
                continue;
            };
            let (found, fault) = match (self.direction, self.answer) {
                (Direction::Correct, _) => (
                    points.iter().position(|point| frame.is_off_sensor(*point)),
                    "off the sensor",
                ),
                (Direction::Distort, answer) => {
                    let mut measured = points.to_vec();
                    let off = OffSensor::Nan;
                    frame.replace(&mut numbers, self.direction, answer, off, &mut measured);
                    let pairs = measured.iter().zip(points);
                    let lacks = |[x, y]: [T; 2]| x.single().is_nan() || y.single().is_nan();
                    let mut lack = pairs.map(|(found, given)| lacks(*found) && !lacks(*given));
                    (
                        lack.position(|lacks| lacks),
                        "no measured point on the sensor belongs to it",
                    )
                }
            };
            if let Some((index, point)) =
                found.and_then(|place| Some((start + place, points.get(place)?)))
            {
                return Err(error::of_point(index, point.map(T::double), fault));
            }
        }
        Ok(())
    }
}

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

    fn check<T: Coordinate>(&self, points: &[[T; 2]]) -> PyResult<()> {
        self.check_index()?;
        if self.off_sensor == OffSensor::Error {
            self.check_points(points)?;
        }
        Ok(())
    }

    fn replace<T: Coordinate>(&self, from: usize, points: &mut [[T; 2]]) -> PyResult<()> {
        let mut runs = self.kernel_runs(from, points.len());
        if self.is_of_kernel()
            && let Some(points) = T::singles_mut(points)
        {
            Runs::new().pairs(&mut runs, points);
            return Ok(());
        }
        let mut numbers = Numbers::new();
        for (place, run) in self.runs(from, points.len()) {
            let frame = self.frames.in_use(place);
            let points = points.get_mut(run).unwrap_or_default();
            self.replace_run(&mut numbers, frame.as_ref(), points);
        }
        Ok(())
    }

    fn write<T: Coordinate>(
        &self,
        from: usize,
        points: &[[T; 2]],
        answers: &mut [[T; 2]],
    ) -> PyResult<()> {
        // All points of a call together do not fit the caches, or do.
        let bytes = self
            .index
            .len()
            .saturating_mul(self.each)
            .saturating_mul(size_of::<[T; 2]>());
        let streamed_from = if bytes >= STREAMED_FROM_BYTES {
            0
        } else {
            usize::MAX
        };
        let mut runs = self.kernel_runs(from, points.len());
        if self.is_of_kernel()
            && let (Some(points), Some(answers)) = (T::singles(points), T::singles_mut(answers))
        {
            let kernel = Runs::new().streamed_from(streamed_from);
            kernel.pairs_into(&mut runs, points, answers);
            return Ok(());
        }
        let mut numbers = Numbers::new();
        for (place, run) in self.runs(from, points.len()) {
            let points = points.get(run.clone()).unwrap_or_default();
            let answers = answers.get_mut(run).unwrap_or_default();
            let frame = self.frames.in_use(place);
            match frame {
                Some(frame) if self.is_plain() => {
                    frame.write(&mut numbers, self.direction, points, answers);
                }
                _ => {
                    answers.copy_from_slice(points);
                    self.replace_run(&mut numbers, frame.as_ref(), answers);
                }
            }
        }
        Ok(())
    }
}
