//! Reader of observed distortions, as CSV.

use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

use csv::{ByteRecord, ReaderBuilder, Trim};
use fmc_adjustment::observation::{ObservationRow, ObservationTable, UNIT_SIGMA_MM};
use fmc_camera::geometry::range::Quantity;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::{clipped, single};
use fmc_camera_file::text_file;
use fmc_frames::Lines;

use super::points::csv_failure;
use crate::failure::Failure;

/// Columns of numbers that are required.
const REQUIRED: [&str; 7] = [
    "x_mm",
    "y_mm",
    "dx_um",
    "dy_um",
    "vh_per_s",
    "exposure_s",
    "opening_offset_mm",
];

/// Factor of the half format beyond which a coordinate is taken to be in another unit.
const OTHER_UNIT: f64 = 20.0;

/// Reads a file of observations.
///
/// # Errors
/// [`Failure`] naming file, line, column and value.
pub fn read(path: &Path, camera: &CameraFile) -> Result<ObservationTable, Failure> {
    let source = text_file::open(path)?;
    parse(&path.display().to_string(), source, camera)
}

/// Parses observations; `file` is the name of the file in messages.
///
/// # Errors
/// As [`read`].
pub fn parse(
    file: &str,
    source: impl Read,
    camera: &CameraFile,
) -> Result<ObservationTable, Failure> {
    let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(source);
    let header = reader
        .byte_headers()
        .map_err(|error| csv_failure(file, &error))?
        .clone();
    let columns = Columns::find(&header).map_err(|fault| {
            Failure::bad_input(format!("{file}, line 1: {fault}")).with_help(format!(
                "the first line names the columns, separated by commas, in any order: {}; optional: sigma_um, id",
                REQUIRED.join(",")
            ))
        })?;
    let mut rows = Vec::new();
    let mut lines_of_ids: HashMap<Box<str>, u64> = HashMap::new();
    let mut lines_of_numbers: HashMap<[u64; 8], u64> = HashMap::new();
    let (mut record, mut lines) = (ByteRecord::new(), Lines::default());
    while reader
        .read_byte_record(&mut record)
        .map_err(|error| csv_failure(file, &error))?
    {
        let line = lines.of(record.position());
        let failure = |fault| Failure::bad_input(format!("{file}, line {line}: {fault}"));
        let row = columns.row(&record, line, camera).map_err(failure)?;
        if let Some(id) = &row.id
            && let Some(first) = lines_of_ids.insert(id.clone(), line)
        {
            return Err(Failure::bad_input(format!(
                "{file}, lines {first} and {line}: id {} appears twice; an id names one observation",
                clipped(id)
            )));
        }
        // A row with the same numbers to the last digit is the same observation, written twice.
        if let Some(first) = lines_of_numbers.insert(bits(&row), line) {
            return Err(Failure::bad_input(format!(
                "{file}, lines {first} and {line}: the same observation twice, number by number; it would count double"
            )));
        }
        rows.push(row);
    }
    Ok(ObservationTable {
        file: file.to_owned(),
        rows,
        has_sigma: columns.sigma.is_some(),
    })
}

/// Returns the numbers of a row as bits, to compare it with others.
fn bits(row: &ObservationRow) -> [u64; 8] {
    let [x, y] = row.point_mm;
    let [dx, dy] = row.distortion_mm;
    let ObservationRow {
        vh_per_s,
        exposure_s,
        opening_offset_mm,
        sigma_mm,
        ..
    } = *row;
    [
        x,
        y,
        dx,
        dy,
        vh_per_s,
        exposure_s,
        opening_offset_mm,
        sigma_mm,
    ]
    .map(f64::to_bits)
}

/// Places of the columns.
struct Columns {
    required: [usize; 7],
    sigma: Option<usize>,
    id: Option<usize>,
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
        let place = |wanted: &str| {
            let mut places = names.iter().enumerate().filter(|(_, name)| *name == wanted);
            match (places.next(), places.next()) {
                (Some(_), Some(_)) => Err(format!("column {wanted} appears twice")),
                (first, _) => Ok(first.map(|(index, _)| index)),
            }
        };
        let found = clipped(&names.join(",")).escape_debug().to_string();
        let mut required = [0; 7];
        for (index, name) in required.iter_mut().zip(REQUIRED) {
            *index =
                place(name)?.ok_or_else(|| format!("column {name} is missing; found {found}"))?;
        }
        Ok(Self {
            required,
            sigma: place("sigma_um")?,
            id: place("id")?,
        })
    }

    fn row(
        &self,
        record: &ByteRecord,
        line: u64,
        camera: &CameraFile,
    ) -> Result<ObservationRow, String> {
        let text = |index: usize, column: &str| {
            let bytes = record.get(index).unwrap_or_default();
            std::str::from_utf8(bytes).map_err(|_| format!("column {column} is not text (UTF-8)"))
        };
        let number = |index: usize, column: &str| {
            let text = text(index, column)?;
            match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => Err(format!(
                    "{column} = \"{}\" is not a finite number",
                    clipped(text).escape_debug()
                )),
            }
        };
        let mut numbers = [0.0; 7];
        for ((value, index), column) in numbers.iter_mut().zip(self.required).zip(REQUIRED) {
            *value = number(index, column)?;
        }
        let [x, y, dx_um, dy_um, vh_per_s, exposure_s, opening_offset_mm] = numbers;
        for ((value, half), column) in [x, y]
            .into_iter()
            .zip(camera.half_format_mm())
            .zip(REQUIRED)
        {
            check_on_sensor(value, half, column)?;
        }
        for (value, quantity) in [(dx_um, Quantity::DxUm), (dy_um, Quantity::DyUm)] {
            quantity
                .check(single(value))
                .map_err(|error| format!("{error} µm: is it in another unit?"))?;
        }
        let sigma_um = self
            .sigma
            .map(|index| number(index, "sigma_um"))
            .transpose()?;
        if let Some(sigma_um) = sigma_um {
            Quantity::SigmaUm
                .check(single(sigma_um))
                .map_err(|error| format!("{error} µm"))?;
        }
        let id = self.id.map(|index| text(index, "id")).transpose()?;
        if let Some(id) = id.filter(|id| id.contains(char::is_control)) {
            return Err(format!(
                "column id holds a control character: {}",
                clipped(id).escape_debug()
            ));
        }
        Ok(ObservationRow {
            line,
            id: id.map(Into::into),
            point_mm: [x, y],
            distortion_mm: [dx_um / 1000.0, dy_um / 1000.0],
            vh_per_s,
            exposure_s,
            opening_offset_mm,
            sigma_mm: sigma_um.map_or(UNIT_SIGMA_MM, |sigma_um| sigma_um / 1000.0),
        })
    }
}

pub(super) fn check_on_sensor(value_mm: f64, half_mm: f64, column: &str) -> Result<(), String> {
    // W·p/2 is rounded, so an edge typed in decimals may exceed it by rounding and still belongs to
    // the sensor.
    if value_mm.abs() <= half_mm * (1.0 + 1e-12) {
        return Ok(());
    }
    let factor = value_mm.abs() / half_mm;
    let remark = if factor >= OTHER_UNIT {
        "; is it in µm or px?"
    } else {
        ""
    };
    Err(format!(
        "{column} = {value_mm} is off the sensor, by a factor of {factor:.3}: -{half_mm} to {half_mm} mm{remark}"
    ))
}
