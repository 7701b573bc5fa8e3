//! Points of a CSV file.

use std::io::{Chain, Cursor, Read};
use std::mem;
use std::path::Path;

use csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder};
use fmc_camera_file::CameraFile;
use fmc_frames::Lines;

use super::columns::Columns;
use super::plain_rows::PlainRows;
use super::row_grammar::RowGrammar;
use super::{Block, CoordinateFrame};
use crate::failure::Failure;

/// The rows of a CSV file behind its header.
pub(super) struct CsvPoints<R> {
    file: String,
    columns: Columns,
    rows: Rows<R>,
    read: u64,
}

/// Rows, by their reader.
enum Rows<R> {
    /// As long as they are plain, with the header.
    Plain(PlainRows<R>, RowGrammar, Vec<u8>),
    /// From the first that is not.
    Any(AnyRows<R>),
    /// While one reader follows the other.
    None,
}

/// Rows with quotes and everything else that CSV may hold.
struct AnyRows<R> {
    reader: Reader<Chain<Cursor<Vec<u8>>, R>>,
    record: ByteRecord,
    lines: Lines,
    /// Lines and bytes of the file between the header and the first row of this reader.
    lines_before: u64,
    bytes_before: u64,
}

impl<R: Read> AnyRows<R> {
    /// Returns the rows in `bytes`, which begin with the header, and in `source` behind them.
    fn new(bytes: Vec<u8>, source: R) -> Self {
        Self {
            reader: ReaderBuilder::new()
                .buffer_capacity(1 << 18)
                .from_reader(Cursor::new(bytes).chain(source)),
            record: ByteRecord::new(),
            lines: Lines::default(),
            lines_before: 0,
            bytes_before: 0,
        }
    }

    /// Returns the rows that plain ones do not go on with.
    fn behind(plain: PlainRows<R>, header: Vec<u8>) -> Self {
        // The header is in line 1, the row behind it in line 2.
        let lines_before = plain.line() - 2;
        let bytes_before = plain.taken() - header.len() as u64;
        let (rest, source) = plain.into_rest();
        Self {
            lines_before,
            bytes_before,
            ..Self::new([header, rest].concat(), source)
        }
    }

    fn fill(
        &mut self,
        file: &str,
        columns: &Columns,
        camera: &CameraFile,
        block: &mut Block,
    ) -> Result<(), Failure> {
        while block.room() > 0 {
            if !self
                .reader
                .read_byte_record(&mut self.record)
                .map_err(|error| csv_failure_behind(file, self.lines_before, &error))?
            {
                break;
            }
            let line = self.lines_before + self.lines.of(self.record.position());
            columns
                .read(&self.record, line, camera, block)
                .map_err(|fault| Failure::bad_input(format!("{file}, line {line}: {fault}")))?;
        }
        Ok(())
    }
}

impl<R: Read> CsvPoints<R> {
    /// Reads the header; `file` is the name of the file in messages.
    ///
    /// # Errors
    /// [`Failure`] naming file, line and column.
    pub(super) fn new(file: &str, source: R) -> Result<Self, Failure> {
        let (mut plain, line) =
            PlainRows::header(source).map_err(|error| Failure::reading(Path::new(file), &error))?;
        let find = |header: &ByteRecord| {
            Columns::find(header).map_err(|fault| {
                Failure::bad_input(format!("{file}, line 1: {fault}")).with_help(
                    "the first line names the columns, separated by commas, in any order: id,x_mm,y_mm or id,col_px,row_px",
                )
            })
        };
        let (columns, rows) = if let Some(line) = line {
            let mut reader = ReaderBuilder::new().from_reader(line.as_slice());
            let header = reader.byte_headers();
            let header = header.map_err(|error| csv_failure(file, &error))?;
            let columns = find(header)?;
            plain.begin(line.len());
            let grammar = RowGrammar::new(columns, header.len());
            (columns, Rows::Plain(plain, grammar, line))
        } else {
            let (bytes, source) = plain.into_rest();
            let mut rows = AnyRows::new(bytes, source);
            let header = rows.reader.byte_headers();
            let header = header.map_err(|error| csv_failure(file, &error))?;
            (find(header)?, Rows::Any(rows))
        };
        Ok(Self {
            file: file.to_owned(),
            columns,
            rows,
            read: 0,
        })
    }

