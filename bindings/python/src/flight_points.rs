//! Points of many frames.

use std::ops::Range;

use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_kernel::host::STREAMED_FROM_BYTES;
use fmc_frames::{FrameTable, PlacedFrame};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::answer::Answer;
use crate::array::{self, Work};
use crate::camera::CameraParts;
use crate::coordinate::Coordinate;
use crate::correction_kernel::{CorrectionKernel, Direction, TOGETHER};
use crate::error;
use crate::off_sensor::OffSensor;

/// Corrections that are kept: those of the frames that points in any order name again.
const KEPT: usize = 1024;

/// Whole numbers of an argument, one for each point or for each row of points.
#[derive(Debug)]
pub(crate) struct Index<'py>(PyReadonlyArray1<'py, i64>);

impl<'py> Index<'py> {
    /// Reads an array of whole numbers; `argument` is its name.
    ///
    /// # Errors
    /// `fmc_camera.Layout` for other numbers or another shape.
    pub(crate) fn of(given: &Bound<'py, PyAny>, argument: &'static str) -> PyResult<Self> {
        if given.is_exact_instance_of::<PyUntypedArray>()
            && let Ok(array) = given.cast::<PyArray1<i64>>()
            && array.is_c_contiguous()
        {
            return Self::borrowed(array, argument);
        }
        if given.hasattr("mask")? {
            return Err(error::of_layout(argument, "a masked array"));
        }
        let numpy = given.py().import("numpy")?;
        let array = numpy.call_method1("asarray", (given,))?;
        let array = array.cast::<PyUntypedArray>()?;
        let kind: char = array.dtype().getattr("kind")?.extract()?;
        if array.ndim() != 1 || !matches!(kind, 'i' | 'u') && array.len() > 0 {
            let fault = format!(
                "{} dimensions of the type {}: must be one, of whole numbers",
                array.ndim(),
                array.dtype()
            );
            return Err(error::of_layout(argument, &fault));
        }
        let array = numpy.call_method1("ascontiguousarray", (array, "int64"))?;
        Self::borrowed(array.cast()?, argument)
    }

    fn borrowed(array: &Bound<'py, PyArray1<i64>>, argument: &'static str) -> PyResult<Self> {
        array
            .try_readonly()
            .map(Self)
            .map_err(|_| error::of_layout(argument, "in use by another call"))
    }

    pub(crate) fn numbers(&self) -> &[i64] {
        self.0.as_slice().unwrap_or_default()
    }
}

/// Correction or distortion of the points of many frames.
pub(crate) struct FlightPoints<'a> {
    pub(crate) camera: &'a CameraParts,
    pub(crate) table: &'a FrameTable,
    /// Places of the frames.
    pub(crate) index: &'a [i64],
    pub(crate) direction: Direction,
    pub(crate) answer: Answer,
    pub(crate) off_sensor: OffSensor,
    /// Points of a number of the index.
    pub(crate) each: usize,
}

/// A frame whose points are being answered.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameInUse<'a> {
    placed: PlacedFrame<'a>,
    kernel: CorrectionKernel<'a>,
}

impl<'a> FrameInUse<'a> {
    /// Returns the frame of a place; `None` for a refused trigger.
    pub(crate) fn new(camera: &'a CameraParts, table: &FrameTable, place: usize) -> Option<Self> {
        let placed = PlacedFrame::new(
            table.rows().get(place)?,
            camera.camera.calibration(),
            camera.grids(),
            camera.file.principal_point_mm,
        )?;
        Some(Self {
            kernel: CorrectionKernel::new(placed.correction),
            placed,
        })
    }

    /// Returns true if measured points can be referred to the calibration.
    pub(crate) fn has_shifted_points(&self) -> bool {
        self.placed.has_shifted_points()
    }

    fn is_off_sensor<T: Coordinate>(&self, [x, y]: [T; 2]) -> bool {
        let point = SensorPoint::new(x.single(), y.single());
        !point.x_mm.is_nan() && !point.y_mm.is_nan() && !self.kernel.sensor().contains(point)
    }

