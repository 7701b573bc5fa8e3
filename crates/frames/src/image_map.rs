//! Names of the images of a flight.

use std::io::Read;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use fmc_camera_file::{InputError, text_file};

use crate::Lines;
use crate::columns::{csv_error, names, shown};

/// The image of each sequence number, from a table with the columns `sequence` and `image`, or
/// `sequence` and `file` ([`ImageMap::read_files`]).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImageMap {
    file: String,
    /// Name of the column of images.
    column: &'static str,
    /// In the order of the sequence numbers.
    rows: Vec<Row>,
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Row {
    sequence: u32,
    line: u32,
    image: Box<str>,
}

impl ImageMap {
    /// Reads a table.
    ///
    /// # Errors
    /// [`InputError`] naming file, line, column and value: a column that is missing, a sequence
    /// that is no number, a sequence or an image that stands twice, an image without a name.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::open(path, "image")
    }

    /// Reads a table of the files of images, whose column is `file`.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_files(path: &Path) -> Result<Self, InputError> {
        Self::open(path, "file")
    }

    fn open(path: &Path, column: &'static str) -> Result<Self, InputError> {
        let file = text_file::open(path)?;
        Self::read_column(&path.display().to_string(), file, column)
    }

    /// Reads a table as [`read`](Self::read) does, from any source; `file` is its name in messages.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    pub fn read_from(file: &str, source: impl Read) -> Result<Self, InputError> {
        Self::read_column(file, source, "image")
    }

    fn read_column(
        file: &str,
        source: impl Read,
        column: &'static str,
    ) -> Result<Self, InputError> {
        let mut reader = ReaderBuilder::new().trim(Trim::All).from_reader(source);
        let mut row = StringRecord::new();
        let header = reader.headers();
        let header = header.map_err(|error| csv_error(file, &[], &row, &error))?;
        let names = names(file, header)?;
        let place = |wanted: &str| {
            names.iter().position(|name| name == wanted).ok_or_else(|| {
                InputError::invalid(format!(
                    "{file}, line 1: column {wanted} is missing; found {}",
                    shown(&names.join(","))
                ))
            })
        };
        let (sequence, image) = (place("sequence")?, place(column)?);
        let mut rows: Vec<Row> = Vec::new();
        let mut lines = Lines::default();
        while reader
            .read_record(&mut row)
            .map_err(|error| csv_error(file, &names, &StringRecord::new(), &error))?
        {
            let line = lines.of(row.position());
            let refused =
                |text: String| InputError::invalid(format!("{file}, line {line}: {text}"));
            let number = row.get(sequence).unwrap_or_default();
            let number: u32 = number.parse().map_err(|_| {
                refused(format!(
                    "sequence = \"{}\" is not a whole number from 0 to {}",
                    shown(number),
                    u32::MAX
                ))
            })?;
            let image = row.get(image).unwrap_or_default();
            if image.is_empty() {
                return Err(refused(format!("{column} of sequence {number} is empty")));
            }
            rows.push(Row {
                sequence: number,
                line: u32::try_from(line).unwrap_or(u32::MAX),
                image: image.into(),
            });
        }
        let map = Self {
            file: file.to_owned(),
            column,
            rows,
        };
        map.in_order()
    }

    /// Puts the rows in order, and refuses a sequence number and an image that stand twice.
    fn in_order(mut self) -> Result<Self, InputError> {
        let refused = |row: &Row, text: String| {
            InputError::invalid(format!("{}, line {}: {text}", self.file, row.line))
        };
        self.rows
            .sort_unstable_by_key(|row| (row.sequence, row.line));
        for (row, next) in self.rows.iter().zip(self.rows.iter().skip(1)) {
            if row.sequence == next.sequence {
                let text = format!("sequence {} appears twice", next.sequence);
                return Err(refused(next, text));
            }
        }
        let mut rows: Vec<&Row> = self.rows.iter().collect();
        rows.sort_unstable_by_key(|row| (&row.image, row.line));
        for (row, next) in rows.iter().zip(rows.iter().skip(1)) {
            if row.image == next.image {
                return Err(refused(
                    next,
                    format!(
                        "{} = \"{}\" is that of sequence {}, too",
                        self.column,
                        shown(&next.image),
                        row.sequence
                    ),
                ));
            }
        }
        Ok(self)
    }

    /// Name of the file in messages.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns the image of a sequence number.
    #[must_use]
    pub fn image(&self, sequence: u32) -> Option<&str> {
        self.row(sequence).map(|row| &*row.image)
    }

    /// Returns the line of a sequence number.
    #[must_use]
    pub fn line(&self, sequence: u32) -> Option<u32> {
        self.row(sequence).map(|row| row.line)
    }

    /// Returns the sequence numbers with their images, in ascending order of the numbers.
    pub fn images(&self) -> impl Iterator<Item = (u32, &str)> {
        self.rows.iter().map(|row| (row.sequence, &*row.image))
    }

    /// Returns the sequence numbers that have an image, in ascending order.
    #[must_use]
    pub fn sequences(&self) -> Vec<u32> {
        self.rows.iter().map(|row| row.sequence).collect()
    }

    fn row(&self, sequence: u32) -> Option<&Row> {
        let place = self
            .rows
            .binary_search_by_key(&sequence, |row| row.sequence)
            .ok()?;
        self.rows.get(place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_found_by_their_sequence() {
        let text = "\u{feff}image, sequence,camera\r\na.tif,2,x\r\n\"b,c.tif\", 1 ,y\r\n";
        let map = ImageMap::read_from("map.csv", text.as_bytes()).unwrap();
        assert_eq!(map.image(2), Some("a.tif"));
        assert_eq!(map.image(1), Some("b,c.tif"));
        assert_eq!(map.image(3), None);
        assert_eq!(map.sequences(), [1, 2]);
        assert_eq!([1, 2, 3].map(|one| map.line(one)), [Some(3), Some(2), None]);
    }

    #[test]
    fn files_have_a_column_of_their_own() {
        let text = "file,sequence\nb.tif,2\na.tif,1\n";
        let map = ImageMap::read_column("frames.csv", text.as_bytes(), "file").unwrap();
        assert_eq!(
            map.images().collect::<Vec<_>>(),
            [(1, "a.tif"), (2, "b.tif")]
        );
        let text = "file,sequence\nb.tif,2\nb.tif,1\n";
        let error = ImageMap::read_column("frames.csv", text.as_bytes(), "file").unwrap_err();
        let expected = "frames.csv, line 3: file = \"b.tif\" is that of sequence 2, too";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn wrong_rows_are_refused_by_line_and_column() {
        for (text, expected) in [
            ("", "map.csv: the file is empty"),
            (
                "sequence,name\n",
                "map.csv, line 1: column image is missing; found sequence,name",
            ),
            (
                "image,image,sequence\n",
                "map.csv, line 1: column image appears twice",
            ),
            (
                "sequence,image\n1,a\n-2,b\n",
                "map.csv, line 3: sequence = \"-2\" is not a whole number from 0 to 4294967295",
            ),
            (
                "sequence,image\n1,\n",
                "map.csv, line 2: image of sequence 1 is empty",
            ),
            (
                "sequence,image\n1,a\n1,b\n",
                "map.csv, line 3: sequence 1 appears twice",
            ),
            (
                "sequence,image\n1,a\n2,a\n",
                "map.csv, line 3: image = \"a\" is that of sequence 1, too",
            ),
            (
                "sequence,image\n1\n",
                "map.csv, line 2: 1 columns where the header has 2",
            ),
        ] {
            let error = ImageMap::read_from("map.csv", text.as_bytes()).unwrap_err();
            assert_eq!(error.to_string(), expected);
        }
    }
}
