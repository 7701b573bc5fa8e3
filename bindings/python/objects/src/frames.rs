//! The frames of a flight.

use std::sync::Arc;

use fmc_camera::flight::time::Time;
use fmc_frames::{FrameRow, FrameTable};
use fmc_points::{ColumnPoints, Direction, Flight, FlightPoints, FrameCorrections, places};
use numpy::datetime::{Datetime, Timedelta, units::Microseconds};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::answer::answer as answer_of;
use crate::array::{self, Arguments};
use crate::camera::{Camera, CameraParts};
use crate::columns;
use crate::error;
use crate::index::Index;
use crate::off_sensor::off_sensor as off_sensor_of;
use crate::record_source;

/// Not a time, in NumPy.
const NO_TIME: i64 = i64::MIN;

/// The frames of a flight, by records or by a table of exposures.
#[pyclass(module = "fmc_camera", frozen)]
pub(crate) struct Frames {
    pub(crate) camera: Arc<CameraParts>,
    pub(crate) table: FrameTable,
    /// Name of the records in messages.
    pub(crate) name: String,
    corrections: FrameCorrections,
}

impl Frames {
    pub(crate) fn read(
        camera: &Arc<CameraParts>,
        records: &Bound<'_, PyAny>,
        images: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (table, name) = record_source::read(camera, records, images)?;
        Ok(Self {
            camera: Arc::clone(camera),
            table,
            name,
            corrections: FrameCorrections::default(),
        })
    }

    fn column<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        of: impl Fn(&FrameRow) -> T,
    ) -> Bound<'py, PyArray1<T>> {
        let column: Vec<T> = self.table.rows().iter().map(of).collect();
        column.into_pyarray(py)
    }

    /// Returns a number of the exposures, NaN for refused triggers.
    fn number<'py>(
        &self,
        py: Python<'py>,
        of: impl Fn(&FrameRow) -> f32,
    ) -> Bound<'py, PyArray1<f64>> {
        self.column(py, |row| {
            if row.is_refused() {
                f64::NAN
            } else {
                f64::from(of(row))
            }
        })
    }
}

#[pymethods]
impl Frames {
    fn __len__(&self) -> usize {
        self.table.rows().len()
    }

    fn __repr__(&self) -> String {
        let rows = self.table.rows();
        let refused = rows.iter().filter(|row| row.is_refused()).count();
        format!(
            "<fmc_camera.Frames of {:?}: {} triggers, {refused} of them refused>",
            self.camera.file.name,
            rows.len()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let camera = Camera {
            parts: Arc::clone(&self.camera),
        };
        let bytes = postcard::to_allocvec(&self.table)
            .map_err(|error| error::of_text(format!("frames cannot be packed: {error}")))?;
        let restore = py.get_type::<Self>().getattr("_restored")?;
        let packed = (camera, PyBytes::new(py, &bytes), &self.name);
        (restore, packed).into_bound_py_any(py)
    }

    #[staticmethod]
    fn _restored(camera: &Bound<'_, Camera>, table: &[u8], name: String) -> PyResult<Self> {
        let table = postcard::from_bytes(table)
            .map_err(|error| error::of_text(format!("frames of another version: {error}")))?;
        Ok(Self {
            camera: Arc::clone(&camera.get().parts),
            table,
            name,
            corrections: FrameCorrections::default(),
        })
    }

    /// Sequence numbers of the triggers, ascending.
    #[getter]
    fn sequence<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        self.column(py, |row| row.sequence)
    }

