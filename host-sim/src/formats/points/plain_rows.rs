//! Rows of a CSV file in one pass, as long as they are plain: no quote, no carriage return, every
//! field as the header has it, every coordinate a number.
//!
//! The first other row ends them; it and all behind it are the CSV reader's, which knows what they
//! mean.

use std::io::{self, ErrorKind, Read};

use fmc_camera_file::CameraFile;
use memchr::{memchr_iter, memrchr};

use super::Block;
use super::row_grammar::RowGrammar;

/// Bytes that are read at once.
const CAPACITY: usize = 1 << 18;

/// Bytes whose lines are counted together.
const COUNTED_BYTES: usize = 1 << 12;

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
    is_at_end: bool,
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

    /// Begins behind a header of so many bytes.
    pub(super) const fn begin(&mut self, header_bytes: usize) {
        self.at = header_bytes;
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
        grammar: &RowGrammar,
        camera: &CameraFile,
        block: &mut Block,
    ) -> io::Result<bool> {
        while block.room() > 0 {
            let rows = length_of_lines(self.unread(), block.room());
            if rows > 0 {
                let rows = self.unread().get(..rows).unwrap_or_default();
                let (length, room) = (rows.len(), block.room());
                let taken = grammar.take(rows, camera, block);
                block.number_lines(self.line);
                self.line += (room - block.room()) as u64;
                self.at += taken;
                if taken < length {
                    return Ok(false);
                }
            } else if self.is_at_end {
                return Ok(self.unread().is_empty());
            } else if self.unread().len() >= CAPACITY {
                return Ok(false);
            } else {
                self.read_more()?;
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
}

/// Returns the length of the first lines, at most so many, with their ends.
fn length_of_lines(bytes: &[u8], most: usize) -> usize {
    let (mut length, mut left) = (0, most);
    for counted in bytes.chunks(COUNTED_BYTES) {
        let mut ends = memchr_iter(b'\n', counted);
        let count = ends.clone().count();
        if count >= left {
            let last = ends.nth(left.saturating_sub(1));
            return length + last.map_or(0, |last| last + 1);
        }
        left -= count;
        length += counted.len();
    }
    memrchr(b'\n', bytes).map_or(0, |last| last + 1)
}
