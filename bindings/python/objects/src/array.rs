//! Arrays of points: their layout is checked, and what is contiguous is not copied.

use std::ops::Range;

use fmc_points::{Answers, Coordinate, Points, PointsMut};
use numpy::{
    BorrowError, Element, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::error;

/// Points that are computed before a signal is looked for: some milliseconds.
const BETWEEN_SIGNALS: usize = 1 << 22;

/// Numbers from which on an array may need more memory than there is: 8 MB in double precision.
const LARGE: usize = 1 << 20;

/// Points, and where their answers go.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arguments<'a, 'py> {
    pub(crate) points: &'a Bound<'py, PyAny>,
    pub(crate) out: Option<&'a Bound<'py, PyAny>>,
    pub(crate) inplace: bool,
}

impl<'a, 'py> Arguments<'a, 'py> {
    pub(crate) const fn new(
        points: &'a Bound<'py, PyAny>,
        out: Option<&'a Bound<'py, PyAny>>,
        inplace: bool,
    ) -> Self {
        Self {
            points,
            out,
            inplace,
        }
    }
}

/// A computation on points.
pub(crate) trait Work: Sync {
    /// Checks the shape of an array of points.
    ///
    /// # Errors
    /// `fmc_camera.Layout`.
    fn check_shape(&mut self, shape: &[usize]) -> PyResult<()> {
        match shape {
            [_, 2] => Ok(()),
            _ => Err(of_shape(shape, "(N, 2)")),
        }
    }

    /// Checks points before any answer is written.
    ///
    /// # Errors
    /// Those of a point.
    fn check(&self, points: Points<'_>) -> PyResult<()>;

    /// Replaces points by their answers; the first is that with the number `from`.
    fn replace(&self, from: usize, points: PointsMut<'_>);

    /// Writes the answers to points, of which the first is that with the number `from`.
    fn write(&self, from: usize, answers: Answers<'_>);
}

/// Returns the error of a shape.
pub(crate) fn of_shape(shape: &[usize], allowed: &str) -> PyErr {
    let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
    let fault = format!("shape ({}): must be {allowed}", shape.join(", "));
    error::of_layout("points", &fault)
}

/// Returns the answers to points, in an array of their own, in `out`, or in their place.
///
/// # Errors
/// `fmc_camera.Layout` for an array that is not possible, and the errors of the points.
pub(crate) fn answered<'py>(
    arguments: &Arguments<'_, 'py>,
    work: &mut dyn Work,
) -> PyResult<Bound<'py, PyAny>> {
    let given = arguments.points;
    if let Ok(points) = given.cast_exact::<PyUntypedArray>() {
        return of_type(points, arguments, work);
    }
    // Numbers under a mask are no points, and a copy would forget the mask.
    if given.hasattr("mask")? {
        return Err(error::of_layout(
            "points",
            "a masked array; fill it, or take its valid rows",
        ));
    }
    if arguments.inplace {
        return Err(error::of_layout(
            "points",
            "not an array of NumPy: inplace=True replaces its numbers",
        ));
    }
    let array = given
        .py()
        .import("numpy")?
        .call_method1("asarray", (given,))?;
    of_type(array.cast()?, arguments, work)
}

fn of_type<'py>(
    points: &Bound<'py, PyUntypedArray>,
    arguments: &Arguments<'_, 'py>,
    work: &mut dyn Work,
) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(points) = points.cast::<PyArrayDyn<f32>>() {
        return typed(points, arguments, work);
    }
    if let Ok(points) = points.cast::<PyArrayDyn<f64>>() {
        return typed(points, arguments, work);
    }
    Err(of_dtype("points", points))
}

/// Returns the error of a type of numbers.
fn of_dtype(argument: &'static str, array: &Bound<'_, PyUntypedArray>) -> PyErr {
    let fault = format!(
        "numbers of the type {}: must be float32 or float64 in this machine's byte order",
        array.dtype()
    );
    error::of_layout(argument, &fault)
}

