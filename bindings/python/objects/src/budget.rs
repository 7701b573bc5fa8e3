//! The error budget of a camera.

use std::sync::Arc;

use fmc_camera_file::CameraFile;
use fmc_report::budget::summary::{Summary, TermSummary};
use fmc_report::budget::{dots, page, table};
use fmc_simulation::budget::assumptions::Stated;
use fmc_simulation::budget::result::Budget as Computed;
use fmc_simulation::budget::run;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::camera::{Camera, CameraParts};
use crate::error;
use crate::figure::Figure;

/// Assumptions, in the order of the arguments.
type Numbers = (f64, f64, f64, f64, f64, f64, f64, f64);

/// The largest effect of each source of error over the exposures of a camera.
#[pyclass(module = "fmc_camera", frozen)]
pub(crate) struct Budget {
    camera: Arc<CameraParts>,
    stated: Stated,
    budget: Computed,
}

impl Budget {
    /// Computes the budget of a camera.
    ///
    /// # Errors
    /// `fmc_camera.OutOfRange` for an assumption, `fmc_camera.InvalidFile` for a camera with
    /// residual grids, `fmc_camera.Error` for one whose limits allow no exposure.
    pub(crate) fn new(camera: &Arc<CameraParts>, stated: Stated) -> PyResult<Self> {
        if let Some((quantity, value)) = stated.outside() {
            let range = [quantity.least, quantity.most];
            return Err(error::of_argument(quantity.name, value, range));
        }
        let (name, text) = (&camera.name, &camera.text);
        let (file, _) = CameraFile::parse_polynomial(name, text, run::WITHOUT_GRIDS)
            .map_err(|error| error::of_input(&error))?;
        let budget = run::budget(&file, stated.into())
            .map_err(|error| error::of_text(format!("{name}: {error}")))?;
        Ok(Self {
            camera: Arc::clone(camera),
            stated,
            budget,
        })
    }
}

#[pymethods]
impl Budget {
    #[staticmethod]
    fn _restored(camera: &Bound<'_, Camera>, numbers: Numbers) -> PyResult<Self> {
        Self::new(&camera.get().parts, stated(numbers))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let camera = Camera {
            parts: Arc::clone(&self.camera),
        };
        let given = self.stated;
        let numbers: Numbers = (
            given.height_m,
            given.focus_um,
            given.vh_error_percent,
            given.relief_percent,
            given.drift_deg,
            given.rate_deg_s,
            given.encoder_um,
            given.timing_ms,
        );
        let restore = py.get_type::<Self>().getattr("_restored")?;
        (restore, (camera, numbers)).into_bound_py_any(py)
    }

    /// Name of the camera.
    #[getter]
    fn camera(&self) -> &str {
        &self.budget.camera
    }

    /// Height above the ground, m.
    #[getter]
    fn height_m(&self) -> f64 {
        self.stated.height_m
    }

    /// The terms, the largest first, each a dictionary.
    #[getter]
    fn terms<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let terms = Summary::of(&self.budget).terms;
        terms.iter().map(|term| dictionary(py, term)).collect()
    }

    /// Draws the terms as dots on a logarithmic axis.
    fn plot(&self) -> PyResult<Figure> {
        Figure::of(dots::svg(&self.budget))
    }

    fn __repr__(&self) -> String {
        table::text(&self.budget).trim_end().to_owned()
    }

    fn _repr_html_(&self) -> PyResult<String> {
        page::rows(&self.budget).map_err(|error| error::of_text(error.to_string()))
    }
}

fn dictionary<'py>(py: Python<'py>, term: &TermSummary) -> PyResult<Bound<'py, PyDict>> {
    let fields = PyDict::new(py);
    fields.set_item("source", term.source)?;
    fields.set_item("kind", term.kind)?;
    fields.set_item("removed", term.removed)?;
    fields.set_item("paper_um", term.paper_um)?;
    fields.set_item("limits_um", term.limits_um)?;
    fields.set_item("limits_px", term.limits_px)?;
    fields.set_item("limits_ground_cm", term.limits_ground_cm)?;
    Ok(fields)
}

/// Returns the assumptions of the numbers.
fn stated(numbers: Numbers) -> Stated {
    let (height_m, focus_um, vh_error_percent, relief_percent, ..) = numbers;
    let (.., drift_deg, rate_deg_s, encoder_um, timing_ms) = numbers;
    Stated {
        height_m,
        focus_um,
        vh_error_percent,
        relief_percent,
        drift_deg,
        rate_deg_s,
        encoder_um,
        timing_ms,
    }
}