    /// Replaces points by their answers.
    pub(crate) fn replace<T: Coordinate>(
        &self,
        direction: Direction,
        answer: Answer,
        off_sensor: OffSensor,
        points: &mut [[T; 2]],
    ) {
        let is_marked = off_sensor == OffSensor::Nan && direction == Direction::Correct;
        if answer == Answer::Ideal && !is_marked {
            return self.kernel.replace(direction, points);
        }
        for points in points.chunks_mut(TOGETHER) {
            self.replace_part(direction, answer, is_marked, points);
        }
    }

    fn replace_part<T: Coordinate>(
        &self,
        direction: Direction,
        answer: Answer,
        is_marked: bool,
        points: &mut [[T; 2]],
    ) {
        let mut off = [false; TOGETHER];
        if is_marked {
            for (off, point) in off.iter_mut().zip(points.iter()) {
                *off = self.is_off_sensor(*point);
            }
        }
        let placed = &self.placed;
        match (direction, answer) {
            (_, Answer::Ideal) => self.kernel.replace(direction, points),
            (Direction::Correct, Answer::IdealShifted) => {
                self.kernel.replace(direction, points);
                moved(points, |point| placed.shifted_from_ideal(point));
            }
            (Direction::Correct, Answer::MeasuredShifted) => {
                moved(points, |point| placed.shifted_from_measured(point));
            }
            (Direction::Distort, Answer::IdealShifted) => {
                moved(points, |point| placed.ideal_from_shifted(point));
                self.kernel.replace(direction, points);
            }
            (Direction::Distort, Answer::MeasuredShifted) => {
                moved(points, |point| placed.measured_from_shifted(point));
                for point in points.iter_mut() {
                    if self.is_off_sensor(*point) {
                        *point = [T::NAN; 2];
                    }
                }
            }
        }
        for (off, point) in off.iter().zip(points) {
            if *off {
                *point = [T::NAN; 2];
            }
        }
    }
}

fn moved<T: Coordinate>(points: &mut [[T; 2]], to: impl Fn([f64; 2]) -> [f64; 2]) {
    for point in points {
        *point = to(point.map(T::double)).map(T::rounded);
    }
}

/// Frames that were in use lately.
pub(crate) struct KeptFrames<'a> {
    camera: &'a CameraParts,
    table: &'a FrameTable,
    kept: Vec<Option<(usize, Option<FrameInUse<'a>>)>>,
}

impl<'a> KeptFrames<'a> {
    /// Creates room for the frames of so many points.
    pub(crate) fn new(camera: &'a CameraParts, table: &'a FrameTable, points: usize) -> Self {
        let count = KEPT.min(table.rows().len()).min(points).max(1);
        Self {
            camera,
            table,
            kept: vec![None; count],
        }
    }

    /// Returns the frame of a place; `None` for a refused trigger.
    pub(crate) fn frame(&mut self, place: usize) -> Option<FrameInUse<'a>> {
        let (camera, table) = (self.camera, self.table);
        let slot = place % self.kept.len();
        let kept = self.kept.get_mut(slot)?;
        match kept {
            Some((other, frame)) if *other == place => *frame,
            _ => {
                let frame = FrameInUse::new(camera, table, place);
                *kept = Some((place, frame));
                frame
            }
        }
    }
}

/// Returns how many numbers at the beginning are the same as `number`.
pub(crate) fn repeated<N: Copy + PartialEq>(number: N, numbers: &[N]) -> usize {
    const BLOCK: usize = 64;
    // Whole blocks take vectors, for which the loop must not end early.
    let is_same = |block: &[N]| block.iter().filter(|one| **one != number).count() == 0;
    let blocks = numbers.chunks_exact(BLOCK);
    let whole = BLOCK * blocks.take_while(|block| is_same(block)).count();
    let rest = numbers.get(whole..).unwrap_or_default();
    whole + rest.iter().take_while(|one| **one == number).count()
}

