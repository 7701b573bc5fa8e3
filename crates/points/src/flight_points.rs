//! Points of many frames.

use std::ops::Range;

use fmc_camera_kernel::host::{Run, Runs, STREAMED_FROM_BYTES};

use crate::answer::Answer;
use crate::coordinate::Coordinate;
use crate::direction::Direction;
use crate::flight::Flight;
use crate::frame_corrections;
use crate::frame_in_use::FrameInUse;
use crate::numbers::Numbers;
use crate::off_sensor::OffSensor;
use crate::point_error::PointError;
use crate::runs::repeated;
use crate::slices::{Answers, Points, PointsMut};

/// Correction or distortion of the points of many frames.
#[derive(Debug)]
pub struct FlightPoints<'a> {
    /// The frames.
    pub flight: Flight<'a>,
    /// Places of the frames.
    pub index: &'a [i64],
    /// Correction or distortion.
    pub direction: Direction,
    /// Coordinates of the answers, or of the points that are distorted.
    pub answer: Answer,
    /// Answer to points that are off the sensor.
    pub off_sensor: OffSensor,
    /// Points of a number of the index.
    pub each: usize,
}

impl FlightPoints<'_> {
    /// Returns the place of a frame by the number with that place in the index.
    fn place(&self, at: usize, number: i64) -> Result<usize, PointError> {
        let count = self.flight.table.rows().len();
        let place = usize::try_from(number).ok().filter(|place| *place < count);
        place.ok_or(PointError::NoPlace { at, number, count })
    }

    /// Checks the numbers of the index, and that their frames have the answer.
    fn check_index(&self) -> Result<(), PointError> {
        let mut at = 0;
        while let Some(number) = self.index.get(at).copied() {
            let place = self.place(at, number)?;
            if self.answer == Answer::MeasuredShifted
                && let Some(frame) = self.flight.in_use(place)
                && !frame.has_shifted_points()
            {
                let row = self.flight.table.rows().get(place);
                let sequence = row.map_or(0, |row| row.sequence);
                return Err(PointError::PrintedSign { sequence });
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
        let each = self.each.max(1);
        let mut start = from;
        std::iter::from_fn(move || {
            if start >= end {
                return None;
            }
            let at = start / each;
            let last = (end - 1) / each;
            let behind = self.index.get(at..=last).unwrap_or_default();
            let number = *behind.first()?;
            let next = end.min((at + repeated(number, behind)) * each);
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
            && self.flight.camera.is_polynomial()
    }

    fn kernel_runs(&self, from: usize, count: usize) -> impl Iterator<Item = Run> {
        self.runs(from, count)
            .map(|(place, run)| frame_corrections::run(self.flight.correction(place), run.len()))
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
    fn check_points<T: Coordinate>(&self, points: &[[T; 2]]) -> Result<(), PointError> {
        let mut numbers = Numbers::new();
        for (place, run) in self.runs(0, points.len()) {
            let start = run.start;
            let points = points.get(run).unwrap_or_default();
            let Some(frame) = self.flight.in_use(place) else {
                continue;
            };
            let found = match (self.direction, self.answer) {
                (Direction::Correct, _) => {
                    points.iter().position(|point| frame.is_off_sensor(*point))
                }
                (Direction::Distort, answer) => {
                    let mut measured = points.to_vec();
                    let off = OffSensor::Nan;
                    frame.replace(&mut numbers, self.direction, answer, off, &mut measured);
                    let pairs = measured.iter().zip(points);
                    let lacks = |[x, y]: [T; 2]| x.single().is_nan() || y.single().is_nan();
                    let mut lack = pairs.map(|(found, given)| lacks(*found) && !lacks(*given));
                    lack.position(|lacks| lacks)
                }
            };
            if let Some((index, point)) =
                found.and_then(|place| Some((start + place, points.get(place)?)))
            {
                let point_mm = point.map(T::double);
                return Err(PointError::of(self.direction, index, point_mm));
            }
        }
        Ok(())
    }

    fn check_of<T: Coordinate>(&self, points: &[[T; 2]]) -> Result<(), PointError> {
        self.check_index()?;
        if self.off_sensor == OffSensor::Error {
            self.check_points(points)?;
        }
        Ok(())
    }

    fn replace_of<T: Coordinate>(&self, from: usize, points: &mut [[T; 2]]) {
        let mut runs = self.kernel_runs(from, points.len());
        if self.is_of_kernel()
            && let Some(points) = T::singles_mut(points)
        {
            Runs::new().pairs(&mut runs, points);
            return;
        }
        let mut numbers = Numbers::new();
        for (place, run) in self.runs(from, points.len()) {
            let frame = self.flight.in_use(place);
            let points = points.get_mut(run).unwrap_or_default();
            self.replace_run(&mut numbers, frame.as_ref(), points);
        }
    }

    fn write_of<T: Coordinate>(&self, from: usize, points: &[[T; 2]], answers: &mut [[T; 2]]) {
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
            return;
        }
        let mut numbers = Numbers::new();
        for (place, run) in self.runs(from, points.len()) {
            let points = points.get(run.clone()).unwrap_or_default();
            let answers = answers.get_mut(run).unwrap_or_default();
            let frame = self.flight.in_use(place);
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
    }
}

/// Functions of arrays. The index has one number for each [`each`](Self::each) points of the array.
impl FlightPoints<'_> {
    /// Checks the numbers of the index, that their frames have the answer, and that points have
    /// answers where those that have none are an error.
    ///
    /// # Errors
    /// [`PointError`] of the first number or point.
    #[inline(never)]
    pub fn check(&self, points: Points<'_>) -> Result<(), PointError> {
        match points {
            Points::Single(points) => self.check_of(points),
            Points::Double(points) => self.check_of(points),
        }
    }

    /// Replaces points that have been checked by their answers; the first is that with the number
    /// `from` in the array.
    #[inline(never)]
    pub fn replace(&self, from: usize, points: PointsMut<'_>) {
        match points {
            PointsMut::Single(points) => self.replace_of(from, points),
            PointsMut::Double(points) => self.replace_of(from, points),
        }
    }

    /// Writes the answers to points that have been checked, of which the first is that with the
    /// number `from` in the array.
    #[inline(never)]
    pub fn write(&self, from: usize, answers: Answers<'_>) {
        match answers {
            Answers::Single { of, to } => self.write_of(from, of, to),
            Answers::Double { of, to } => self.write_of(from, of, to),
        }
    }
}
