//! Errors of the libraries as exceptions of Python, each with its numbers as attributes.

use std::io;
use std::path::Path;

use fmc_camera::flight::camera::FrameError;
use fmc_camera::geometry::calibration::{CalibrationError, Polynomial};
use fmc_camera::geometry::range::OutOfRange as RangeError;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_camera_file::InputError;
use fmc_output::error_number;
use fmc_points::PointError;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    fmc_camera,
    Error,
    PyValueError,
    "Error of this package: a ValueError whose sentence names what is wrong."
);
create_exception!(
    fmc_camera,
    OutOfRange,
    Error,
    "A number is outside its range: quantity, value, least, most."
);
create_exception!(
    fmc_camera,
    Folds,
    Error,
    "A polynomial folds the image: polynomial, scale, x_mm, y_mm."
);
create_exception!(
    fmc_camera,
    Stroke,
    Error,
    "The travel of an exposure leaves the stroke: from_mm, to_mm, half_stroke_mm."
);
create_exception!(
    fmc_camera,
    Speed,
    Error,
    "An exposure needs a higher speed than the stage has: wanted_mm_s, max_mm_s."
);
create_exception!(
    fmc_camera,
    Time,
    Error,
    "A travel takes longer than there is time: needed_s, available_s."
);
create_exception!(
    fmc_camera,
    NotFitted,
    Error,
    "The camera has no five-coefficient model."
);
create_exception!(
    fmc_camera,
    InvalidFile,
    Error,
    "A file or a table cannot be used: help, which may be None."
);
create_exception!(
    fmc_camera,
    Layout,
    Error,
    "An array has a shape, a type or a memory that is not possible here: argument."
);
create_exception!(
    fmc_camera,
    PointOffSensor,
    Error,
    "A point is off the sensor, or has no measured point on it: index, x_mm, y_mm."
);
create_exception!(
    fmc_camera,
    NoFrame,
    Error,
    "Records have no such frame: frame."
);

/// Adds the classes to the module.
pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    for (name, class) in [
        ("Error", py.get_type::<Error>()),
        ("OutOfRange", py.get_type::<OutOfRange>()),
        ("Folds", py.get_type::<Folds>()),
        ("Stroke", py.get_type::<Stroke>()),
        ("Speed", py.get_type::<Speed>()),
        ("Time", py.get_type::<Time>()),
        ("NotFitted", py.get_type::<NotFitted>()),
        ("InvalidFile", py.get_type::<InvalidFile>()),
        ("Layout", py.get_type::<Layout>()),
        ("NoFrame", py.get_type::<NoFrame>()),
        ("PointOffSensor", py.get_type::<PointOffSensor>()),
    ] {
        module.add(name, class)?;
    }
    Ok(())
}

/// Returns the error of a sentence alone.
pub(crate) fn of_text(text: impl Into<String>) -> PyErr {
    Error::new_err(text.into())
}

/// Returns the error of an array; `argument` is its name.
pub(crate) fn of_layout(argument: &'static str, fault: &str) -> PyErr {
    let error = Layout::new_err(format!("{argument}: {fault}"));
    with(error, &[("argument", argument.into())])
}

/// Returns the error of points that have no answers.
pub(crate) fn of_points(error: PointError) -> PyErr {
    let text = error.to_string();
    match error {
        PointError::OffSensor { index, point_mm } | PointError::NoMeasured { index, point_mm } => {
            let [x_mm, y_mm] = point_mm;
            let fields = [
                ("index", Field::Count(index)),
                ("x_mm", x_mm.into()),
                ("y_mm", y_mm.into()),
            ];
            with(PointOffSensor::new_err(text), &fields)
        }
        PointError::NoPlace { number, count, .. } => {
            let fields = [
                ("quantity", "index".into()),
                ("value", Field::Whole(number)),
                ("least", Field::Whole(0)),
                ("most", Field::Count(count.saturating_sub(1))),
            ];
            with(OutOfRange::new_err(text), &fields)
        }
        PointError::PrintedSign { .. } => of_text(text),
    }
}

/// Returns the error of a frame that there is not.
pub(crate) fn of_no_frame(text: String, frame: &str) -> PyErr {
    with(NoFrame::new_err(text), &[("frame", frame.into())])
}

/// Returns the error of an input file.
pub(crate) fn of_input(error: &InputError) -> PyErr {
    let help = error.help();
    let text = help.map_or_else(|| error.to_string(), |help| format!("{error} ({help})"));
    with(InvalidFile::new_err(text), &[("help", help.into())])
}

