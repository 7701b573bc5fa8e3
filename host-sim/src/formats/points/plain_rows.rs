//! Rows of a CSV file in one pass, as long as they are plain: no quote, no carriage return, every
//! field as the header has it, every coordinate a number.
//!
//! The first other row ends them; it and all behind it are the CSV reader's, which knows what they
//! mean.

use std::io::{self, ErrorKind, Read};

use fmc_camera_file::CameraFile;

use super::Block;
use super::columns::Columns;

/// Bytes that are read at once.
const CAPACITY: usize = 1 << 18;

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

/// Plain rows behind a header.
#[derive(Debug)]
pub(super) struct PlainRows<R> {
    source: R,
    bytes: Vec<u8>,
    /// Bytes that have been taken, and that have been read.
    at: usize,
    end: usize,
    /// Bytes of the file before `bytes`.
    before: u64,
    /// Line of the next row.
    line: u64,
    roles: Vec<Role>,
    is_at_end: bool,
}

/// The reason why a row could not be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NotTaken {
    /// Not all of it has been read.
    Incomplete,
    /// It is not plain.
    NotPlain,
}

/// A row that was taken.
struct Row {
    name: [usize; 2],
    coordinate: [f64; 2],
    end: usize,
}

impl<R: Read> PlainRows<R> {
    /// Reads the first line, which ends with a line feed and holds no quote and no carriage return;
    /// `None` if it is another.
    ///
    /// # Errors
    /// Those of the source.
    pub(super) fn header(source: R) -> io::Result<(Self, Option<Vec<u8>>)> {
        let mut rows = Self {
            source,
            bytes: vec![0; CAPACITY],
            at: 0,
            end: 0,
            before: 0,
            line: 2,
            roles: Vec::new(),
            is_at_end: false,
        };
        while !rows.unread().contains(&b'\n') && !rows.is_at_end && rows.end < CAPACITY {
            rows.read_more()?;
        }
        let unread = rows.unread();
        let length = unread.iter().position(|byte| *byte == b'\n');
        let line = length.and_then(|length| unread.get(..=length));
        let is_plain = |line: &&[u8]| line.len() > 1 && !line.iter().any(|b| b"\"\r".contains(b));
        let line = line.filter(is_plain).map(<[u8]>::to_vec);
        Ok((rows, line))
    }

    /// Begins behind a header of so many bytes, with columns of these meanings.
    pub(super) fn begin(&mut self, header_bytes: usize, roles: Vec<Role>) {
        self.at = header_bytes;
        self.roles = roles;
    }

    /// Line of the next row.
    pub(super) const fn line(&self) -> u64 {
        self.line
    }

    /// Number of bytes of the file that have been taken.
    pub(super) const fn taken(&self) -> u64 {
        self.before + self.at as u64
    }

    /// The bytes that have been read and not taken, and the source behind them.
    pub(super) fn into_rest(mut self) -> (Vec<u8>, R) {
        self.bytes.truncate(self.end);
        self.bytes.drain(..self.at);
        (self.bytes, self.source)
    }

    /// Adds rows to a block; returns `false` if the next row is not plain.
    ///
    /// # Errors
    /// Those of the source; the rows before are in the block.
    pub(super) fn fill(
        &mut self,
        columns: &Columns,
        camera: &CameraFile,
        block: &mut Block,
    ) -> io::Result<bool> {
        while !block.is_full() {
            match self.row() {
                Ok(Row {
                    name: [from, to],
                    coordinate,
                    end,
                }) => {
                    let name = self.bytes.get(from..to).unwrap_or_default();
                    let point_mm = columns.place(coordinate, camera);
                    block.push(name.trim_ascii(), point_mm, self.line);
                    self.at = end;
                    self.line += 1;
                }
                Err(NotTaken::NotPlain) => return Ok(false),
                Err(NotTaken::Incomplete) if self.is_at_end => {
                    return Ok(self.unread().is_empty());
                }
                Err(NotTaken::Incomplete) => {
                    if self.unread().len() >= CAPACITY {
                        return Ok(false);
                    }
                    self.read_more()?;
                }
            }
        }
        Ok(true)
    }

    fn unread(&self) -> &[u8] {
        self.bytes.get(self.at..self.end).unwrap_or_default()
    }

    fn read_more(&mut self) -> io::Result<()> {
        self.bytes.copy_within(self.at..self.end, 0);
        self.before += self.at as u64;
        self.end -= self.at;
        self.at = 0;
        let room = self.bytes.get_mut(self.end..).unwrap_or_default();
        match self.source.read(room) {
            Ok(count) => {
                self.end += count;
                self.is_at_end = count == 0;
                Ok(())
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(()),
            Err(error) => Err(error),
        }
    }

    /// Reads the next row.
    #[inline]
    fn row(&self) -> Result<Row, NotTaken> {
        let bytes = self.bytes.get(..self.end).unwrap_or_default();
        self.plain_row(bytes).ok_or_else(|| {
            // A number may have been cut in two.
            if self.unread().contains(&b'\n') {
                NotTaken::NotPlain
            } else {
                NotTaken::Incomplete
            }
        })
    }

    #[inline]
    fn plain_row(&self, bytes: &[u8]) -> Option<Row> {
        let mut row = Row {
            name: [self.at; 2],
            coordinate: [0.0; 2],
            end: self.at,
        };
        let mut roles = self.roles.iter();
        while let Some(role) = roles.next() {
            let from = row.end;
            let field = bytes.get(from..)?;
            let length = match role {
                Role::Coordinate(index) => {
                    let (number, length) = fast_float2::parse_partial::<f64, _>(field).ok()?;
                    if !number.is_finite() {
                        return None;
                    }
                    *row.coordinate.get_mut(*index)? = number;
                    length
                }
                Role::Name | Role::Other => field.iter().position(|byte| !is_text(*byte))?,
            };
            if *role == Role::Name {
                row.name = [from, from + length];
            }
            let behind = *bytes.get(from + length)?;
            let delimiter = if roles.len() == 0 { b'\n' } else { b',' };
            if behind != delimiter {
                return None;
            }
            row.end = from + length + 1;
        }
        Some(row)
    }
}

/// Returns `true` for a printable character within a plain field.
const fn is_text(byte: u8) -> bool {
    matches!(byte, b' '..=b'~') && byte != b'"' && byte != b','
}
