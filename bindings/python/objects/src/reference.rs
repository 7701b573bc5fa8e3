//! Points through the strict solver.

use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_points::{Answers, Coordinate, Points, PointsMut};
use fmc_reference::exposure::{ExposureRequest, FocusFormula};
use fmc_reference::model_reference::ModelReference;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::strict::{Reading, Weight};
use pyo3::prelude::*;

use crate::array::Work;
use crate::frame::Frame;

/// The strict solver of a frame.
#[derive(Debug)]
pub(crate) struct ReferencePoints(ModelReference);

impl ReferencePoints {
    pub(crate) fn new(frame: &Frame) -> Self {
        let given = &frame.arguments;
        let request = ExposureRequest {
            vh_per_s: given.vh_per_s,
            exposure_s: given.exposure_s,
            opening_offset_mm: given.opening_offset_mm,
            focus_shift_mm: given.focus_shift_um / 1000.0,
            focus_formula: match given.focus_sign {
                FocusSign::Physical => FocusFormula::Physical,
                FocusSign::Printed => FocusFormula::Printed,
            },
            direction: given.direction,
        };
        let camera = &frame.camera;
        let splines = ResidualSplines::of(camera.grids());
        Self(ModelReference::new(
            &camera.file,
            &request,
            given.model,
            Weight::Exposure,
            splines,
        ))
    }

    /// Returns the distortion of a measured point over the exposure, measured - ideal, mm.
    pub(crate) fn distortion_mm(&self, point_mm: [f64; 2]) -> [f64; 2] {
        self.0.total(point_mm, Reading::Consistent).distortion_mm
    }

    fn answer<T: Coordinate>(&self, point: [T; 2]) -> [T; 2] {
        let [x, y] = point.map(T::double);
        let [dx, dy] = self.distortion_mm([x, y]);
        [x - dx, y - dy].map(T::rounded)
    }

    fn replace_of<T: Coordinate>(&self, points: &mut [[T; 2]]) {
        for point in points {
            *point = self.answer(*point);
        }
    }

    fn write_of<T: Coordinate>(&self, points: &[[T; 2]], answers: &mut [[T; 2]]) {
        for (point, answer) in points.iter().zip(answers) {
            *answer = self.answer(*point);
        }
    }
}

impl Work for ReferencePoints {
    fn check(&self, _points: Points<'_>) -> PyResult<()> {
        Ok(())
    }

    fn replace(&self, _from: usize, points: PointsMut<'_>) {
        match points {
            PointsMut::Single(points) => self.replace_of(points),
            PointsMut::Double(points) => self.replace_of(points),
        }
    }

    fn write(&self, _from: usize, answers: Answers<'_>) {
        match answers {
            Answers::Single { of, to } => self.write_of(of, to),
            Answers::Double { of, to } => self.write_of(of, to),
        }
    }
}
