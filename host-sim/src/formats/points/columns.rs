//! Where the columns of a point file are.

use csv::ByteRecord;

use super::{Block, Frame};
use crate::formats::camera_file::CameraFile;
use crate::formats::number::clipped;

/// Where the columns of a point file are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    id: usize,
    coordinates: [usize; 2],
    pub(super) frame: Frame,
}

impl Columns {
    pub(super) fn find(header: &ByteRecord) -> Result<Self, String> {
        let names: Vec<String> = header
            .iter()
            .map(|name| String::from_utf8_lossy(name.trim_ascii()).into_owned())
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

    /// Adds the point of a record to a block.
    ///
    /// # Errors
    /// What is wrong, in words.
    #[inline]
    pub(super) fn read(
        &self,
        record: &ByteRecord,
        line: u64,
        camera: &CameraFile,
        block: &mut Block,
    ) -> Result<(), String> {
        let name = text(record, self.id, "id")?;
        if name.bytes().any(|byte| byte.is_ascii_control()) || !name.is_ascii() {
            check_name(name)?;
        }
        let [first, second] = self.coordinates;
        let [first_name, second_name] = self.frame.columns();
        let coordinate = [
            number(record, name, first, first_name)?,
            number(record, name, second, second_name)?,
        ];
        let point_mm = match self.frame {
            Frame::Sensor => coordinate,
            Frame::Pixel => camera.sensor_from_pixel(coordinate),
        };
        block.push(name, point_mm, line);
        Ok(())
    }
}

fn text<'a>(record: &'a ByteRecord, index: usize, column: &str) -> Result<&'a str, String> {
    let bytes = record.get(index).unwrap_or_default().trim_ascii();
    str::from_utf8(bytes).map_err(|_| format!("column {column} is not text (UTF-8)"))
}

#[inline]
fn number(record: &ByteRecord, name: &str, index: usize, column: &str) -> Result<f64, String> {
    let text = text(record, index, column)?;
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!(
            "point {}: {column} = \"{}\" is not a finite number",
            clipped(name),
            clipped(text).escape_debug()
        )),
    }
}

#[cold]
fn check_name(name: &str) -> Result<(), String> {
    if name.contains(char::is_control) {
        return Err(format!(
            "column id holds a control character: {}",
            clipped(name).escape_debug()
        ));
    }
    Ok(())
}
