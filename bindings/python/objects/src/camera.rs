//! The camera of a camera file.

use std::collections::HashMap;
use std::ffi::CString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fmc_camera::Camera as CheckedCamera;
use fmc_camera::geometry::camera_grids::CameraGrids;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::{CameraFile, GridFiles, InputError};
use fmc_frames::FrameCamera;
use fmc_points::FlightCamera;
use fmc_simulation::budget::assumptions::Stated;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use self_cell::self_cell;

use crate::array::{self, Arguments};
use crate::budget::Budget;
use crate::camera_keys;
use crate::error;
use crate::export::{self, Options};
use crate::exposure::{ExposureArguments, Words};
use crate::figure::Figure;
use crate::frame::Frame;
use crate::frames::Frames;
use crate::plot;
use crate::reference::ReferencePoints;

self_cell!(
    /// Residual grids with the bytes of their files, from which they borrow.
    struct OwnedGrids {
        owner: GridFiles,
        #[covariant]
        dependent: CameraGrids,
    }
);

/// A camera file, its validated camera, and its residual grids.
pub(crate) struct CameraParts {
    /// Name of the file in messages.
    pub(crate) name: String,
    /// Text of the file.
    pub(crate) text: String,
    pub(crate) file: CameraFile,
    pub(crate) camera: FrameCamera,
    grids: OwnedGrids,
}

impl CameraParts {
    /// Reads the text of a camera file whose residual grids `read` returns by their names.
    fn new(
        name: String,
        text: String,
        read: &dyn Fn(&str) -> Result<Vec<u8>, InputError>,
    ) -> PyResult<Self> {
        let (file, _, files) = CameraFile::parse_with_grids(&name, &text, read)
            .map_err(|error| refused(&text, &error))?;
        let camera = FrameCamera::with_grids(&name, &file, files.clone())
            .map_err(|error| error::of_input(&error))?;
        let grids = OwnedGrids::try_new(files, |files| files.grids(camera.calibration()))
            .map_err(|error| error::of_text(format!("{name}: {error}")))?;
        Ok(Self {
            name,
            text,
            file,
            camera,
            grids,
        })
    }

    /// Residual grids; a camera without has empty ones.
    pub(crate) fn grids(&self) -> &CameraGrids<'_> {
        self.grids.borrow_dependent()
    }

    /// Returns the bytes of the files of its residual grids by their names.
    pub(crate) fn grid_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let grids = PyDict::new(py);
        for carrier in [GridCarrier::Lens, GridCarrier::Sensor] {
            let bytes = self.grids.borrow_owner().bytes(carrier);
            if let (Some(name), Some(bytes)) = (self.file.grid_name(carrier), bytes) {
                grids.set_item(name, PyBytes::new(py, bytes))?;
            }
        }
        Ok(grids)
    }

    /// Returns true for a camera without residual grids.
    pub(crate) fn is_polynomial(&self) -> bool {
        self.grids.borrow_owner().is_empty()
    }

    /// Returns what the points of a flight need of the camera.
    pub(crate) fn of_flight(&self) -> FlightCamera<'_> {
        FlightCamera {
            calibration: self.camera.calibration(),
            grids: self.grids(),
            principal_point_mm: self.file.principal_point_mm,
        }
    }
}

/// Returns the error of a camera file, as that of the number or the polynomial that is wrong where
/// there is one.
fn refused(text: &str, error: &InputError) -> PyErr {
    let cause = toml::from_str::<CameraFile>(text)
        .ok()
        .and_then(|file| CheckedCamera::new(file.parameters()).err());
    match cause {
        Some(cause) => error::of_calibration(&cause, error.to_string()),
        None => error::of_input(error),
    }
}

/// A camera as its file describes it: lens, sensor, mechanism, shutter and limits.
#[pyclass(module = "fmc_camera", frozen)]
pub(crate) struct Camera {
    pub(crate) parts: Arc<CameraParts>,
}

