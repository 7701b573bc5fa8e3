//! Points through the strict solver.

use fmc_camera::geometry::principal_distance::FocusSign;
use fmc_reference::exposure::{ExposureRequest, FocusFormula};
use fmc_reference::model_reference::ModelReference;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_reference::strict::{Reading, Weight};
use pyo3::prelude::*;

use crate::array::Work;
use crate::coordinate::Coordinate;
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
}

impl Work for ReferencePoints {
    fn check<T: Coordinate>(&self, _points: &[[T; 2]]) -> PyResult<()> {
        Ok(())
    }

    fn replace<T: Coordinate>(&self, _from: usize, points: &mut [[T; 2]]) -> PyResult<()> {
        for point in points {
            let [x, y] = point.map(T::double);
            let [dx, dy] = self.0.total([x, y], Reading::Consistent).distortion_mm;
            *point = [x - dx, y - dy].map(T::rounded);
        }
        Ok(())
    }
}
