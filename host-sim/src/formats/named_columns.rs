//! Reader of CSV with named columns, for observations of calibrations.

use std::io::Read as _;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use fmc_adjustment::calibration::result::InputFile;
use fmc_adjustment::observation::UNIT_SIGMA_MM;
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::{clipped, single};
use fmc_camera_file::text_file;
use fmc_frames::Lines;

use super::observations::check_on_sensor;
use super::points::csv_failure;
use crate::failure::Failure;

/// Columns of an image point in either frame, and of its σ.
const IN_MM: [&str; 3] = ["x_mm", "y_mm", "sigma_um"];
const IN_PX: [&str; 3] = ["col_px", "row_px", "sigma_px"];

/// A file of rows with named columns.
#[derive(Debug)]
pub struct NamedColumns {
    /// Name that messages use, and CRC-32 of the bytes.
    pub input: InputFile,
    names: Vec<String>,
    rows: Vec<(u64, StringRecord)>,
}

/// A row of a file.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    file: &'a NamedColumns,
    /// Line in the file.
    pub line: u64,
    record: &'a StringRecord,
}

/// An image point with its σ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    /// Point in the sensor frame, mm.
    pub point_mm: [f64; 2],
    /// σ of either coordinate, mm.
    pub sigma_mm: f64,
}

impl NamedColumns {
    /// Reads a file with these columns; others may be there.
    ///
    /// # Errors
    /// [`Failure`] naming file, line and column.
    pub fn read(path: &Path, required: &[&str]) -> Result<Self, Failure> {
        let mut bytes = Vec::new();
        text_file::open(path)?
            .read_to_end(&mut bytes)
            .map_err(|error| Failure::reading(path, &error))?;
        Self::parse(&path.display().to_string(), &bytes, required)
    }

    /// Parses the bytes of a file; `file` is the name that messages use.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &str, bytes: &[u8], required: &[&str]) -> Result<Self, Failure> {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(text);
        let header = reader
            .headers()
            .map_err(|error| csv_failure(file, &error))?
            .clone();
        let names: Vec<String> = header.iter().map(str::to_owned).collect();
        let refused = |fault: String| header_failure(file, &fault, required);
        if names.iter().all(String::is_empty) {
            return Err(refused("the file is empty".to_owned()));
        }
        for (index, name) in names.iter().enumerate() {
            if !name.is_empty() && names.iter().skip(index + 1).any(|other| other == name) {
                return Err(refused(format!("column {name} appears twice")));
            }
        }
        check_required(file, &names, required)?;
        let mut rows = Vec::new();
        let mut record = StringRecord::new();
        let mut lines = Lines::default();
        while reader
            .read_record(&mut record)
            .map_err(|error| csv_failure(file, &error))?
        {
            rows.push((lines.of(record.position()), record.clone()));
        }
        Ok(Self {
            input: InputFile {
                file: file.to_owned(),
                crc32: crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes),
            },
            names,
            rows,
        })
    }

    /// Checks that these columns are there.
    ///
    /// # Errors
    /// [`Failure`] naming the column that is missing.
    pub fn require(&self, required: &[&str]) -> Result<(), Failure> {
        check_required(&self.input.file, &self.names, required)
    }

    /// Returns true if there is a column of this name.
    #[must_use]
    pub fn has(&self, column: &str) -> bool {
        self.names.iter().any(|name| name == column)
    }

    /// Rows in the order of the file.
    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|(line, record)| Row {
            file: self,
            line: *line,
            record,
        })
    }

    /// Returns true if the image points have σ, after a look at the columns of image points.
    ///
    /// # Errors
    /// [`Failure`] naming the columns that are missing, or of both frames.
    pub fn check_image_columns(&self) -> Result<bool, Failure> {
        let file = &self.input.file;
        let in_frame = |[x, y, _]: [&str; 3]| self.has(x) && self.has(y);
        match (in_frame(IN_MM), in_frame(IN_PX)) {
            (true, true) => Err(Failure::bad_input(format!(
                "{file}, line 1: both x_mm,y_mm and col_px,row_px are given"
            ))),
            (false, false) => Err(Failure::bad_input(format!(
                "{file}, line 1: columns x_mm and y_mm, or col_px and row_px, are missing"
            ))),
            (true, false) => Ok(self.has("sigma_um")),
            (false, true) => Ok(self.has("sigma_px")),
        }
    }
}

