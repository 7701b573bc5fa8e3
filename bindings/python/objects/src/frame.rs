//! The frame of one exposure.

use std::sync::Arc;
use std::time::Instant;

use fmc_camera::flight::camera::Frame as PredictedFrame;
use fmc_camera::flight::gridded_frame::GriddedFrame;
use fmc_camera::flight::interior_orientation::InteriorOrientation;
use fmc_camera_kernel::host::Batch;
use fmc_frames::row;
use fmc_points::{CorrectionKernel, Direction, FramePoints, Unit, left_out, mesh};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyReadwriteArray2};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::array::{self, Arguments};
use crate::camera::{Camera, CameraParts};
use crate::error;
use crate::exposure::ExposureArguments;
use crate::off_sensor::off_sensor as off_sensor_of;

/// The frame of one exposure: its interior orientation, and the correction of its points.
#[pyclass(module = "fmc_camera", frozen)]
pub(crate) struct Frame {
    pub(crate) camera: Arc<CameraParts>,
    pub(crate) arguments: ExposureArguments,
    frame: PredictedFrame,
    left_out_nm: f32,
}

impl Frame {
    pub(crate) fn new(camera: &Arc<CameraParts>, arguments: ExposureArguments) -> PyResult<Self> {
        let frame = camera
            .camera
            .camera()
            .frame(&arguments.exposure())
            .map_err(|error| error::of_frame(&error))?;
        let left_out_nm = GriddedFrame::new(&frame, camera.grids())
            .interior
            .left_out_nm;
        Ok(Self {
            camera: Arc::clone(camera),
            arguments,
            frame,
            left_out_nm,
        })
    }

    /// Returns the correction with the residual grids of the camera.
    pub(crate) fn gridded(&self) -> GriddedFrame<'_> {
        GriddedFrame::new(&self.frame, self.camera.grids())
    }

    fn kernel(&self) -> CorrectionKernel<'_> {
        let PredictedFrame {
            interior,
            correction,
        } = &self.frame;
        let calibration = self.camera.camera.calibration();
        let left_out = left_out(calibration, correction, interior.model, &interior.motion);
        CorrectionKernel::new(self.gridded().correction, left_out)
    }

    fn interior(&self) -> &InteriorOrientation {
        &self.frame.interior
    }

    fn answer<'py>(
        &self,
        arguments: &Arguments<'_, 'py>,
        direction: Direction,
        off_sensor: &str,
        unit: Unit,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut work = FramePoints {
            kernel: self.kernel(),
            direction,
            off_sensor: off_sensor_of(off_sensor)?,
            unit,
            file: &self.camera.file,
        };
        array::answered(arguments, &mut work)
    }
}