#[pymethods]
impl Camera {
    /// Reads a camera file (TOML) with the residual grids that it names.
    #[staticmethod]
    #[expect(
        clippy::needless_pass_by_value,
        reason = "an argument of Python is converted into it"
    )]
    fn from_toml(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let name = path.display().to_string();
        let text = fs::read_to_string(&path)
            .map_err(|error| error::of_input(&InputError::reading(&path, &error)))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let parts = CameraParts::new(name, text, &|name| {
            let path = folder.join(name);
            fs::read(&path).map_err(|error| InputError::reading(&path, &error))
        })?;
        if let Some(warning) = parts.file.distortion_warning() {
            let text = CString::new(format!("{}: {warning}", parts.name))?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
        }
        Ok(Self {
            parts: Arc::new(parts),
        })
    }

    /// Returns the camera of a text and of the bytes of its residual grids: that which pickle
    /// restores.
    #[staticmethod]
    #[pyo3(signature = (text, name = "camera.toml", grids = None))]
    fn from_text(
        text: String,
        name: &str,
        grids: Option<HashMap<String, Vec<u8>>>,
    ) -> PyResult<Self> {
        let grids = grids.unwrap_or_default();
        let parts = CameraParts::new(name.to_owned(), text, &|grid| {
            let bytes = grids.get(grid).cloned();
            bytes.ok_or_else(|| {
                InputError::invalid(format!("{name}: the grid {grid} is not among the grids"))
            })
        })?;
        Ok(Self {
            parts: Arc::new(parts),
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = &self.parts;
        let grids = parts.grid_bytes(py)?;
        let restore = py.get_type::<Self>().getattr("from_text")?;
        (restore, (&parts.text, &parts.name, grids)).into_bound_py_any(py)
    }

    /// Name of the camera.
    #[getter]
    fn name(&self) -> &str {
        &self.parts.file.name
    }

    /// Principal distance f, mm.
    #[getter]
    fn principal_distance_mm(&self) -> f64 {
        self.parts.file.principal_distance_mm
    }

    /// Calibrated principal point (x, y) in the sensor frame, mm.
    #[getter]
    fn principal_point_mm(&self) -> (f64, f64) {
        let [x, y] = self.parts.file.principal_point_mm;
        (x, y)
    }

    /// Columns and rows of the sensor.
    #[getter]
    fn size_px(&self) -> (i64, i64) {
        let sensor = &self.parts.file.sensor;
        (sensor.width_px, sensor.height_px)
    }

    /// Pixel pitch, µm.
    #[getter]
    fn pixel_um(&self) -> f64 {
        self.parts.file.sensor.pixel_um
    }

    /// CRC-32 of the calibration, as the records of a flight have it.
    #[getter]
    fn calibration_crc32(&self) -> String {
        format!("{:08x}", self.parts.camera.crc())
    }

    /// Every key of the camera file with its value, defaults included.
    fn keys<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        camera_keys::dictionary(py, &self.parts.file)
    }

    fn __repr__(&self) -> String {
        let file = &self.parts.file;
        let grids = if self.parts.is_polynomial() {
            ""
        } else {
            ", residual grids"
        };
        format!(
            "<fmc_camera.Camera {:?}: f {} mm, {} x {} px of {} µm{grids}>",
            file.name,
            file.principal_distance_mm,
            file.sensor.width_px,
            file.sensor.height_px,
            file.sensor.pixel_um
        )
    }

    fn _repr_html_(&self) -> String {
        camera_keys::html(&self.parts.file)
    }

    /// Predicts the frame of an exposure.
    #[pyo3(signature = (
        vh, exposure_s, *, direction = "forward", focus_shift_um = 0.0, opening_offset_mm = None,
        focus_sign = "physical", model = "exact",
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are the options of the exposure, by name"
    )]
    fn frame(
        &self,
        vh: f64,
        exposure_s: f64,
        direction: &str,
        focus_shift_um: f64,
        opening_offset_mm: Option<f64>,
        focus_sign: &str,
        model: &str,
    ) -> PyResult<Frame> {
        let words = Words {
            direction,
            focus_sign,
            model,
        };
        let (direction, focus_sign, model) = words.read()?;
        let arguments = ExposureArguments {
            vh_per_s: vh,
            exposure_s,
            direction,
            focus_shift_um,
            opening_offset_mm,
            focus_sign,
            model,
        };
        Frame::new(&self.parts, arguments)
    }

    /// Reads the frames of a flight: records, or a table of exposures.
    #[pyo3(signature = (records, *, images = None))]
    fn frames(
        &self,
        records: &Bound<'_, PyAny>,
        images: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Frames> {
        Frames::read(&self.parts, records, images)
    }

    /// Returns the ideal points of the measured points of a frame by the strict solver, in double
    /// precision by quadrature.
    #[pyo3(signature = (points, frame, *, out = None, inplace = false))]
    fn reference<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        frame: &Frame,
        out: Option<&Bound<'py, PyAny>>,
        inplace: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.check_is_of(frame)?;
        let arguments = Arguments::new(points, out, inplace);
        array::answered(&arguments, &mut ReferencePoints::new(frame))
    }

    /// Computes the largest effect of each source of error over the exposures of the camera.
    #[pyo3(signature = (
        *, height_m = 1000.0, focus_um = 5.0, vh_error_percent = 1.0, relief_percent = 10.0,
        drift_deg = 1.0, rate_deg_s = 1.0, encoder_um = 1.0, timing_ms = 0.1,
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are assumptions, by name")]
    fn budget(
        &self,
        py: Python<'_>,
        height_m: f64,
        focus_um: f64,
        vh_error_percent: f64,
        relief_percent: f64,
        drift_deg: f64,
        rate_deg_s: f64,
        encoder_um: f64,
        timing_ms: f64,
    ) -> PyResult<Budget> {
        let stated = Stated {
            height_m,
            focus_um,
            vh_error_percent,
            relief_percent,
            drift_deg,
            rate_deg_s,
            encoder_um,
            timing_ms,
        };
        py.detach(|| Budget::new(&self.parts, stated))
    }

    /// Writes the calibration, or the frames of a flight, as another program's files into a folder,
    /// and returns what they hold.
    #[pyo3(signature = (
        program, folder, *, model = None, container = None, binary = false, id = None,
        max_residual_um = None, records = None, images = None, overwrite = false,
    ))]
    #[expect(clippy::too_many_arguments, reason = "they are options, by name")]
    fn export<'py>(
        &self,
        py: Python<'py>,
        program: String,
        folder: PathBuf,
        model: Option<String>,
        container: Option<String>,
        binary: bool,
        id: Option<String>,
        max_residual_um: Option<f64>,
        records: Option<&Bound<'py, PyAny>>,
        images: Option<&Bound<'py, PyAny>>,
        overwrite: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = Options {
            model,
            container,
            binary,
            id,
            max_residual_um,
            records,
            images,
            overwrite,
        };
        export::export(py, &self.parts, program, folder, options)
    }

    /// Draws the static distortion over the sensor, or what an exposure changes of it.
    #[pyo3(signature = (frame = None))]
    fn plot(&self, py: Python<'_>, frame: Option<&Bound<'_, Frame>>) -> PyResult<Figure> {
        let frame = frame.map(Bound::get);
        if let Some(frame) = frame {
            self.check_is_of(frame)?;
        }
        py.detach(|| plot::plot(&self.parts, frame))
    }
}

impl Camera {
    /// Refuses a frame of another camera.
    fn check_is_of(&self, frame: &Frame) -> PyResult<()> {
        if frame.camera.camera.crc() != self.parts.camera.crc() {
            return Err(error::of_text("frame: of another camera than this one"));
        }
        Ok(())
    }
}
