//! Rows of columns of known meanings, read in one pass and in several threads.

use fmc_camera_file::CameraFile;
use memchr::memchr;

use super::columns::{Columns, Role};
use super::{Block, short_decimal};

/// Bytes of rows that are worth a thread: a pipe gives fewer at once, and its reader keeps up with
/// the writer.
const PART_BYTES: usize = 1 << 16;

/// Order of the columns of a file, and threads for its rows.
#[derive(Debug)]
pub(super) struct RowGrammar {
    columns: Columns,
    roles: Vec<Role>,
    /// Largest number of parts into which rows are cut, and the fewest bytes of one.
    most_parts: usize,
    part_bytes: usize,
}

/// A row.
struct Row {
    name: [usize; 2],
    coordinate: [f64; 2],
    end: usize,
}

impl RowGrammar {
    /// Returns the grammar of rows of `count` columns.
    pub(super) fn new(columns: Columns, count: usize) -> Self {
        Self {
            columns,
            roles: columns.roles(count),
            most_parts: rayon::current_num_threads(),
            part_bytes: PART_BYTES,
        }
    }

    /// Adds rows, each with its line end, to a block up to the first that is not plain, and returns
    /// the number of bytes taken: all if there is none.
    pub(super) fn take(&self, rows: &[u8], camera: &CameraFile, block: &mut Block) -> usize {
        let parts = rows.len() / self.part_bytes;
        self.take_in_parts(parts.min(self.most_parts), rows, camera, block)
    }

    /// Does the same in so many parts, side by side.
    fn take_in_parts(
        &self,
        parts: usize,
        rows: &[u8],
        camera: &CameraFile,
        block: &mut Block,
    ) -> usize {
        if parts < 2 {
            return self.take_one_by_one(rows, camera, block);
        }
        let parts_before = parts / 2;
        let about = rows.len() / parts * parts_before;
        self.take_cut(
            about,
            [parts_before, parts - parts_before],
            rows,
            camera,
            block,
        )
    }

    /// Does the same with rows that are cut at a place, each side in so many parts.
    fn take_cut(
        &self,
        at: usize,
        [parts_before, parts_behind]: [usize; 2],
        rows: &[u8],
        camera: &CameraFile,
        block: &mut Block,
    ) -> usize {
        let (before, behind) = cut_behind_line(rows, at);
        let (taken, (taken_behind, block_behind)) = rayon::join(
            || self.take_in_parts(parts_before, before, camera, block),
            || {
                let mut block = Block::default();
                let taken = self.take_in_parts(parts_behind, behind, camera, &mut block);
                (taken, block)
            },
        );
        if taken < before.len() {
            // The rows behind may lie within quotes.
            return taken;
        }
        block.append(&block_behind);
        taken + taken_behind
    }

    fn take_one_by_one(&self, rows: &[u8], camera: &CameraFile, block: &mut Block) -> usize {
        let mut at = 0;
        while let Some(Row {
            name: [from, to],
            coordinate,
            end,
        }) = self.row(rows, at)
        {
            let name = rows.get(from..to).unwrap_or_default();
            block.push(name.trim_ascii(), self.columns.place(coordinate, camera));
            at = end;
        }
        at
    }

    /// Reads the row from a place on.
    #[inline]
    fn row(&self, rows: &[u8], at: usize) -> Option<Row> {
        let mut row = Row {
            name: [at; 2],
            coordinate: [0.0; 2],
            end: at,
        };
        let mut roles = self.roles.iter();
        while let Some(role) = roles.next() {
            let from = row.end;
            let field = rows.get(from..)?;
            let length = match role {
                Role::Coordinate(index) => {
                    let (number, length) = number(field)?;
                    *row.coordinate.get_mut(*index)? = number;
                    length
                }
                Role::Name | Role::Other => field.iter().position(|byte| !is_text(*byte))?,
            };
            if *role == Role::Name {
                row.name = [from, from + length];
            }
            let behind = *rows.get(from + length)?;
            let delimiter = if roles.len() == 0 { b'\n' } else { b',' };
            if behind != delimiter {
                return None;
            }
            row.end = from + length + 1;
        }
        Some(row)
    }
}

/// Cuts rows in two behind the first line that ends at a place or behind it.
fn cut_behind_line(rows: &[u8], at: usize) -> (&[u8], &[u8]) {
    let line_end = rows.get(at..).and_then(|behind| memchr(b'\n', behind));
    let length = line_end.map_or(rows.len(), |length| at + length + 1);
    rows.split_at_checked(length).unwrap_or((rows, &[]))
}

/// Reads a finite number, and returns its length as well.
#[inline]
fn number(field: &[u8]) -> Option<(f64, usize)> {
    short_decimal::parse_partial(field).or_else(|| general_number(field))
}

#[cold]
fn general_number(field: &[u8]) -> Option<(f64, usize)> {
    let number = fast_float2::parse_partial::<f64, _>(field).ok();
    number.filter(|(number, _)| number.is_finite())
}

/// Returns `true` for a printable character within a plain field.
const fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~') && byte != b'"' && byte != b','
}

#[cfg(test)]
impl RowGrammar {
    /// Returns the grammar for a number of threads, to each of which any row is worth its while.
    pub(super) fn with_parts(self, most_parts: usize) -> Self {
        Self {
            most_parts,
            part_bytes: 1,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use csv::ByteRecord;
    use fmc_camera_file::published::CAMERA_FILES;

    use super::*;

    #[test]
    fn rows_cut_anywhere_are_those_of_one_thread() {
        let (name, text) = CAMERA_FILES[0];
        let (camera, _) = CameraFile::parse(name, text).unwrap();
        let header = ByteRecord::from(vec!["id", "x_mm", "note", "y_mm"]);
        let grammar = RowGrammar::new(Columns::find(&header).unwrap(), header.len());
        let plain = "p1,1.5,,-2\n p 2 ,-3.25,a note,4e1\np3,.5,x,7.\n";
        let mut ends = Vec::new();
        for other in [
            "",
            "\"p4\",1,,2\n",
            "p4,1,\"two\nlines,9,,9\n\",2\n",
            "p4,\"1\n2\",,2\n",
            "p4,1,,2,\n",
            "p4,1,,nan\n",
            "p4,1,,2\r\n",
            "\n",
        ] {
            for rows in [
                format!("{plain}{other}{plain}"),
                format!("{other}{plain}{plain}"),
                format!("{plain}{plain}{other}"),
            ] {
                let rows = rows.as_bytes();
                let mut expected = Block::default();
                let end = grammar.take_one_by_one(rows, &camera, &mut expected);
                assert!(end == rows.len() || !other.is_empty());
                for at in 0..=rows.len() {
                    for parts in [[1, 1], [2, 3]] {
                        let mut found = Block::default();
                        let taken = grammar.take_cut(at, parts, rows, &camera, &mut found);
                        assert_eq!(
                            (taken, &found),
                            (end, &expected),
                            "{at} {parts:?} {other:?}"
                        );
                    }
                }
                ends.push(end == rows.len());
            }
        }
        // All rows are taken with nothing among them alone.
        assert_eq!(ends.iter().filter(|is_all| **is_all).count(), 3);
    }
}
