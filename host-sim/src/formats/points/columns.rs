//! The columns of a point file.

use csv::ByteRecord;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::clipped;

use super::{Block, CoordinateFrame};

/// Meaning of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Name of the point.
    Name,
    /// Coordinate, by its index.
    Coordinate(usize),
    /// No meaning here.
    Other,
}

/// Places of the columns of a point file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    id: usize,
    coordinates: [usize; 2],
    pub(super) frame: CoordinateFrame,
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
        for frame in CoordinateFrame::ALL {
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
    /// A description of the error, in words.
    #[inline]
    pub(super) fn read(
        &self,
        record: &ByteRecord,
        line: u64,
        camera: &CameraFile,
        block: &mut Block,
    ) -> Result<(), String> {
        let name = field(record, self.id);
        if name.iter().any(|byte| !(b' '..=b'~').contains(byte)) {
            check_name(name)?;
        }
        let [first, second] = self.coordinates;
        let (Some(first), Some(second)) = (number(record, first), number(record, second)) else {
            return Err(self.no_number(record, name));
        };
        block.push(name, self.place([first, second], camera));
        block.number_lines(line);
        Ok(())
    }

    /// Returns the place of a coordinate in the sensor frame, mm.
    #[inline]
    pub(super) fn place(&self, coordinate: [f64; 2], camera: &CameraFile) -> [f64; 2] {
        match self.frame {
            CoordinateFrame::Sensor => coordinate,
            CoordinateFrame::Pixel => camera.sensor_from_pixel(coordinate),
        }
    }

    /// Returns the meaning of each of `count` columns.
    pub(super) fn roles(&self, count: usize) -> Vec<Role> {
        let [first, second] = self.coordinates;
        (0..count)
            .map(|index| match index {
                _ if index == self.id => Role::Name,
                _ if index == first => Role::Coordinate(0),
                _ if index == second => Role::Coordinate(1),
                _ => Role::Other,
            })
            .collect()
    }

    /// Describes the first coordinate that is not a number.
    #[cold]
    fn no_number(&self, record: &ByteRecord, name: &[u8]) -> String {
        let [first, second] = self.coordinates;
        let [first_name, second_name] = self.frame.columns();
        let (index, column) = match number(record, first) {
            None => (first, first_name),
            Some(_) => (second, second_name),
        };
        match text(field(record, index), column) {
            Ok(text) => format!(
                "point {}: {column} = \"{}\" is not a finite number",
                clipped(&String::from_utf8_lossy(name)),
                clipped(text).escape_debug()
            ),
            Err(fault) => fault,
        }
    }
}

fn field(record: &ByteRecord, index: usize) -> &[u8] {
    record.get(index).unwrap_or_default().trim_ascii()
}

/// Reads a finite number, with spaces around it or without.
#[inline]
pub(in crate::formats) fn number(record: &ByteRecord, index: usize) -> Option<f64> {
    let field = record.get(index).unwrap_or_default();
    match fast_float2::parse::<f64, _>(field) {
        Ok(number) => number.is_finite().then_some(number),
        Err(_) => number_in_spaces(field),
    }
}

#[cold]
fn number_in_spaces(field: &[u8]) -> Option<f64> {
    let number = fast_float2::parse::<f64, _>(field.trim_ascii()).ok();
    number.filter(|number| number.is_finite())
}

#[cold]
fn check_name(name: &[u8]) -> Result<(), String> {
    let name = text(name, "id")?;
    if name.contains(char::is_control) {
        return Err(format!(
            "column id holds a control character: {}",
            clipped(name).escape_debug()
        ));
    }
    Ok(())
}

fn text<'a>(field: &'a [u8], column: &str) -> Result<&'a str, String> {
    str::from_utf8(field).map_err(|_| format!("column {column} is not text (UTF-8)"))
}

#[cfg(test)]
mod tests {
    /// The reader of numbers accepts the same texts as the standard library, and gives the same
    /// bits.
    #[test]
    fn numbers_are_those_of_the_standard_library() {
        let mut random = fastrand::Rng::with_seed(5);
        let mut texts: Vec<String> = (0..100_000)
            .flat_map(|_| {
                let any = f64::from_bits(random.u64(..));
                let coordinate = 500.0 * (random.f64() - 0.5);
                [
                    format!("{any:e}"),
                    format!("{coordinate}"),
                    format!("{coordinate:.7}"),
                ]
            })
            .collect();
        for text in [
            "",
            "+",
            "-",
            ".",
            "e",
            "1",
            "+1",
            "-1",
            "1.",
            ".5",
            "+.5",
            "1.e3",
            "1e",
            "1e+",
            "1e+3",
            "1E-3",
            "0x10",
            "1_000",
            "1 2",
            "1,5",
            "nan",
            "NaN",
            "-nan",
            "inf",
            "-inf",
            "+inf",
            "infinity",
            "INFINITY",
            "infinit",
            "in",
            "1e400",
            "1e-400",
            "-0",
            "00.100",
            "9007199254740993",
            "2.4703282292062327e-324",
            "1f",
            "1d5",
            "++1",
            "--1",
            "+-1",
            "é",
            "0.1000000000000000055511151231257827021181583404541015625",
            "179769313486231580793e289",
        ] {
            texts.push(text.to_owned());
        }
        for text in texts {
            let standard = text.parse::<f64>().ok().filter(|number| number.is_finite());
            let fast = fast_float2::parse::<f64, _>(&text)
                .ok()
                .filter(|number| number.is_finite());
            assert_eq!(fast.map(f64::to_bits), standard.map(f64::to_bits), "{text}");
        }
    }
}
