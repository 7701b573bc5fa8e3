//! Whole numbers of an argument.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error;

/// Whole numbers of an argument, one for each point or for each row of points.
#[derive(Debug)]
pub(crate) struct Index<'py>(PyReadonlyArray1<'py, i64>);

impl<'py> Index<'py> {
    /// Reads an array of whole numbers; `argument` is its name.
    ///
    /// # Errors
    /// `fmc_camera.Layout` for other numbers or another shape.
    pub(crate) fn of(given: &Bound<'py, PyAny>, argument: &'static str) -> PyResult<Self> {
        if given.is_exact_instance_of::<PyUntypedArray>()
            && let Ok(array) = given.cast::<PyArray1<i64>>()
            && array.is_c_contiguous()
        {
            return Self::borrowed(array, argument);
        }
        if given.hasattr("mask")? {
            return Err(error::of_layout(argument, "a masked array"));
        }
        let numpy = given.py().import("numpy")?;
        let array = numpy.call_method1("asarray", (given,))?;
        let array = array.cast::<PyUntypedArray>()?;
        let kind: char = array.dtype().getattr("kind")?.extract()?;
        if array.ndim() != 1 || !matches!(kind, 'i' | 'u') && array.len() > 0 {
            let fault = format!(
                "{} dimensions of the type {}: must be one, of whole numbers",
                array.ndim(),
                array.dtype()
            );
            return Err(error::of_layout(argument, &fault));
        }
        let array = numpy.call_method1("ascontiguousarray", (array, "int64"))?;
        Self::borrowed(array.cast()?, argument)
    }

    fn borrowed(array: &Bound<'py, PyArray1<i64>>, argument: &'static str) -> PyResult<Self> {
        array
            .try_readonly()
            .map(Self)
            .map_err(|_| error::of_layout(argument, "in use by another call"))
    }

    pub(crate) fn numbers(&self) -> &[i64] {
        self.0.as_slice().unwrap_or_default()
    }
}