fn typed<'py, T: Coordinate + Element>(
    points: &Bound<'py, PyArrayDyn<T>>,
    arguments: &Arguments<'_, 'py>,
    work: &mut dyn Work,
) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    work.check_shape(points.shape())?;
    let work = &*work;
    if arguments.inplace {
        if arguments.out.is_some() {
            return Err(error::of_layout("out", "given with inplace=True"));
        }
        if !points.is_c_contiguous() {
            return Err(not_contiguous("points"));
        }
        let mut borrowed = points
            .try_readwrite()
            .map_err(|error| of_borrow("points", &error))?;
        let numbers = borrowed
            .as_slice_mut()
            .map_err(|_| not_contiguous("points"))?;
        let (pairs, _) = numbers.as_chunks_mut::<2>();
        for_parts(py, pairs.len(), |part| {
            let from = part.start;
            if from == 0 {
                work.check(T::points(pairs))?;
            }
            let pairs = pairs.get_mut(part).unwrap_or_default();
            work.replace(from, T::points_mut(pairs));
            Ok(())
        })?;
        return Ok(points.clone().into_any());
    }
    let given = if points.is_c_contiguous() && points.data().is_aligned() {
        points.clone()
    } else if arguments.out.is_some() {
        return Err(error::of_layout(
            "points",
            "not contiguous in C order, or not aligned: they would be copied, which out= is to avoid; \
             points.copy() copies them",
        ));
    } else {
        let copy = points.call_method1("copy", ("C",))?;
        copy.cast_into::<PyArrayDyn<T>>()?
    };
    let answers = match arguments.out {
        Some(out) => place(out, points)?,
        None => room(points)?,
    };
    let given = given
        .try_readonly()
        .map_err(|error| of_borrow("points", &error))?;
    let (given, _) = given
        .as_slice()
        .map_err(|_| not_contiguous("points"))?
        .as_chunks::<2>();
    let mut borrowed = answers
        .try_readwrite()
        .map_err(|error| of_borrow("out", &error))?;
    let numbers = borrowed.as_slice_mut().map_err(|_| not_contiguous("out"))?;
    let (pairs, _) = numbers.as_chunks_mut::<2>();
    for_parts(py, given.len(), |part| {
        let from = part.start;
        if from == 0 {
            work.check(T::points(given))?;
        }
        let given = given.get(part.clone()).unwrap_or_default();
        let pairs = pairs.get_mut(part).unwrap_or_default();
        work.write(from, T::answers(given, pairs));
        Ok(())
    })?;
    drop(borrowed);
    Ok(answers.into_any())
}

/// Returns new memory for the answers to points.
///
/// # Errors
/// `MemoryError`.
fn room<'py, T: Coordinate + Element>(
    points: &Bound<'py, PyArrayDyn<T>>,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let py = points.py();
    if points.len() < LARGE {
        return Ok(PyArrayDyn::zeros(py, points.shape(), false));
    }
    // NumPy itself says that there is too little memory; the binding would panic.
    let shape = PyTuple::new(py, points.shape())?;
    let made = py
        .import("numpy")?
        .call_method1("zeros", (shape, points.dtype()))?;
    Ok(made.cast_into::<PyArrayDyn<T>>()?)
}

/// Returns `out` as the place of the answers to points.
fn place<'py, T: Coordinate + Element>(
    out: &Bound<'py, PyAny>,
    points: &Bound<'py, PyArrayDyn<T>>,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let array = out
        .cast_exact::<PyUntypedArray>()
        .map_err(|_| error::of_layout("out", "not an array of NumPy"))?;
    let Ok(place) = array.cast::<PyArrayDyn<T>>() else {
        let fault = format!(
            "numbers of the type {}: must be {}",
            array.dtype(),
            points.dtype()
        );
        return Err(error::of_layout("out", &fault));
    };
    if place.shape() != points.shape() {
        let fault = format!(
            "shape {:?}: must be that of the points, {:?}",
            place.shape(),
            points.shape()
        );
        return Err(error::of_layout("out", &fault));
    }
    if !place.is_c_contiguous() {
        return Err(not_contiguous("out"));
    }
    let reach = |array: &Bound<'py, PyArrayDyn<T>>| {
        let start = array.data().addr();
        start..start + size_of::<T>() * array.len()
    };
    // The memory of points that are not contiguous is wider; they are refused all the same.
    if overlap(&reach(place), &reach(points)) {
        return Err(error::of_layout(
            "out",
            "shares memory with points; inplace=True replaces points by their answers",
        ));
    }
    Ok(place.clone())
}

fn overlap(one: &Range<usize>, other: &Range<usize>) -> bool {
    one.start < other.end && other.start < one.end
}

fn not_contiguous(argument: &'static str) -> PyErr {
    error::of_layout(argument, "not contiguous in C order, or not aligned")
}

/// Returns the error of an array that cannot be used.
fn of_borrow(argument: &'static str, error: &BorrowError) -> PyErr {
    error::of_layout(
        argument,
        match error {
            BorrowError::NotWriteable => "read-only",
            _ => "in use by another call, or shares memory with an array that is",
        },
    )
}

/// Computes in parts, while other threads of Python run; a signal ends it between two of them.
fn for_parts(
    py: Python<'_>,
    count: usize,
    mut compute: impl FnMut(Range<usize>) -> PyResult<()> + Send,
) -> PyResult<()> {
    let mut start = 0;
    while start < count {
        let end = count.min(start + BETWEEN_SIGNALS);
        py.detach(|| compute(start..end))?;
        if end < count {
            py.check_signals()?;
        }
        start = end;
    }
    Ok(())
}