/// Returns the error of a file that cannot be written: Python's own.
pub(crate) fn of_writing(path: &Path, error: &io::Error) -> PyErr {
    let made = Python::attach(|py| {
        // Windows has numbers of its own.
        let number = error.raw_os_error().filter(|_| cfg!(not(windows)));
        let number = match (number, error_number::name(error)) {
            (Some(number), _) => number,
            (None, Some(name)) => py.import("errno")?.getattr(name)?.extract()?,
            (None, None) => {
                return Ok(PyOSError::new_err(format!("{}: {error}", path.display())));
            }
        };
        let text = py.import("os")?.call_method1("strerror", (number,))?;
        let arguments = (number, text.unbind(), path.display().to_string());
        Ok(PyOSError::new_err(arguments))
    });
    made.unwrap_or_else(|other: PyErr| other)
}

/// Returns the error of a calibration; `text` is its sentence.
pub(crate) fn of_calibration(error: &CalibrationError, text: String) -> PyErr {
    match error {
        CalibrationError::OutOfRange(range) => of_range(range, text),
        CalibrationError::Folds {
            polynomial,
            scale,
            at: SensorPoint { x_mm, y_mm },
        } => {
            let polynomial = match polynomial {
                Polynomial::Static => "static",
                Polynomial::Fitted => "fitted",
            };
            let fields = [
                ("polynomial", polynomial.into()),
                ("scale", (*scale).into()),
                ("x_mm", (*x_mm).into()),
                ("y_mm", (*y_mm).into()),
            ];
            with(Folds::new_err(text), &fields)
        }
    }
}

/// Returns the error of an exposure that the camera refuses.
pub(crate) fn of_frame(error: &FrameError) -> PyErr {
    let text = error.to_string();
    match error {
        FrameError::OutOfRange(range) => of_range(range, text),
        FrameError::Stroke(stroke) => {
            let fields = [
                ("from_mm", stroke.from_mm.into()),
                ("to_mm", stroke.to_mm.into()),
                ("half_stroke_mm", stroke.half_stroke_mm.into()),
            ];
            with(Stroke::new_err(text), &fields)
        }
        FrameError::NotFitted => NotFitted::new_err(text),
        FrameError::Speed {
            wanted_mm_s,
            max_mm_s,
        } => {
            let fields = [
                ("wanted_mm_s", (*wanted_mm_s).into()),
                ("max_mm_s", (*max_mm_s).into()),
            ];
            with(Speed::new_err(text), &fields)
        }
        FrameError::Time {
            needed_s,
            available_s,
        } => {
            let fields = [
                ("needed_s", (*needed_s).into()),
                ("available_s", (*available_s).into()),
            ];
            with(Time::new_err(text), &fields)
        }
    }
}

fn of_range(range: &RangeError, text: String) -> PyErr {
    let fields = [
        ("quantity", range.quantity.name().into()),
        ("value", range.value.into()),
        ("least", range.min.into()),
        ("most", range.max.into()),
    ];
    with(OutOfRange::new_err(text), &fields)
}

/// Returns the error of an argument outside its range.
pub(crate) fn of_argument(quantity: &'static str, value: f64, [least, most]: [f64; 2]) -> PyErr {
    let text = format!("{quantity} = {value} is outside {least} to {most}");
    let fields = [
        ("quantity", quantity.into()),
        ("value", value.into()),
        ("least", least.into()),
        ("most", most.into()),
    ];
    with(OutOfRange::new_err(text), &fields)
}

/// Value of an attribute.
enum Field {
    Text(Option<String>),
    Number(f64),
    Count(usize),
    Whole(i64),
}

impl From<&str> for Field {
    fn from(text: &str) -> Self {
        Self::Text(Some(text.to_owned()))
    }
}

impl From<Option<&str>> for Field {
    fn from(text: Option<&str>) -> Self {
        Self::Text(text.map(str::to_owned))
    }
}

impl From<f32> for Field {
    fn from(number: f32) -> Self {
        Self::Number(number.into())
    }
}

impl From<f64> for Field {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// Adds attributes to an exception.
fn with(error: PyErr, fields: &[(&str, Field)]) -> PyErr {
    let set = Python::attach(|py| {
        let value = error.value(py);
        fields.iter().try_for_each(|(name, field)| match field {
            Field::Text(text) => value.setattr(*name, text),
            Field::Number(number) => value.setattr(*name, number),
            Field::Count(count) => value.setattr(*name, count),
            Field::Whole(number) => value.setattr(*name, number),
        })
    });
    // An attribute that cannot be set leaves the sentence.
    set.map_or_else(|other| other, |()| error)
}