#[pymethods]
impl Frame {
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let camera = Camera {
            parts: Arc::clone(&self.camera),
        };
        let restore = py.get_type::<Self>().getattr("_restored")?;
        let given = &self.arguments;
        let words = given.words();
        let numbers = (
            given.vh_per_s,
            given.exposure_s,
            given.focus_shift_um,
            given.opening_offset_mm,
        );
        let words = (words.direction, words.focus_sign, words.model);
        (restore, (camera, numbers, words)).into_bound_py_any(py)
    }

    #[staticmethod]
    fn _restored<'py>(
        camera: &Bound<'py, Camera>,
        numbers: (f64, f64, f64, Option<f64>),
        words: (String, String, String),
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = camera.py();
        let (vh, exposure_s, focus_shift_um, opening_offset_mm) = numbers;
        let (direction, focus_sign, model) = words;
        let options = PyDict::new(py);
        options.set_item("focus_shift_um", focus_shift_um)?;
        options.set_item("opening_offset_mm", opening_offset_mm)?;
        options.set_item("direction", direction)?;
        options.set_item("focus_sign", focus_sign)?;
        options.set_item("model", model)?;
        camera.call_method("frame", (vh, exposure_s), Some(&options))
    }

    /// V/H of the exposure, 1/s.
    #[getter]
    fn vh_per_s(&self) -> f64 {
        self.arguments.vh_per_s
    }

    /// Exposure time, s.
    #[getter]
    fn exposure_s(&self) -> f64 {
        self.arguments.exposure_s
    }

    /// Model of the correction: exact, fitted or static.
    #[getter]
    fn model(&self) -> &'static str {
        row::model(self.interior().model)
    }

    /// Principal point (x, y) at the centroid of the exposure, sensor frame, mm.
    #[getter]
    fn principal_point_mm(&self) -> (f32, f32) {
        let point = self.interior().principal_point;
        (point.x_mm, point.y_mm)
    }

    /// Principal distance that goes with the corrected coordinates, mm.
    #[getter]
    fn principal_distance_mm(&self) -> f32 {
        self.interior().principal_distance_mm
    }

    /// Opening offset Δδ, mm along the FMC axis.
    #[getter]
    fn opening_offset_mm(&self) -> f32 {
        self.interior().motion.opening_offset_mm
    }

    /// Travel δ of the principal point while the shutter is open, mm along the FMC axis.
    #[getter]
    pub(crate) fn travel_mm(&self) -> f32 {
        self.interior().motion.travel_mm
    }

    /// Offset of the principal point at the centroid, mm along the FMC axis.
    #[getter]
    fn centroid_offset_mm(&self) -> f32 {
        self.interior().motion.centroid_mm
    }

    /// Centroid of the exposure, s after the opening.
    #[getter]
    fn centroid_time_s(&self) -> f32 {
        self.interior().motion.centroid_time_s
    }

    /// Focus shift Δz, run-out included, mm.
    #[getter]
    fn focus_shift_mm(&self) -> f32 {
        self.interior().focus_shift_mm
    }

    /// Relative enlargement κ of the image by the focus shift.
    #[getter]
    fn enlargement(&self) -> f32 {
        self.interior().enlargement
    }

    /// Upper bound of what the correction leaves out of the model, per axis, nm.
    #[getter]
    fn left_out_nm(&self) -> f32 {
        self.left_out_nm
    }

    fn __repr__(&self) -> String {
        let interior = self.interior();
        format!(
            "<fmc_camera.Frame of {:?}: V/H {} 1/s, exposure {} s, principal point ({:.6}, {:.6}) mm, \
             δ {:.6} mm, model {}>",
            self.camera.file.name,
            self.arguments.vh_per_s,
            self.arguments.exposure_s,
            interior.principal_point.x_mm,
            interior.principal_point.y_mm,
            interior.motion.travel_mm,
            row::model(interior.model),
        )
    }

    /// Returns the ideal points of measured ones, (N, 2) in mm.
    #[pyo3(signature = (points, *, out = None, inplace = false, off_sensor = "extrapolate"))]
    fn correct<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        inplace: bool,
        off_sensor: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = Arguments::new(points, out, inplace);
        self.answer(
            &arguments,
            Direction::Correct,
            off_sensor,
            Unit::Millimetres,
        )
    }

    /// Returns the measured points of ideal ones, (N, 2) in mm; NaN where there is none on the
    /// sensor.
    #[pyo3(signature = (points, *, out = None, inplace = false, off_sensor = "nan"))]
    fn distort<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        inplace: bool,
        off_sensor: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = Arguments::new(points, out, inplace);
        self.answer(
            &arguments,
            Direction::Distort,
            off_sensor,
            Unit::Millimetres,
        )
    }

    /// Returns the ideal points of measured ones, (N, 2) as column and row in pixels.
    #[pyo3(signature = (points, *, out = None, inplace = false, off_sensor = "extrapolate"))]
    fn correct_px<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        inplace: bool,
        off_sensor: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = Arguments::new(points, out, inplace);
        self.answer(&arguments, Direction::Correct, off_sensor, Unit::Pixels)
    }

    /// Returns the measured points of ideal ones, (N, 2) as column and row in pixels; NaN where
    /// there is none on the sensor.
    #[pyo3(signature = (points, *, out = None, inplace = false, off_sensor = "nan"))]
    fn distort_px<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
        inplace: bool,
        off_sensor: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = Arguments::new(points, out, inplace);
        self.answer(&arguments, Direction::Distort, off_sensor, Unit::Pixels)
    }

    /// Returns the sources of a corrected image, (rows, columns, 2) as column and row in pixels, at
    /// a vertex every `spacing` pixels.
    #[pyo3(signature = (spacing = 16))]
    fn mesh<'py>(&self, py: Python<'py>, spacing: u16) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        if spacing == 0 {
            return Err(error::of_argument(
                "spacing",
                0.0,
                [1.0, f64::from(u16::MAX)],
            ));
        }
        let mesh = py.detach(|| {
            let correction = self.gridded().correction;
            mesh(&correction, self.camera.file.sensor.pixel_um, spacing)
        });
        let mesh = mesh.map_err(|error| error::of_text(error.to_string()))?;
        mesh.sources_px
            .into_pyarray(py)
            .reshape(mesh.shape.to_vec())
    }

    /// Returns the seconds of the fastest of some calls of the kernel alone, in one thread, for the
    /// comparison with those of `correct`.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "an argument of Python is converted into it"
    )]
    fn _kernel_seconds(
        &self,
        points: PyReadonlyArray2<'_, f32>,
        mut out: PyReadwriteArray2<'_, f32>,
        calls: u32,
    ) -> PyResult<f64> {
        let (points, _) = points.as_slice()?.as_chunks::<2>();
        let (out, _) = out.as_slice_mut()?.as_chunks_mut::<2>();
        let correction = self.gridded().correction;
        let polynomial = correction.polynomial();
        let kernel = Batch::new(polynomial.coefficients(), polynomial.terms()).in_one_thread();
        let fastest = (0..calls).map(|_| {
            let start = Instant::now();
            kernel.pairs_into(std::hint::black_box(points), out);
            start.elapsed().as_secs_f64()
        });
        Ok(fastest.fold(f64::INFINITY, f64::min))
    }
}
