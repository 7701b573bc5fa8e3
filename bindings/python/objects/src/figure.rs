//! Figures.

use std::path::PathBuf;

use fmc_output::part::Part;
use fmc_output::unfinished;
use fmc_report::figure::FigureError;
use fmc_report::page;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::error;

/// A figure in SVG, which a notebook shows.
#[pyclass(module = "fmc_camera", frozen)]
pub(crate) struct Figure {
    svg: String,
}

impl Figure {
    /// Takes a drawing.
    ///
    /// # Errors
    /// `fmc_camera.Error` for a drawing that has failed.
    pub(crate) fn of(drawn: Result<String, FigureError>) -> PyResult<Self> {
        let svg = drawn.map_err(|error| error::of_text(error.to_string()))?;
        Ok(Self { svg })
    }
}

#[pymethods]
impl Figure {
    #[staticmethod]
    fn _restored(svg: String) -> Self {
        Self { svg }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let restore = py.get_type::<Self>().getattr("_restored")?;
        (restore, (&self.svg,)).into_bound_py_any(py)
    }

    /// Text of the figure in SVG.
    #[getter]
    fn svg(&self) -> &str {
        &self.svg
    }

    /// Writes the figure into a file, which appears when it is complete.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "an argument of Python is converted into it"
    )]
    fn save(&self, path: PathBuf) -> PyResult<()> {
        let bytes = self.svg.as_bytes();
        let written = unfinished::write(&path, |sink| sink.write_all(bytes));
        let completed = written.and_then(|part| part.map_or(Ok(()), Part::complete));
        completed.map_err(|error| error::of_writing(&path, &error))
    }

    fn __repr__(&self) -> String {
        format!("<fmc_camera.Figure: SVG of {} bytes>", self.svg.len())
    }

    fn _repr_svg_(&self) -> &str {
        &self.svg
    }

    /// The figure as wide as the page is, and no wider than it was drawn.
    fn _repr_html_(&self) -> String {
        let svg = page::inline(self.svg.clone());
        let style = "max-width:calc(var(--width)*1px);width:100%;height:auto;--width:";
        svg.replacen("--width:", style, 1)
    }
}
