//! Points whose coordinates lie in columns of their own, as tables of Arrow have them.

use fmc_points::{ColumnPoints, Coordinate, FlaggedColumns, PointError};
use numpy::{Element, IntoPyArray, PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::error;

/// Returns x, y and flags of the answers to points. `places` are those of their frames; one that is
/// none is no frame.
///
/// # Errors
/// `fmc_camera.Layout` for columns of other types or of different lengths.
pub(crate) fn answered<'py>(
    points: &ColumnPoints<'_>,
    [x, y]: [&Bound<'py, PyAny>; 2],
    places: &[i64],
) -> PyResult<Bound<'py, PyAny>> {
    if let (Ok(x), Ok(y)) = (x.cast::<PyArray1<f32>>(), y.cast::<PyArray1<f32>>()) {
        return typed([x, y], places, |columns| points.singles(columns, places));
    }
    if let (Ok(x), Ok(y)) = (x.cast::<PyArray1<f64>>(), y.cast::<PyArray1<f64>>()) {
        return typed([x, y], places, |columns| points.doubles(columns, places));
    }
    Err(error::of_layout(
        "points",
        "both columns must be float32, or both float64",
    ))
}

fn typed<'py, T: Coordinate + Element>(
    columns: [&Bound<'py, PyArray1<T>>; 2],
    places: &[i64],
    compute: impl Fn([&[T]; 2]) -> Result<FlaggedColumns<T>, PointError> + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let [x, y] = columns;
    let borrowed = |column: &Bound<'py, PyArray1<T>>| {
        column
            .try_readonly()
            .map_err(|_| error::of_layout("points", "in use by another call"))
    };
    let (x, y): (PyReadonlyArray1<'_, T>, PyReadonlyArray1<'_, T>) = (borrowed(x)?, borrowed(y)?);
    let contiguous = |_| error::of_layout("points", "not contiguous");
    let xs = x.as_slice().map_err(contiguous)?;
    let ys = y.as_slice().map_err(contiguous)?;
    if xs.len() != places.len() || ys.len() != places.len() {
        return Err(error::of_layout("points", "columns of different lengths"));
    }
    let py = columns[0].py();
    let FlaggedColumns { x, y, flags } =
        py.detach(|| compute([xs, ys])).map_err(error::of_points)?;
    (
        x.into_pyarray(py),
        y.into_pyarray(py),
        flags.into_pyarray(py),
    )
        .into_bound_py_any(py)
}
