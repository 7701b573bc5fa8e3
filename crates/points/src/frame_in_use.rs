//! A frame of a flight whose points are being answered.

use fmc_camera::geometry::left_out_terms::LeftOut;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_frames::PlacedFrame;

use crate::TOGETHER;
use crate::answer::Answer;
use crate::coordinate::Coordinate;
use crate::correction_kernel::CorrectionKernel;
use crate::direction::Direction;
use crate::numbers::Numbers;
use crate::off_sensor::OffSensor;

/// A frame whose points are being answered.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameInUse<'a> {
    placed: PlacedFrame<'a>,
    kernel: CorrectionKernel<'a>,
}

impl<'a> FrameInUse<'a> {
    pub(crate) fn new(placed: &PlacedFrame<'a>, left_out: LeftOut) -> Self {
        Self {
            kernel: CorrectionKernel::new(placed.correction, left_out),
            placed: *placed,
        }
    }

    /// Returns true if measured points can be referred to the calibration.
    pub(crate) fn has_shifted_points(&self) -> bool {
        self.placed.has_shifted_points()
    }

    pub(crate) fn is_off_sensor<T: Coordinate>(&self, [x, y]: [T; 2]) -> bool {
        let point = SensorPoint::new(x.single(), y.single());
        !point.x_mm.is_nan() && !point.y_mm.is_nan() && !self.kernel.sensor().contains(point)
    }

    /// Replaces points by their answers.
    pub(crate) fn replace<T: Coordinate>(
        &self,
        numbers: &mut Numbers,
        direction: Direction,
        answer: Answer,
        off_sensor: OffSensor,
        points: &mut [[T; 2]],
    ) {
        let is_marked = off_sensor == OffSensor::Nan && direction == Direction::Correct;
        if answer == Answer::Ideal && !is_marked {
            return self.kernel.replace_with(numbers, direction, points);
        }
        for points in points.chunks_mut(TOGETHER) {
            self.replace_part(numbers, direction, answer, is_marked, points);
        }
    }

    /// Writes the answers to points: those of the correction alone.
    pub(crate) fn write<T: Coordinate>(
        &self,
        numbers: &mut Numbers,
        direction: Direction,
        points: &[[T; 2]],
        answers: &mut [[T; 2]],
    ) {
        self.kernel.write_with(numbers, direction, points, answers);
    }

    fn replace_part<T: Coordinate>(
        &self,
        numbers: &mut Numbers,
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
            (_, Answer::Ideal) => self.kernel.replace_with(numbers, direction, points),
            (Direction::Correct, Answer::IdealShifted) => {
                self.kernel.replace_with(numbers, direction, points);
                moved(points, |point| placed.shifted_from_ideal(point));
            }
            (Direction::Correct, Answer::MeasuredShifted) => {
                moved(points, |point| placed.shifted_from_measured(point));
            }
            (Direction::Distort, Answer::IdealShifted) => {
                moved(points, |point| placed.ideal_from_shifted(point));
                self.kernel.replace_with(numbers, direction, points);
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
