//! Points in and answers out, as CSV.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use csv::{ByteRecord, ErrorKind, ReaderBuilder, Trim};

use super::camera_file::CameraFile;
use super::number::clipped;
use crate::failure::Failure;

/// What the two coordinate columns of a point file mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// `x_mm`, `y_mm` of the sensor frame.
    Sensor,
    /// `col_px`, `row_px`.
    Pixel,
}

impl Frame {
    const ALL: [Self; 2] = [Self::Sensor, Self::Pixel];

    const fn columns(self) -> [&'static str; 2] {
        match self {
            Self::Sensor => ["x_mm", "y_mm"],
            Self::Pixel => ["col_px", "row_px"],
        }
    }
}

/// One point of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct PointRow {
    /// Its name, as written.
    pub id: Box<str>,
    /// Its place in the sensor frame, mm.
    pub point_mm: [f64; 2],
    /// Its line in the file.
    pub line: u64,
}

/// The points of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct PointTable {
    /// What messages call the file.
    pub file: String,
    /// The frame they were given in, and are answered in.
    pub frame: Frame,
    /// In the order of the file.
    pub rows: Vec<PointRow>,
}

/// The answer to one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// The new coordinate in the sensor frame, mm.
    pub point_mm: [f64; 2],
    /// Distortion measured - ideal, mm.
    pub distortion_mm: [f64; 2],
}

impl PointTable {
    /// Reads a point file.
    ///
    /// # Errors
    /// [`Failure`] naming file, line, column and value.
    pub fn read(path: &Path, camera: &CameraFile) -> Result<Self, Failure> {
        let source = File::open(path).map_err(|error| Failure::reading(path, &error))?;
        Self::parse(&path.display().to_string(), source, camera)
    }

    /// Parses points; `file` is what messages call them.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(file: &str, source: impl Read, camera: &CameraFile) -> Result<Self, Failure> {
        let mut reader = ReaderBuilder::new()
            .trim(Trim::All)
            .buffer_capacity(1 << 18)
            .from_reader(source);
        let header = reader
            .byte_headers()
            .map_err(|error| csv_failure(file, &error))?
            .clone();
        let columns = Columns::find(&header).map_err(|fault| {
            Failure::bad_input(format!("{file}, line 1: {fault}")).with_help(
                "the first line names the columns, separated by commas, in any order: id,x_mm,y_mm or id,col_px,row_px",
            )
        })?;
        let mut rows = Vec::new();
        let mut record = ByteRecord::new();
        while reader
            .read_byte_record(&mut record)
            .map_err(|error| csv_failure(file, &error))?
        {
            let line = record.position().map_or(0, csv::Position::line);
            let row = columns
                .row(&record, line, camera)
                .map_err(|fault| Failure::bad_input(format!("{file}, line {line}: {fault}")))?;
            rows.push(row);
        }
        Ok(Self {
            file: file.to_owned(),
            frame: columns.frame,
            rows,
        })
    }

    /// Checks that every point lies on the sensor, edges included.
    ///
    /// # Errors
    /// [`Failure`] naming the first that does not, and the sensor's extent.
    pub fn check_on_sensor(&self, camera: &CameraFile) -> Result<(), Failure> {
        // An edge typed in decimals is an edge: W·p/2 itself is rounded.
        let [half_width, half_height] = camera.half_format_mm().map(|half| half * (1.0 + 1e-12));
        for row in &self.rows {
            let [x, y] = row.point_mm;
            if x.abs() > half_width || y.abs() > half_height {
                return Err(self.off_sensor(row, "the point", row.point_mm, camera));
            }
        }
        Ok(())
    }

    /// The failure of a point whose measured place, `point_mm`, is off the sensor.
    #[must_use]
    pub fn off_sensor(
        &self,
        row: &PointRow,
        what: &str,
        point_mm: [f64; 2],
        camera: &CameraFile,
    ) -> Failure {
        let [first, second] = self.frame.columns();
        let ([a, b], [least, most]) = match self.frame {
            Frame::Sensor => {
                let [x, y] = camera.half_format_mm();
                (point_mm, [[-x, -y], [x, y]])
            }
            Frame::Pixel => {
                let [x, y] = camera.half_format_mm();
                let [first, last] = [[-x, y], [x, -y]].map(|p| camera.pixel_from_sensor(p));
                (camera.pixel_from_sensor(point_mm), [first, last])
            }
        };
        let [least_a, least_b] = least;
        let [most_a, most_b] = most;
        Failure::bad_input(format!(
            "{}, line {}: point {}: {what} {first} = {a}, {second} = {b} is off the sensor: \
             {first} {least_a} to {most_a}, {second} {least_b} to {most_b}",
            self.file,
            row.line,
            clipped(&row.id)
        ))
    }

    /// Writes the answers, in the order and the frame of the points.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_answers(
        &self,
        answers: &[Answer],
        camera: &CameraFile,
        sink: &mut dyn Write,
    ) -> io::Result<()> {
        let mut writer = csv::WriterBuilder::new()
            .buffer_capacity(1 << 18)
            .from_writer(sink);
        let [first, second] = self.frame.columns();
        writer.write_record(["id", first, second, "dx_um", "dy_um"])?;
        let mut field = Vec::with_capacity(32);
        for (row, answer) in self.rows.iter().zip(answers) {
            writer.write_field(row.id.as_bytes())?;
            let coordinate = match self.frame {
                Frame::Sensor => answer.point_mm,
                Frame::Pixel => camera.pixel_from_sensor(answer.point_mm),
            };
            for value in coordinate {
                number_field(&mut writer, &mut field, value, 9)?;
            }
            for value in answer.distortion_mm {
                number_field(&mut writer, &mut field, 1000.0 * value, 6)?;
            }
            writer.write_record(None::<&[u8]>)?;
        }
        writer.flush()
    }
}