impl FlightPoints<'_> {
    /// Returns the place of a frame by the number with that place in the index.
    fn place(&self, at: usize, number: i64) -> PyResult<usize> {
        let count = self.table.rows().len();
        let place = usize::try_from(number).ok().filter(|place| *place < count);
        place.ok_or_else(|| error::of_index(at, number, count))
    }

    /// Calls `each` for the points of every frame that follow each other, with the range that they
    /// have among `count` points, of which the first is that with the number `from`.
    fn for_runs(
        &self,
        from: usize,
        count: usize,
        mut each: impl FnMut(Option<&FrameInUse<'_>>, Range<usize>) -> PyResult<()>,
    ) -> PyResult<()> {
        let mut kept = KeptFrames::new(self.camera, self.table, count);
        let end = from + count;
        let mut start = from;
        while start < end {
            let at = start / self.each;
            let behind = self
                .index
                .get(at..=(end - 1) / self.each)
                .unwrap_or_default();
            let number = behind.first().copied().unwrap_or(-1);
            let place = self.place(at, number)?;
            let next = end.min((at + repeated(number, behind)) * self.each);
            let frame = kept.frame(place);
            if let Some(frame) = &frame
                && self.answer == Answer::MeasuredShifted
                && !frame.has_shifted_points()
            {
                let row = self.table.rows().get(place);
                return Err(error::of_printed_sign(row.map_or(0, |row| row.sequence)));
            }
            each(frame.as_ref(), start - from..next - from)?;
            start = next;
        }
        Ok(())
    }

    fn replace_run<T: Coordinate>(&self, frame: Option<&FrameInUse<'_>>, points: &mut [[T; 2]]) {
        match frame {
            None => points.fill([T::NAN; 2]),
            Some(frame) => frame.replace(self.direction, self.answer, self.off_sensor, points),
        }
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

    fn check<T: Coordinate>(&self, points: &[[T; 2]], is_kept: bool) -> PyResult<()> {
        if is_kept {
            for (at, number) in self.index.iter().enumerate() {
                self.place(at, *number)?;
            }
        }
        if self.off_sensor != OffSensor::Error {
            return Ok(());
        }
        self.for_runs(0, points.len(), |frame, run| {
            let start = run.start;
            let points = points.get(run).unwrap_or_default();
            let Some(frame) = frame else {
                return Ok(());
            };
            let (found, fault) = match (self.direction, self.answer) {
                (Direction::Correct, _) => (
                    points.iter().position(|point| frame.is_off_sensor(*point)),
                    "off the sensor",
                ),
                (Direction::Distort, answer) => {
                    let mut measured = points.to_vec();
                    frame.replace(self.direction, answer, OffSensor::Nan, &mut measured);
                    let pairs = measured.iter().zip(points);
                    let lacks = |[x, y]: [T; 2]| x.single().is_nan() || y.single().is_nan();
                    let mut lack = pairs.map(|(found, given)| lacks(*found) && !lacks(*given));
                    (
                        lack.position(|lacks| lacks),
                        "no measured point on the sensor belongs to it",
                    )
                }
            };
            match found.and_then(|place| Some((start + place, points.get(place)?))) {
                None => Ok(()),
                Some((index, point)) => Err(error::of_point(index, point.map(T::double), fault)),
            }
        })
    }

    fn replace<T: Coordinate>(&self, from: usize, points: &mut [[T; 2]]) -> PyResult<()> {
        self.for_runs(from, points.len(), |frame, run| {
            self.replace_run(frame, points.get_mut(run).unwrap_or_default());
            Ok(())
        })
    }

    fn write<T: Coordinate>(
        &self,
        from: usize,
        points: &[[T; 2]],
        answers: &mut [[T; 2]],
    ) -> PyResult<()> {
        let is_plain = self.answer == Answer::Ideal
            && (self.direction == Direction::Distort || self.off_sensor != OffSensor::Nan);
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
        self.for_runs(from, points.len(), |frame, run| {
            let points = points.get(run.clone()).unwrap_or_default();
            let answers = answers.get_mut(run).unwrap_or_default();
            match frame {
                Some(frame) if is_plain => {
                    let kernel = frame.kernel.streamed_from(streamed_from);
                    kernel.write(self.direction, points, answers);
                }
                _ => {
                    answers.copy_from_slice(points);
                    self.replace_run(frame, answers);
                }
            }
            Ok(())
        })
    }
}