fn header_failure(file: &str, fault: &str, required: &[&str]) -> Failure {
    Failure::bad_input(format!("{file}, line 1: {fault}")).with_help(format!(
        "the first line names the columns, separated by commas, in any order: {}",
        required.join(",")
    ))
}

fn check_required(file: &str, names: &[String], required: &[&str]) -> Result<(), Failure> {
    let missing = required
        .iter()
        .find(|required| !names.iter().any(|name| name == *required));
    let Some(name) = missing else {
        return Ok(());
    };
    let found = clipped(&names.join(",")).escape_debug().to_string();
    let fault = format!("column {name} is missing; found {found}");
    Err(header_failure(file, &fault, required))
}

impl Row<'_> {
    /// Returns the failure of this row.
    #[must_use]
    pub fn failure(&self, fault: impl std::fmt::Display) -> Failure {
        Failure::bad_input(format!(
            "{}, line {}: {fault}",
            self.file.input.file, self.line
        ))
    }

    /// Returns the name in a column, which must not be empty.
    ///
    /// # Errors
    /// [`Failure`] naming file, line and column.
    pub fn name<Name: for<'a> From<&'a str>>(&self, column: &str) -> Result<Name, Failure> {
        match self.optional(column) {
            Some(text) if text.contains(char::is_control) => Err(self.failure(format!(
                "column {column} holds a control character: {}",
                clipped(text).escape_debug()
            ))),
            Some(text) => Ok(text.into()),
            None => Err(self.failure(format!("column {column} is empty"))),
        }
    }

    /// Returns the text of a column; `None` if there is no such column, or it is empty.
    #[must_use]
    pub fn optional(&self, column: &str) -> Option<&str> {
        let index = self.file.names.iter().position(|name| name == column)?;
        self.record.get(index).filter(|text| !text.is_empty())
    }

    /// Returns the number of a column.
    ///
    /// # Errors
    /// [`Failure`] naming file, line, column and text.
    pub fn number(&self, column: &str) -> Result<f64, Failure> {
        let text = self.optional(column).unwrap_or_default();
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.failure(format!(
                "{column} = \"{}\" is not a finite number",
                clipped(text).escape_debug()
            ))),
        }
    }

    /// Returns the number of a column; `None` if there is no such column, or it is empty.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn optional_number(&self, column: &str) -> Result<Option<f64>, Failure> {
        let is_there = self.optional(column).is_some();
        is_there.then(|| self.number(column)).transpose()
    }

    /// Returns the image point of the row, in the sensor frame, with its σ or the unit σ.
    ///
    /// # Errors
    /// [`Failure`] for a point off the sensor, and a σ that is not positive.
    pub fn image_point(&self, camera: &CameraFile) -> Result<MeasuredPoint, Failure> {
        let is_px = self.file.has("col_px");
        let [first, second, sigma] = if is_px { IN_PX } else { IN_MM };
        let read = [self.number(first)?, self.number(second)?];
        let point_mm = if is_px {
            camera.sensor_from_pixel(read)
        } else {
            read
        };
        let halves = camera.half_format_mm();
        let on_axes = point_mm.into_iter().zip(halves).zip([first, second]);
        for ((value, half), column) in on_axes {
            check_on_sensor(value, half, column).map_err(|fault| self.failure(fault))?;
        }
        let sigma_mm = if self.file.has(sigma) {
            let unit_um = if is_px { camera.sensor.pixel_um } else { 1.0 };
            let sigma_um = self.number(sigma)? * unit_um;
            Quantity::SigmaUm
                .check(single(sigma_um))
                .map_err(|error| self.failure(format!("column {sigma}: {error} µm")))?;
            sigma_um / 1e3
        } else {
            UNIT_SIGMA_MM
        };
        Ok(MeasuredPoint { point_mm, sigma_mm })
    }
}
