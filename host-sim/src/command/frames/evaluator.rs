//! Points of many frames through their corrections.

use std::ops::Range;

use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::inverse::DistortError;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::InputError;
use fmc_camera_file::number::single;
use fmc_frames::CalibrationCovariance;

use super::Flight;
use super::active_frame::ActiveFrame;
use super::coordinate_sigma::{by_calibration, by_principal_point};
use crate::cli::AnswerName;
use crate::command::points::Direction;
use crate::device::PointBatch;
use crate::formats::frame_points::{Flag, FrameAnswers, FrameBlock};
use crate::formats::points::{Answer, half_format_mm};

/// Corrections that are kept: those of the frames that points in any order name again. A million
/// frames share them by the last digits of their places.
const KEPT: usize = 1024;

/// Evaluator of the points of a flight.
pub(super) struct Evaluator<'a> {
    flight: &'a Flight,
    grids: CameraGrids<'a>,
    direction: Direction,
    answer: AnswerName,
    sigma: bool,
    covariance: Option<&'a CalibrationCovariance>,
    half_format_mm: [f64; 2],
    /// Corrections with the places of their frames.
    kept: Vec<Option<(u32, ActiveFrame<'a>)>>,
    points: Vec<SensorPoint>,
}

/// A frame whose points the answer asked for does not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Unshiftable {
    /// Place of the first such point in the block.
    pub(super) index: usize,
}

impl<'a> Evaluator<'a> {
    /// Creates the evaluator.
    ///
    /// # Errors
    /// [`InputError`] of residual grids that do not fit the camera.
    pub(super) fn new(
        flight: &'a Flight,
        direction: Direction,
        answer: AnswerName,
        sigma: bool,
        covariance: Option<&'a CalibrationCovariance>,
    ) -> Result<Self, InputError> {
        Ok(Self {
            flight,
            grids: flight.camera.grids()?,
            direction,
            answer,
            sigma,
            covariance,
            half_format_mm: half_format_mm(&flight.file),
            kept: vec![None; KEPT],
            points: Vec::new(),
        })
    }

    /// Answers the points of a block.
    ///
    /// # Errors
    /// [`Unshiftable`] for a frame with the printed signs of the focus shift, of whose points there
    /// are no shifted ones.
    pub(super) fn answer(
        &mut self,
        block: &FrameBlock,
        answers: &mut FrameAnswers,
    ) -> Result<(), Unshiftable> {
        answers.clear();
        let mut from = 0;
        for run in block.frames.chunk_by(|a, b| a == b) {
            let run_points = from..from + run.len();
            let place = run.first().copied().unwrap_or_default();
            match self.frame(place) {
                None => self.refuse(run.len(), answers),
                Some(frame) => {
                    if self.answer == AnswerName::MeasuredShifted && !frame.has_shifted_points() {
                        return Err(Unshiftable { index: from });
                    }
                    self.answer_run(&frame, block, run_points, answers);
                }
            }
            from += run.len();
        }
        Ok(())
    }