    /// True for exposures, false for refused triggers.
    #[getter]
    fn is_exposed<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        self.column(py, |row| !row.is_refused())
    }

    /// Reasons of the refused triggers, None for exposures.
    #[getter]
    fn reasons(&self) -> Vec<Option<&str>> {
        let rows = self.table.rows().iter();
        rows.map(|row| self.table.reason_of(row)).collect()
    }

    /// Principal points at the centroids of the exposures, (N, 2), sensor frame, mm.
    #[getter]
    fn principal_point_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let ([x, y], [ex, ey]) = (
            self.camera.file.principal_point_mm,
            self.camera.file.fmc.axis.unit(),
        );
        let points = self.table.rows().iter().flat_map(|row| {
            let offset_mm = if row.is_refused() {
                f64::NAN
            } else {
                f64::from(row.motion.centroid_mm)
            };
            // The refused have no principal point, on neither axis.
            [x + offset_mm * ex, y + offset_mm * ey]
        });
        let points: Vec<f64> = points.collect();
        points.into_pyarray(py).reshape([self.__len__(), 2])
    }

    /// σ of the principal points along the FMC axis, mm; NaN where none is stated.
    #[getter]
    fn principal_point_sigma_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.number(py, |row| {
            row.sigma().map_or(f32::NAN, |sigma| sigma.total_mm())
        })
    }

    /// The part of σ that is a frame's own, mm.
    #[getter]
    fn principal_point_frame_sigma_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.number(py, |row| {
            row.sigma().map_or(f32::NAN, |sigma| sigma.frame_mm)
        })
    }

    /// The part of σ that all frames of the flight have in common, mm.
    #[getter]
    fn principal_point_common_sigma_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.number(py, |row| {
            row.sigma().map_or(f32::NAN, |sigma| sigma.common_mm)
        })
    }

    /// Offsets of the principal points at the centroids, mm along the FMC axis.
    #[getter]
    fn centroid_offset_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.number(py, |row| row.motion.centroid_mm)
    }

    /// Travel δ of the principal points while the shutter was open, mm along the FMC axis.
    #[getter]
    fn travel_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.number(py, |row| row.motion.travel_mm)
    }

    /// Centroids of the exposures, camera time.
    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<Timedelta<Microseconds>>> {
        self.column(py, |row| time(row.centroid().map(Time::us)).into())
    }

    /// Centroids of the exposures in UTC.
    #[getter]
    fn centroid_utc<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<Datetime<Microseconds>>> {
        self.column(py, |row| {
            time(row.centroid_utc().map(|utc| utc.unix_us)).into()
        })
    }

    /// σ of the centroids in UTC, s.
    #[getter]
    fn utc_sigma_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.number(py, |row| {
            row.centroid_utc().map_or(f32::NAN, |utc| utc.sigma_s)
        })
    }

    /// Returns the places of frames by their sequence numbers.
    fn find<'py>(
        &self,
        py: Python<'py>,
        sequence: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let sequence = Index::of(sequence, "sequence")?;
        let places: PyResult<Vec<i64>> = sequence
            .numbers()
            .iter()
            .map(|number| {
                let found = u32::try_from(*number).ok();
                let found = found.and_then(|number| self.table.find(number));
                found
                    .and_then(|place| i64::try_from(place).ok())
                    .ok_or_else(|| self.no_frame(&number.to_string()))
            })
            .collect();
        Ok(places?.into_pyarray(py))
    }

    /// Returns the places of frames by sequence numbers, or by names of images; -1 where there is
    /// none.
    fn _places<'py>(
        &self,
        py: Python<'py>,
        names: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let place = |found: Option<usize>| {
            found
                .and_then(|place| i64::try_from(place).ok())
                .unwrap_or(-1)
        };
        let places: Vec<i64> = if let Ok(names) = names.extract::<Vec<String>>() {
            // A name of digits is a sequence number, as in files of points.
            let find = |name: &String| match name.parse() {
                Ok(sequence) => self.table.find(sequence),
                Err(_) => self.table.find_image(name),
            };
            names.iter().map(|name| place(find(name))).collect()
        } else {
            let numbers = Index::of(names, "frame")?;
            let numbers = numbers.numbers();
            let find = |number: i64| self.table.find(u32::try_from(number).ok()?);
            py.detach(|| places(numbers, &|number| place(find(number))))
        };
        Ok(places.into_pyarray(py))
    }

    /// Returns x, y and flags of the points of a table by the places of their frames.
    fn _columns<'py>(
        &self,
        x: &Bound<'py, PyAny>,
        y: &Bound<'py, PyAny>,
        places: &Bound<'py, PyAny>,
        answer: &str,
        is_distorted: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let places = Index::of(places, "frame")?;
        let points = ColumnPoints {
            flight: self.flight(),
            direction: if is_distorted {
                Direction::Distort
            } else {
                Direction::Correct
            },
            answer: answer_of(answer)?,
        };
        columns::answered(&points, [x, y], places.numbers())
    }

    /// Returns the ideal points of the measured points of many frames.
    #[pyo3(signature = (
        points, index, *, answer = "ideal", out = None, inplace = false,
        off_sensor = "extrapolate",
    ))]
    fn correct<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        index: &Bound<'py, PyAny>,
        answer: &str,
        out: Option<&Bound<'py, PyAny>>,
        inplace: bool,
        off_sensor: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = Arguments::new(points, out, inplace);
        self.answered(&arguments, index, Direction::Correct, [answer, off_sensor])
    }

    /// Returns the measured points of points that `correct` has answered with.
    #[pyo3(signature = (
        points, index, *, answer = "ideal", out = None, inplace = false, off_sensor = "nan",
    ))]
    fn distort<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        index: &Bound<'py, PyAny>,
        answer: &str,
        out: Option<&Bound<'py, PyAny>>,
        inplace: bool,
        off_sensor: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arguments = Arguments::new(points, out, inplace);
        self.answered(&arguments, index, Direction::Distort, [answer, off_sensor])
    }
}

impl Frames {
    fn answered<'py>(
        &self,
        arguments: &Arguments<'_, 'py>,
        index: &Bound<'py, PyAny>,
        direction: Direction,
        [answer, off_sensor]: [&str; 2],
    ) -> PyResult<Bound<'py, PyAny>> {
        let index = Index::of(index, "index")?;
        let mut work = FlightPoints {
            flight: self.flight(),
            index: index.numbers(),
            direction,
            answer: answer_of(answer)?,
            off_sensor: off_sensor_of(off_sensor)?,
            each: 1,
        };
        array::answered(arguments, &mut work)
    }

    fn flight(&self) -> Flight<'_> {
        Flight {
            camera: self.camera.of_flight(),
            table: &self.table,
            corrections: &self.corrections,
        }
    }

    /// Returns the error of a frame that is not among these.
    pub(crate) fn no_frame(&self, frame: &str) -> PyErr {
        let rows = self.table.rows();
        let [first, last] =
            [rows.first(), rows.last()].map(|row| row.map_or(0, |row| row.sequence));
        let text = format!(
            "frame {frame}: {} has no such frame; its sequence numbers are {first} to {last}",
            self.name
        );
        error::of_no_frame(text, frame)
    }
}

/// Returns a time as NumPy has it.
fn time(us: Option<u64>) -> i64 {
    us.and_then(|us| i64::try_from(us).ok()).unwrap_or(NO_TIME)
}