fn number_field(
    writer: &mut csv::Writer<&mut dyn Write>,
    field: &mut Vec<u8>,
    value: f64,
    decimals: usize,
) -> io::Result<()> {
    field.clear();
    // Adding zero turns -0 into 0.
    write!(field, "{:.decimals$}", value + 0.0)?;
    writer.write_field(&field)?;
    Ok(())
}

/// Where the columns of a point file are.
struct Columns {
    id: usize,
    coordinates: [usize; 2],
    frame: Frame,
}

impl Columns {
    fn find(header: &ByteRecord) -> Result<Self, String> {
        let names: Vec<String> = header
            .iter()
            .map(|name| String::from_utf8_lossy(name).into_owned())
            .collect();
        if names.iter().all(String::is_empty) {
            return Err("the file is empty".to_owned());
        }
        let place = |wanted: &str| -> Result<Option<usize>, String> {
            let mut places = names.iter().enumerate().filter(|(_, name)| *name == wanted);
            match (places.next(), places.next()) {
                (Some(_), Some(_)) => Err(format!("column {wanted} appears twice")),
                (first, _) => Ok(first.map(|(index, _)| index)),
            }
        };
        let found = clipped(&names.join(",")).escape_debug().to_string();
        let id = place("id")?.ok_or_else(|| format!("column id is missing; found {found}"))?;
        let mut complete = Vec::new();
        let mut missing = Vec::new();
        for frame in Frame::ALL {
            let [first, second] = frame.columns();
            match (place(first)?, place(second)?) {
                (Some(a), Some(b)) => complete.push((frame, [a, b])),
                (Some(_), None) => missing.push(second),
                (None, Some(_)) => missing.push(first),
                (None, None) => {}
            }
        }
        match (complete.as_slice(), missing.first()) {
            (_, Some(column)) => Err(format!("column {column} is missing; found {found}")),
            ([(frame, coordinates)], None) => Ok(Self {
                id,
                coordinates: *coordinates,
                frame: *frame,
            }),
            ([], None) => Err(format!(
                "columns x_mm and y_mm, or col_px and row_px, are missing; found {found}"
            )),
            (_, None) => Err("both x_mm,y_mm and col_px,row_px are given".to_owned()),
        }
    }

    fn row(&self, record: &ByteRecord, line: u64, camera: &CameraFile) -> Result<PointRow, String> {
        let text = |index: usize, column: &str| {
            let bytes = record.get(index).unwrap_or_default();
            std::str::from_utf8(bytes).map_err(|_| format!("column {column} is not text (UTF-8)"))
        };
        let whole_id = text(self.id, "id")?;
        let id = clipped(whole_id);
        if id.contains(char::is_control) {
            return Err(format!(
                "column id holds a control character: {}",
                id.escape_debug()
            ));
        }
        let mut coordinate = [0.0; 2];
        for ((value, index), column) in coordinate
            .iter_mut()
            .zip(self.coordinates)
            .zip(self.frame.columns())
        {
            let text = text(index, column)?;
            *value = match text.parse::<f64>() {
                Ok(number) if number.is_finite() => number,
                _ => {
                    return Err(format!(
                        "point {id}: {column} = \"{}\" is not a finite number",
                        clipped(text).escape_debug()
                    ));
                }
            };
        }
        Ok(PointRow {
            id: whole_id.into(),
            point_mm: match self.frame {
                Frame::Sensor => coordinate,
                Frame::Pixel => camera.sensor_from_pixel(coordinate),
            },
            line,
        })
    }
}

pub(super) fn csv_failure(file: &str, error: &csv::Error) -> Failure {
    match error.kind() {
        ErrorKind::UnequalLengths {
            pos,
            expected_len,
            len,
        } => Failure::bad_input(format!(
            "{file}, line {}: {len} columns where the header has {expected_len}",
            pos.as_ref().map_or(0, csv::Position::line)
        )),
        ErrorKind::Io(error) => Failure::reading(Path::new(file), error),
        _ => Failure::bad_input(format!("{file}: {error}")),
    }
}