    pub(super) const fn frame(&self) -> CoordinateFrame {
        self.columns.frame
    }

    /// Reads the next points into a block; it stays empty at the end.
    ///
    /// # Errors
    /// [`Failure`] naming file, line, column and value; the points before it are in the block.
    pub(super) fn fill(&mut self, block: &mut Block, camera: &CameraFile) -> Result<(), Failure> {
        block.restart(self.read);
        let filled = self.fill_from(block, camera);
        self.read += block.points_mm.len() as u64;
        block.read_bytes = match &self.rows {
            Rows::Plain(plain, ..) => plain.taken(),
            Rows::Any(any) => any.bytes_before + any.reader.position().byte(),
            Rows::None => 0,
        };
        filled
    }

    fn fill_from(&mut self, block: &mut Block, camera: &CameraFile) -> Result<(), Failure> {
        let file = &self.file;
        if let Rows::Plain(plain, grammar, _) = &mut self.rows {
            let is_plain = plain
                .fill(grammar, camera, block)
                .map_err(|error| Failure::reading(Path::new(file), &error))?;
            if is_plain {
                return Ok(());
            }
        }
        self.rows = match mem::replace(&mut self.rows, Rows::None) {
            Rows::Plain(plain, _, header) => Rows::Any(AnyRows::behind(plain, header)),
            other => other,
        };
        match &mut self.rows {
            Rows::Any(any) => any.fill(file, &self.columns, camera, block),
            Rows::Plain(..) | Rows::None => Ok(()),
        }
    }
}

pub(in crate::formats) fn csv_failure(file: &str, error: &csv::Error) -> Failure {
    csv_failure_behind(file, 0, error)
}

