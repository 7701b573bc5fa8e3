//! Points whose coordinates lie in columns of their own, as tables have them.

use crate::TOGETHER;
use crate::answer::Answer;
use crate::coordinate::Coordinate;
use crate::direction::Direction;
use crate::flight::Flight;
use crate::numbers::Numbers;
use crate::off_sensor::OffSensor;
use crate::point_error::PointError;
use crate::runs::repeated;

/// Reason why a point has no answer, or that it has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flag {
    /// It has one.
    Answered = 0,
    /// Off the sensor, or without a measured point on it.
    OffSensor = 1,
    /// There is no such frame.
    NoFrame = 2,
    /// The trigger was refused.
    Refused = 3,
}

/// Answers, column by column, with the number of a [`Flag`] for each.
#[derive(Debug, Clone, PartialEq)]
pub struct FlaggedColumns<T> {
    /// x of the answers.
    pub x: Vec<T>,
    /// y of the answers.
    pub y: Vec<T>,
    /// Numbers of the flags.
    pub flags: Vec<u8>,
}

/// Points of a table, and what is asked of them.
#[derive(Debug, Clone, Copy)]
pub struct ColumnPoints<'a> {
    /// The frames.
    pub flight: Flight<'a>,
    /// Correction or distortion.
    pub direction: Direction,
    /// Coordinates of the answers, or of the points that are distorted.
    pub answer: Answer,
}

impl ColumnPoints<'_> {
    /// Returns the answers to points in single precision; `places` are those of their frames, and
    /// one that is none is no frame. A point beyond the end of a column is NaN.
    ///
    /// # Errors
    /// [`PointError::PrintedSign`].
    #[inline(never)]
    pub fn singles(
        &self,
        columns: [&[f32]; 2],
        places: &[i64],
    ) -> Result<FlaggedColumns<f32>, PointError> {
        self.answers(columns, places)
    }

    /// Does the same as [`Self::singles`] in double precision.
    ///
    /// # Errors
    /// [`PointError::PrintedSign`].
    #[inline(never)]
    pub fn doubles(
        &self,
        columns: [&[f64]; 2],
        places: &[i64],
    ) -> Result<FlaggedColumns<f64>, PointError> {
        self.answers(columns, places)
    }

    fn answers<T: Coordinate>(
        &self,
        [xs, ys]: [&[T]; 2],
        places: &[i64],
    ) -> Result<FlaggedColumns<T>, PointError> {
        let count = places.len();
        let mut numbers = Numbers::new();
        let mut answers = FlaggedColumns {
            x: Vec::with_capacity(count),
            y: Vec::with_capacity(count),
            flags: Vec::with_capacity(count),
        };
        let mut start = 0;
        while let Some(number) = places.get(start).copied() {
            let run = start..start + repeated(number, places.get(start..).unwrap_or_default());
            start = run.end;
            let place = usize::try_from(number).ok();
            let row = place.and_then(|place| Some((place, self.flight.table.rows().get(place)?)));
            let Some((place, row)) = row else {
                answers.lack(run.len(), Flag::NoFrame);
                continue;
            };
            let Some(frame) = self.flight.in_use(place) else {
                answers.lack(run.len(), Flag::Refused);
                continue;
            };
            if self.answer == Answer::MeasuredShifted && !frame.has_shifted_points() {
                let sequence = row.sequence;
                return Err(PointError::PrintedSign { sequence });
            }
            let [xs, ys] = [xs, ys].map(|column| column.get(run.clone()).unwrap_or_default());
            let parts = xs.chunks(TOGETHER).zip(ys.chunks(TOGETHER));
            for (xs, ys) in parts {
                let mut points = [[T::NAN; 2]; TOGETHER];
                let points = points.split_at_mut(xs.len()).0;
                for ((x, y), point) in xs.iter().zip(ys).zip(points.iter_mut()) {
                    *point = [*x, *y];
                }
                frame.replace(
                    &mut numbers,
                    self.direction,
                    self.answer,
                    OffSensor::Nan,
                    points,
                );
                answers.take([xs, ys], points);
            }
        }
        Ok(answers)
    }
}

impl<T: Coordinate> FlaggedColumns<T> {
    fn lack(&mut self, count: usize, flag: Flag) {
        let length = self.flags.len() + count;
        self.x.resize(length, T::NAN);
        self.y.resize(length, T::NAN);
        self.flags.resize(length, flag as u8);
    }

    fn take(&mut self, [xs, ys]: [&[T]; 2], answers: &[[T; 2]]) {
        self.x.extend(answers.iter().map(|[x, _]| *x));
        self.y.extend(answers.iter().map(|[_, y]| *y));
        let is_nan = |x: T, y: T| x.single().is_nan() | y.single().is_nan();
        let given = xs.iter().zip(ys);
        self.flags
            .extend(given.zip(answers).map(|((x, y), [to_x, to_y])| {
                let is_lost = is_nan(*to_x, *to_y) & !is_nan(*x, *y);
                if is_lost {
                    Flag::OffSensor as u8
                } else {
                    Flag::Answered as u8
                }
            }));
    }
}
