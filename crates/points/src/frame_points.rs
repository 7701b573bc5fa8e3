//! Points of one frame.

use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;

use crate::TOGETHER;
use crate::coordinate::Coordinate;
use crate::correction_kernel::CorrectionKernel;
use crate::direction::Direction;
use crate::off_sensor::OffSensor;
use crate::point_error::PointError;
use crate::slices::{Answers, Points, PointsMut};
use crate::unit::Unit;

/// Correction or distortion of the points of one frame.
#[derive(Debug)]
pub struct FramePoints<'a> {
    /// The correction.
    pub kernel: CorrectionKernel<'a>,
    /// Correction or distortion.
    pub direction: Direction,
    /// Answer to points that are off the sensor.
    pub off_sensor: OffSensor,
    /// Unit of the points.
    pub unit: Unit,
    /// The camera, which has the pixels.
    pub file: &'a CameraFile,
}

impl FramePoints<'_> {
    fn is_off_sensor<T: Coordinate>(&self, point: [T; 2]) -> bool {
        let [x, y] = self.unit.millimetres(self.file, point).map(f64::single);
        let point = SensorPoint::new(x, y);
        !x.is_nan() && !y.is_nan() && !self.kernel.sensor().contains(point)
    }

    /// Replaces the points that are computed together.
    fn replace_part<T: Coordinate>(&self, points: &mut [[T; 2]]) {
        let mut off = [false; TOGETHER];
        let is_marked = self.direction == Direction::Correct && self.off_sensor == OffSensor::Nan;
        if is_marked {
            for (off, point) in off.iter_mut().zip(points.iter()) {
                *off = self.is_off_sensor(*point);
            }
        }
        match self.unit {
            Unit::Millimetres => self.kernel.replace(self.direction, points),
            Unit::Pixels => self.replace_pixels(points),
        }
        if is_marked {
            for (off, point) in off.iter().zip(points) {
                if *off {
                    *point = [T::NAN; 2];
                }
            }
        }
    }

    fn replace_pixels<T: Coordinate>(&self, points: &mut [[T; 2]]) {
        let mut places = [[0.0_f64; 2]; TOGETHER];
        let (places, _) = places.split_at_mut(points.len().min(TOGETHER));
        for (place, point) in places.iter_mut().zip(points.iter()) {
            *place = self.unit.millimetres(self.file, *point);
        }
        // In single precision the answers are those of the camera.
        let kernel = if T::singles(points).is_some() {
            self.kernel.of_camera()
        } else {
            self.kernel
        };
        kernel.replace(self.direction, places);
        for (place, point) in places.iter().zip(points) {
            *point = self.file.pixel_from_sensor(*place).map(T::rounded);
        }
    }

    /// Returns true if the kernel alone gives the answers.
    fn is_plain(&self) -> bool {
        let is_marked = self.direction == Direction::Correct && self.off_sensor == OffSensor::Nan;
        self.unit == Unit::Millimetres && !is_marked
    }

    fn check_of<T: Coordinate>(&self, points: &[[T; 2]]) -> Result<(), PointError> {
        if self.off_sensor != OffSensor::Error {
            return Ok(());
        }
        let found = match self.direction {
            Direction::Correct => points.iter().position(|point| self.is_off_sensor(*point)),
            Direction::Distort => {
                let places = |points: &[[T; 2]]| -> Vec<[f64; 2]> {
                    let points = points.iter();
                    points
                        .map(|point| self.unit.millimetres(self.file, *point))
                        .collect()
                };
                points
                    .chunks(TOGETHER)
                    .enumerate()
                    .find_map(|(part, points)| {
                        let place = self.kernel.first_without_measured(&places(points))?;
                        Some(part * TOGETHER + place)
                    })
            }
        };
        let Some((index, point)) = found.and_then(|index| Some((index, points.get(index)?))) else {
            return Ok(());
        };
        let point_mm = self.unit.millimetres(self.file, *point);
        Err(PointError::of(self.direction, index, point_mm))
    }

    fn replace_of<T: Coordinate>(&self, points: &mut [[T; 2]]) {
        if self.is_plain() {
            return self.kernel.replace(self.direction, points);
        }
        points
            .chunks_mut(TOGETHER)
            .for_each(|points| self.replace_part(points));
    }

    fn write_of<T: Coordinate>(&self, points: &[[T; 2]], answers: &mut [[T; 2]]) {
        if self.is_plain() {
            return self.kernel.write(self.direction, points, answers);
        }
        answers.copy_from_slice(points);
        self.replace_of(answers);
    }
}

/// Functions of arrays.
impl FramePoints<'_> {
    /// Checks that points have answers, where those that have none are an error.
    ///
    /// # Errors
    /// [`PointError`] of the first point that has none.
    #[inline(never)]
    pub fn check(&self, points: Points<'_>) -> Result<(), PointError> {
        match points {
            Points::Single(points) => self.check_of(points),
            Points::Double(points) => self.check_of(points),
        }
    }

    /// Replaces points by their answers.
    #[inline(never)]
    pub fn replace(&self, points: PointsMut<'_>) {
        match points {
            PointsMut::Single(points) => self.replace_of(points),
            PointsMut::Double(points) => self.replace_of(points),
        }
    }

    /// Writes the answers to points.
    #[inline(never)]
    pub fn write(&self, answers: Answers<'_>) {
        match answers {
            Answers::Single { of, to } => self.write_of(of, to),
            Answers::Double { of, to } => self.write_of(of, to),
        }
    }
}
