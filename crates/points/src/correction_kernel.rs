//! Correction and distortion of the points of one frame, in single and in double precision.

use fmc_camera::geometry::exposure_distortion::ExposureDistortion;
use fmc_camera::geometry::frame_correction::Corrected;
use fmc_camera::geometry::gridded_correction::GriddedCorrection;
use fmc_camera::geometry::left_out_terms::LeftOut;
use fmc_camera::geometry::sensor::{Sensor, SensorPoint};
use fmc_camera_kernel::host::Batch;
use fmc_camera_kernel::inverse::LastStep;

use crate::TOGETHER;
use crate::coordinate::Coordinate;
use crate::direction::Direction;
use crate::numbers::Numbers;

/// Fewer points are computed one by one, with the same bits.
const FEW: usize = 8;

/// The correction of one frame, with the vectors of this PC where it is a polynomial alone.
///
/// It computes in the calling thread: a pool of threads would not survive `fork`.
#[derive(Debug, Clone, Copy)]
pub struct CorrectionKernel<'a> {
    correction: GriddedCorrection<'a>,
    vectors: Option<Batch>,
    last_step: LastStep,
    /// Terms that are added in double precision.
    left_out: LeftOut,
}

impl<'a> CorrectionKernel<'a> {
    /// Creates the kernel of a correction, with the terms that it leaves out in single precision.
    #[must_use]
    pub fn new(correction: GriddedCorrection<'a>, left_out: LeftOut) -> Self {
        let polynomial = correction.polynomial();
        let vectors = Batch::new(polynomial.coefficients(), polynomial.terms()).in_one_thread();
        Self {
            vectors: correction.is_polynomial().then_some(vectors),
            last_step: polynomial.last_step(),
            correction,
            left_out,
        }
    }

    /// Returns the correction as the camera computes it, also in double precision.
    pub(crate) fn of_camera(mut self) -> Self {
        self.left_out = LeftOut::default();
        self
    }

    pub(crate) fn sensor(&self) -> &Sensor {
        self.correction.polynomial().sensor()
    }

    /// Replaces points by their answers; one that has none becomes NaN.
    pub(crate) fn replace<T: Coordinate>(&self, direction: Direction, points: &mut [[T; 2]]) {
        if let (Direction::Correct, Some(vectors)) = (direction, &self.vectors)
            && let Some(points) = T::singles_mut(points)
        {
            return vectors.pairs(points);
        }
        self.replace_with(&mut Numbers::new(), direction, points);
    }

    /// Writes the answers to points.
    pub(crate) fn write<T: Coordinate>(
        &self,
        direction: Direction,
        points: &[[T; 2]],
        answers: &mut [[T; 2]],
    ) {
        if let (Direction::Correct, Some(vectors)) = (direction, &self.vectors)
            && let (Some(points), Some(answers)) = (T::singles(points), T::singles_mut(answers))
        {
            return vectors.pairs_into(points, answers);
        }
        self.write_with(&mut Numbers::new(), direction, points, answers);
    }

    /// Does the same as [`Self::write`] by numbers that the points of several frames share.
    pub(crate) fn write_with<T: Coordinate>(
        &self,
        numbers: &mut Numbers,
        direction: Direction,
        points: &[[T; 2]],
        answers: &mut [[T; 2]],
    ) {
        for (points, answers) in points.chunks(TOGETHER).zip(answers.chunks_mut(TOGETHER)) {
            for (point, answer) in points.iter().zip(answers.iter_mut()) {
                *answer = *point;
            }
            self.replace_with(numbers, direction, answers);
        }
    }

    /// Does the same as [`Self::replace`] by numbers that the points of several frames share.
    pub(crate) fn replace_with<T: Coordinate>(
        &self,
        numbers: &mut Numbers,
        direction: Direction,
        points: &mut [[T; 2]],
    ) {
        if points.len() < FEW {
            for point in points {
                *point = self.answer(direction, *point);
            }
            return;
        }
        for points in points.chunks_mut(TOGETHER) {
            numbers.take(points);
            match direction {
                Direction::Correct => self.correct(numbers, points.len()),
                Direction::Distort => self.distort(numbers, points.len()),
            }
            numbers.answer(direction, &self.left_out, points);
        }
    }

    /// Returns the answer to a point; NaN where there is none.
    fn answer<T: Coordinate>(&self, direction: Direction, [x, y]: [T; 2]) -> [T; 2] {
        let given = SensorPoint::new(x.single(), y.single());
        let answer = match direction {
            Direction::Correct => Some(self.correction.correct(given)),
            Direction::Distort => self.correction.distort(given).ok(),
        };
        answer.map_or([T::NAN; 2], |Corrected { point, distortion }| {
            let left_out = direction.left_out(&self.left_out, given, point);
            direction.changed([x, y], point, [distortion, left_out])
        })
    }

    /// Returns the place of the first ideal point, not NaN, that has no measured one.
    pub(crate) fn first_without_measured<T: Coordinate>(&self, points: &[[T; 2]]) -> Option<usize> {
        let mut numbers = Numbers::new();
        for (block, points) in points.chunks(TOGETHER).enumerate() {
            numbers.take(points);
            self.distort(&mut numbers, points.len());
            let Numbers { given, found, .. } = &numbers;
            let [[x, y], [found, _]] = [given, found];
            let is_number = x.iter().zip(y).map(|(x, y)| !x.is_nan() && !y.is_nan());
            let mut lacks = is_number
                .zip(found)
                .take(points.len())
                .map(|(is_number, found)| is_number && found.is_nan());
            if let Some(place) = lacks.position(|lacks| lacks) {
                return Some(block * TOGETHER + place);
            }
        }
        None
    }

    fn correct(&self, numbers: &mut Numbers, count: usize) {
        if let Some(vectors) = &self.vectors {
            let [given, found, distortion] = numbers.slices(count);
            vectors.xy_with_distortion(given.map(|numbers| &*numbers), found, distortion);
            return;
        }
        numbers.each(count, |measured| {
            let corrected = self.correction.correct(measured);
            Some((corrected.point, corrected.distortion))
        });
    }

    fn distort(&self, numbers: &mut Numbers, count: usize) {
        let by_point = |ideal| {
            let measured = self.correction.distort(ideal).ok()?;
            Some((measured.point, measured.distortion))
        };
        let Some(vectors) = &self.vectors else {
            return numbers.each(count, by_point);
        };
        let [given, found, distortion] = numbers.slices(count);
        let given = given.map(|numbers| &*numbers);
        if !vectors.xy_distorted(&self.last_step, given, found, distortion) {
            numbers.each_left(count, by_point);
        }
    }
}
