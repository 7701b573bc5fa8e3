//! Points of one frame.

use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::CameraFile;
use pyo3::prelude::*;

use crate::array::Work;
use crate::coordinate::Coordinate;
use crate::correction_kernel::{CorrectionKernel, Direction, TOGETHER};
use crate::error;
use crate::off_sensor::OffSensor;
use crate::pixels::Unit;

/// Correction or distortion of the points of one frame.
#[derive(Debug)]
pub(crate) struct FramePoints<'a> {
    pub(crate) kernel: CorrectionKernel<'a>,
    pub(crate) direction: Direction,
    pub(crate) off_sensor: OffSensor,
    pub(crate) unit: Unit,
    pub(crate) file: &'a CameraFile,
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
}

impl Work for FramePoints<'_> {
    fn check<T: Coordinate>(&self, points: &[[T; 2]]) -> PyResult<()> {
        if self.off_sensor != OffSensor::Error {
            return Ok(());
        }
        let (found, fault) = match self.direction {
            Direction::Correct => (
                points.iter().position(|point| self.is_off_sensor(*point)),
                "off the sensor",
            ),
            Direction::Distort => {
                let places = |points: &[[T; 2]]| -> Vec<[f64; 2]> {
                    let points = points.iter();
                    points
                        .map(|point| self.unit.millimetres(self.file, *point))
                        .collect()
                };
                let found = points
                    .chunks(TOGETHER)
                    .enumerate()
                    .find_map(|(part, points)| {
                        let place = self.kernel.first_without_measured(&places(points))?;
                        Some(part * TOGETHER + place)
                    });
                (found, "no measured point on the sensor belongs to it")
            }
        };
        match found.and_then(|index| Some((index, points.get(index)?))) {
            None => Ok(()),
            Some((index, point)) => {
                let place = self.unit.millimetres(self.file, *point);
                Err(error::of_point(index, place, fault))
            }
        }
    }

    fn replace<T: Coordinate>(&self, _from: usize, points: &mut [[T; 2]]) -> PyResult<()> {
        if self.is_plain() {
            self.kernel.replace(self.direction, points);
            return Ok(());
        }
        points
            .chunks_mut(TOGETHER)
            .for_each(|points| self.replace_part(points));
        Ok(())
    }

    fn write<T: Coordinate>(
        &self,
        from: usize,
        points: &[[T; 2]],
        answers: &mut [[T; 2]],
    ) -> PyResult<()> {
        if self.is_plain() {
            self.kernel.write(self.direction, points, answers);
            return Ok(());
        }
        answers.copy_from_slice(points);
        self.replace(from, answers)
    }
}