    /// Returns the correction of a frame; `None` for a refused trigger.
    fn frame(&mut self, place: u32) -> Option<ActiveFrame<'a>> {
        let index = place as usize;
        let kept = self.kept.get_mut(index % KEPT)?;
        match kept {
            Some((other, frame)) if *other == place => Some(*frame),
            _ => {
                let flight = self.flight;
                let row = flight.table.rows().get(index)?;
                let calibration = flight.camera.calibration();
                let principal_point_mm = flight.file.principal_point_mm;
                let frame = ActiveFrame::new(row, calibration, &self.grids, principal_point_mm)?;
                *kept = Some((place, frame));
                Some(frame)
            }
        }
    }

    fn refuse(&self, count: usize, answers: &mut FrameAnswers) {
        let length = answers.answers.len() + count;
        answers.answers.resize(length, NO_ANSWER);
        answers.flags.resize(length, Flag::Refused);
        if self.sigma {
            answers.sigma_mm.resize(length, [f64::NAN; 2]);
        }
    }

    /// Answers the points of a frame that follow each other.
    fn answer_run(
        &mut self,
        frame: &ActiveFrame<'_>,
        block: &FrameBlock,
        run: Range<usize>,
        answers: &mut FrameAnswers,
    ) {
        let given = block.points_mm.get(run).unwrap_or_default();
        let start = answers.answers.len();
        match self.direction {
            Direction::Correct => self.correct(frame, given, answers),
            Direction::Distort => self.distort(frame, given, answers),
        }
        if self.sigma {
            let measured = match self.direction {
                Direction::Correct => None,
                Direction::Distort => answers.answers.get(start..),
            };
            let places = given.iter().enumerate().map(|(index, given)| {
                let answer = measured.and_then(|answers| answers.get(index));
                sensor_point(answer.map_or(*given, |answer| answer.point_mm))
            });
            answers
                .sigma_mm
                .extend(places.map(|measured| self.sigma_mm(frame, measured)));
        }
    }

    /// Returns σ of an answer, mm.
    fn sigma_mm(&self, frame: &ActiveFrame<'_>, measured: SensorPoint) -> [f64; 2] {
        let jacobian = frame.correction.polynomial().jacobian(measured);
        let change = by_principal_point(frame, jacobian, self.direction, self.answer);
        let sigma_mm = match (frame.sigma_mm, self.covariance) {
            (Some(sigma_mm), _) => sigma_mm,
            // σ of the calibration alone.
            (None, Some(_)) => 0.0,
            (None, None) => f64::NAN,
        };
        let own = change.map(|change| change.abs() * sigma_mm);
        match self.covariance {
            None => own,
            Some(covariance) => {
                let [x, y] = own;
                let [var_x, var_y] =
                    by_calibration(covariance, frame, measured, self.direction, self.answer);
                [x.hypot(var_x.sqrt()), y.hypot(var_y.sqrt())]
            }
        }
    }

    fn correct(&mut self, frame: &ActiveFrame<'_>, given: &[[f64; 2]], answers: &mut FrameAnswers) {
        self.points.clear();
        self.points
            .extend(given.iter().map(|point| sensor_point(*point)));
        let [half_width, half_height] = self.half_format_mm;
        let correction = &frame.correction;
        let polynomial = correction.polynomial();
        let all_inside = PointBatch::all_on_sensor(polynomial, &self.points);
        let flags = given.iter().zip(&self.points).map(|([x, y], point)| {
            let on = x.abs() <= half_width
                && y.abs() <= half_height
                && (all_inside || polynomial.contains(*point));
            if on { Flag::None } else { Flag::OffSensor }
        });
        answers.flags.extend(flags);
        let answer = |corrected: Corrected, given: [f64; 2]| {
            let ideal = [corrected.point.x_mm, corrected.point.y_mm].map(f64::from);
            let distortion = corrected.distortion;
            Answer {
                point_mm: match self.answer {
                    AnswerName::Ideal => ideal,
                    AnswerName::IdealShifted => frame.shifted_from_ideal(ideal),
                    AnswerName::MeasuredShifted => frame.shifted_from_measured(given),
                },
                distortion_mm: [distortion.dx_mm, distortion.dy_mm].map(f64::from),
            }
        };
        if let Some(batch) = frame.batch_of(self.points.len()) {
            let corrected = batch.corrected(&self.points);
            let points = corrected.into_iter().zip(given);
            answers
                .answers
                .extend(points.map(|(corrected, given)| answer(corrected, *given)));
        } else {
            let points = self.points.iter().zip(given);
            let corrected = points.map(|(point, given)| answer(correction.correct(*point), *given));
            answers.answers.extend(corrected);
        }
    }

    fn distort(&mut self, frame: &ActiveFrame<'_>, given: &[[f64; 2]], answers: &mut FrameAnswers) {
        if self.answer == AnswerName::MeasuredShifted {
            for given in given {
                let (answer, flag) = self.moved(frame, *given);
                answers.answers.push(answer);
                answers.flags.push(flag);
            }
            return;
        }
        let is_shifted = self.answer == AnswerName::IdealShifted;
        self.points.clear();
        self.points.extend(given.iter().map(|given| {
            sensor_point(if is_shifted {
                frame.ideal_from_shifted(*given)
            } else {
                *given
            })
        }));
        let correction = &frame.correction;
        let push = |found| {
            let (answer, flag) = self.distorted(found);
            answers.answers.push(answer);
            answers.flags.push(flag);
        };
        if let Some(batch) = frame.batch_of(self.points.len()) {
            let stepped = batch.stepped(&self.points);
            let found = stepped.into_iter().zip(&self.points);
            found
                .map(|(found, ideal)| {
                    if found.point.x_mm.is_nan() {
                        correction.distort(*ideal)
                    } else {
                        Ok(found)
                    }
                })
                .for_each(push);
        } else {
            let found = self.points.iter().map(|ideal| correction.distort(*ideal));
            found.for_each(push);
        }
    }

    /// Returns the answer to an ideal point, of which the measured one was found or not.
    fn distorted(&self, found: Result<Corrected, DistortError>) -> (Answer, Flag) {
        match found {
            Ok(measured) => {
                let [half_width, half_height] = self.flight.file.half_format_mm();
                let SensorPoint { x_mm, y_mm } = measured.point;
                let distortion = measured.distortion;
                let answer = Answer {
                    // Rounding to single precision can put a point of the edge beyond the edge.
                    point_mm: [
                        f64::from(x_mm).clamp(-half_width, half_width),
                        f64::from(y_mm).clamp(-half_height, half_height),
                    ],
                    distortion_mm: [distortion.dx_mm, distortion.dy_mm].map(f64::from),
                };
                (answer, Flag::None)
            }
            Err(DistortError::OffSensor(measured)) => {
                let answer = Answer {
                    point_mm: [measured.x_mm, measured.y_mm].map(f64::from),
                    ..NO_ANSWER
                };
                (answer, Flag::OffSensor)
            }
            Err(DistortError::NotConverged { .. }) => (NO_ANSWER, Flag::NotConverged),
        }
    }

    /// Returns the measured point of one about the calibrated principal point.
    fn moved(&self, frame: &ActiveFrame<'_>, shifted_mm: [f64; 2]) -> (Answer, Flag) {
        let point_mm = frame.measured_from_shifted(shifted_mm);
        let [x, y] = point_mm;
        let [half_width, half_height] = self.half_format_mm;
        let distortion = frame.correction.distortion(sensor_point(point_mm));
        let answer = Answer {
            point_mm,
            distortion_mm: [distortion.dx_mm, distortion.dy_mm].map(f64::from),
        };
        let on = x.abs() <= half_width && y.abs() <= half_height;
        (answer, if on { Flag::None } else { Flag::OffSensor })
    }
}

/// Stands for the answer to a point that has none.
const NO_ANSWER: Answer = Answer {
    point_mm: [f64::NAN; 2],
    distortion_mm: [f64::NAN; 2],
};

fn sensor_point([x, y]: [f64; 2]) -> SensorPoint {
    SensorPoint::new(single(x), single(y))
}
