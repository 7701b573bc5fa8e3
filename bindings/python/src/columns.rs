//! Points whose coordinates lie in columns of their own, as tables of Arrow have them.

use numpy::{Element, IntoPyArray, PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::answer::Answer;
use crate::coordinate::Coordinate;
use crate::correction_kernel::{Direction, Numbers, TOGETHER};
use crate::error;
use crate::frames::Frames;
use crate::index::repeated;
use crate::off_sensor::OffSensor;

/// Reason why a point has no answer, or that it has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Flag {
    Answered = 0,
    /// Off the sensor, or without a measured point on it.
    OffSensor = 1,
    /// The frames have no such frame.
    NoFrame = 2,
    /// The trigger was refused.
    Refused = 3,
}

/// Points of a table, and what is asked of them.
pub(crate) struct ColumnPoints<'a> {
    pub(crate) frames: &'a Frames,
    pub(crate) direction: Direction,
    pub(crate) answer: Answer,
}

impl ColumnPoints<'_> {
    /// Returns x, y and flags of the answers. `places` are those of the frames; one that is none is
    /// no frame.
    ///
    /// # Errors
    /// `fmc_camera.Layout` for columns of other types or of different lengths.
    pub(crate) fn answered<'py>(
        &self,
        [x, y]: [&Bound<'py, PyAny>; 2],
        places: &[i64],
    ) -> PyResult<Bound<'py, PyAny>> {
        if let (Ok(x), Ok(y)) = (x.cast::<PyArray1<f32>>(), y.cast::<PyArray1<f32>>()) {
            return self.typed([x, y], places);
        }
        if let (Ok(x), Ok(y)) = (x.cast::<PyArray1<f64>>(), y.cast::<PyArray1<f64>>()) {
            return self.typed([x, y], places);
        }
        Err(error::of_layout(
            "points",
            "both columns must be float32, or both float64",
        ))
    }

    fn typed<'py, T: Coordinate + Element>(
        &self,
        columns: [&Bound<'py, PyArray1<T>>; 2],
        places: &[i64],
    ) -> PyResult<Bound<'py, PyAny>> {
        let [x, y] = columns;
        let borrowed = |column: &Bound<'py, PyArray1<T>>| {
            column
                .try_readonly()
                .map_err(|_| error::of_layout("points", "in use by another call"))
        };
        let (x, y): (PyReadonlyArray1<'_, T>, PyReadonlyArray1<'_, T>) =
            (borrowed(x)?, borrowed(y)?);
        let contiguous = |_| error::of_layout("points", "not contiguous");
        let xs = x.as_slice().map_err(contiguous)?;
        let ys = y.as_slice().map_err(contiguous)?;
        if xs.len() != places.len() || ys.len() != places.len() {
            return Err(error::of_layout("points", "columns of different lengths"));
        }
        let py = columns[0].py();
        let (x, y, flags) = py.detach(|| self.compute([xs, ys], places))?;
        (
            x.into_pyarray(py),
            y.into_pyarray(py),
            flags.into_pyarray(py),
        )
            .into_bound_py_any(py)
    }

    fn compute<T: Coordinate>(
        &self,
        [xs, ys]: [&[T]; 2],
        places: &[i64],
    ) -> PyResult<(Vec<T>, Vec<T>, Vec<u8>)> {
        let count = places.len();
        let mut numbers = Numbers::new();
        let mut answers = Answers {
            x: Vec::with_capacity(count),
            y: Vec::with_capacity(count),
            flags: Vec::with_capacity(count),
        };
        let mut start = 0;
        while let Some(number) = places.get(start).copied() {
            let run = start..start + repeated(number, places.get(start..).unwrap_or_default());
            start = run.end;
            let place = usize::try_from(number).ok();
            let row = place.and_then(|place| Some((place, self.frames.table.rows().get(place)?)));
            let Some((place, row)) = row else {
                answers.lack(run.len(), Flag::NoFrame);
                continue;
            };
            let Some(frame) = self.frames.in_use(place) else {
                answers.lack(run.len(), Flag::Refused);
                continue;
            };
            if self.answer == Answer::MeasuredShifted && !frame.has_shifted_points() {
                return Err(error::of_printed_sign(row.sequence));
            }
            let given = [xs, ys].map(|column| column.get(run.clone()).unwrap_or_default());
            let [xs, ys] = given;
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
        let Answers { x, y, flags } = answers;
        Ok((x, y, flags))
    }
}

/// Answers, column by column.
struct Answers<T> {
    x: Vec<T>,
    y: Vec<T>,
    flags: Vec<u8>,
}

impl<T: Coordinate> Answers<T> {
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