/// Returns the failure of a reader that began so many lines behind the header.
fn csv_failure_behind(file: &str, lines_before: u64, error: &csv::Error) -> Failure {
    match error.kind() {
        ErrorKind::UnequalLengths {
            pos,
            expected_len,
            len,
        } => Failure::bad_input(format!(
            "{file}, line {}: {len} columns where the header has {expected_len}",
            pos.as_ref().map_or(0, |pos| lines_before + pos.line())
        )),
        ErrorKind::Io(error) => Failure::reading(Path::new(file), error),
        _ => Failure::bad_input(format!("{file}: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;
    use std::io;

    use fmc_camera_file::published::CAMERA_FILES;

    use super::*;

    /// Source of bytes in pieces of any length.
    struct Pieces<'a> {
        bytes: &'a [u8],
        most: usize,
        random: fastrand::Rng,
    }

    impl Read for Pieces<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let most = self.random.usize(1..self.most).min(buffer.len());
            self.bytes.read(&mut buffer[..most])
        }
    }

    /// Returns the points of a file, one block behind the other, and what is said at its end.
    fn read<R: Read>(points: Result<CsvPoints<R>, Failure>, camera: &CameraFile) -> String {
        let mut points = match points {
            Ok(points) => points,
            Err(failure) => return format!("{failure:?}"),
        };
        let (mut block, mut found) = (Block::default(), String::new());
        loop {
            let filled = points.fill(&mut block, camera);
            let names: Vec<_> = block.names().collect();
            let source = super::super::Source {
                file: "points.csv".to_owned(),
                frame: points.frame(),
                count: None,
                precision: super::super::Precision::Double,
                bytes: None,
            };
            for (index, point) in block.points_mm.iter().enumerate() {
                let place = block.place(&source, index);
                writeln!(found, "{place} {:?} {point:?}", names.get(index)).unwrap();
            }
            if let Err(failure) = filled {
                return found + &format!("{failure:?}");
            }
            if block.is_empty() {
                return found;
            }
        }
    }

    /// Returns the points as the CSV reader alone finds them.
    fn by_reader(source: Pieces<'_>) -> Result<CsvPoints<Pieces<'_>>, Failure> {
        let mut rows = AnyRows::new(Vec::new(), source);
        let header = rows.reader.byte_headers();
        let header = header.map_err(|error| csv_failure("points.csv", &error))?;
        let columns = Columns::find(header).map_err(|fault| {
            Failure::bad_input(format!("points.csv, line 1: {fault}")).with_help(
                "the first line names the columns, separated by commas, in any order: id,x_mm,y_mm or id,col_px,row_px",
            )
        })?;
        Ok(CsvPoints {
            file: "points.csv".to_owned(),
            columns,
            rows: Rows::Any(rows),
            read: 0,
        })
    }

    /// Gives the plain rows so many threads, each for any number of rows.
    fn in_parts<R: Read>(
        points: Result<CsvPoints<R>, Failure>,
        most: usize,
    ) -> Result<CsvPoints<R>, Failure> {
        points.map(|points| CsvPoints {
            rows: match points.rows {
                Rows::Plain(plain, grammar, header) => {
                    Rows::Plain(plain, grammar.with_parts(most), header)
                }
                other => other,
            },
            ..points
        })
    }

    #[test]
    fn any_text_is_read_as_the_csv_reader_reads_it() {
        const MARKS: &[u8] = b"\",\r\n -+.e9xnif\xc3\xa9\x07#;'";
        let (name, text) = CAMERA_FILES[0];
        let (camera, _) = CameraFile::parse(name, text).unwrap();
        let mut random = fastrand::Rng::with_seed(18);
        let (mut refused, mut whole) = (0, 0);
        for case in 0..6000 {
            let header = ["id,x_mm,y_mm", "y_mm,note,id,x_mm", "id,col_px,row_px"][case % 3];
            let mut text = header.as_bytes().to_vec();
            let end: &[u8] = if case % 7 == 0 { b"\r\n" } else { b"\n" };
            text.extend(end);
            for row in 0..random.usize(0..30) {
                let [x, y] = [random.f32(), random.f32()].map(|share| 20.0 * share - 10.0);
                text.extend(match case % 3 {
                    1 => format!("{x:.4},some text,p{row},{y}").into_bytes(),
                    _ => format!("p{row},{x:.3},{y}").into_bytes(),
                });
                text.extend(end);
            }
            for _ in 0..random.usize(0..3) {
                let at = random.usize(..=text.len());
                let mark = MARKS[random.usize(..MARKS.len())];
                match random.u8(..3) {
                    0 => text.insert(at, mark),
                    1 if at < text.len() => text[at] = mark,
                    1 | 2 if at < text.len() => drop(text.remove(at)),
                    _ => text.push(mark),
                }
            }
            let pieces = |seed| Pieces {
                bytes: &text,
                most: 40,
                random: fastrand::Rng::with_seed(seed),
            };
            let expected = read(by_reader(pieces(2)), &camera);
            for parts in [1, 2, 5] {
                // Most pieces are longer than a row, so that there is something to cut.
                let points = CsvPoints::new(
                    "points.csv",
                    Pieces {
                        most: 400,
                        ..pieces(1)
                    },
                );
                let found = read(in_parts(points, parts), &camera);
                assert_eq!(found, expected, "{}", String::from_utf8_lossy(&text));
            }
            let found = read(CsvPoints::new("points.csv", pieces(1)), &camera);
            assert_eq!(found, expected, "{}", String::from_utf8_lossy(&text));
            let is_whole = !expected.contains("Failure");
            whole += usize::from(is_whole);
            refused += usize::from(!is_whole);
        }
        assert!(refused > 500 && whole > 500, "{refused} {whole}");
    }

    #[test]
    fn rows_longer_than_what_is_read_at_once_and_files_of_many_blocks_are_read() {
        let (name, text) = CAMERA_FILES[0];
        let (camera, _) = CameraFile::parse(name, text).unwrap();
        let long = "x".repeat(600_000);
        let mut text = format!("id,x_mm,y_mm\np,1,2\n{long},3,4\n");
        for row in 0..40_000 {
            writeln!(text, "r{row},{}.5,-7", row % 9).unwrap();
        }
        // A quote in the middle of a plain file.
        text += "\"a \"\"b\"\"\",1,1\nlast,2,2\n";
        let pieces = || Pieces {
            bytes: text.as_bytes(),
            most: 40,
            random: fastrand::Rng::with_seed(4),
        };
        let found = read(CsvPoints::new("points.csv", pieces()), &camera);
        assert_eq!(found, read(by_reader(pieces()), &camera));
        assert_eq!(found.lines().count(), 40_004);
        // As a whole, in as many parts as there are threads, over the ends of blocks.
        let whole = CsvPoints::new("points.csv", text.as_bytes());
        assert_eq!(read(in_parts(whole, 3), &camera), found);
    }
}
