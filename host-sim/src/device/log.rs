//! The firmware's log, decoded while it arrives.

mod argument;
mod line;
mod table;

use std::collections::VecDeque;
use std::io::{self, Read, Write as _};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use table::Table;

/// Number of lines that are kept for an error report.
pub const KEPT: usize = 20;

/// The last lines of a program's output.
#[derive(Debug, Clone, Default)]
pub struct LastLines {
    lines: Arc<Mutex<VecDeque<String>>>,
}

impl LastLines {
    /// Adds a line and forgets the oldest beyond [`KEPT`].
    pub fn push(&self, line: String) {
        let mut lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        if lines.len() == KEPT {
            lines.pop_front();
        }
        lines.push_back(line);
    }

    /// Returns the lines, oldest first.
    #[must_use]
    pub fn all(&self) -> Vec<String> {
        let lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        lines.iter().cloned().collect()
    }
}

/// Returns the format strings of an image's log whose arguments are not shown; `None` where the
/// image has no format strings.
#[must_use]
pub fn formats_not_shown(elf: &[u8]) -> Option<Vec<String>> {
    let table = Table::parse(elf)?;
    let mut formats = table.formats().peekable();
    formats.peek()?;
    let others = formats.filter(|format| !line::is_shown(format));
    Some(others.map(str::to_owned).collect())
}

/// Decodes a log until it ends; `print` shows the lines on the error stream as they come. The
/// thread ends when the wire is closed.
pub fn follow(
    mut wire: impl Read + Send + 'static,
    elf: &[u8],
    print: bool,
) -> (LastLines, JoinHandle<()>) {
    let lines = LastLines::default();
    // Without the table the log cannot be decoded; it is read and dropped.
    let table = Table::parse(elf);
    let kept = lines.clone();
    let thread = thread::spawn(move || {
        let mut frame = Vec::new();
        let mut buffer = [0; 1024];
        loop {
            let count = match wire.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(_) => return,
            };
            let Some(table) = &table else {
                continue;
            };
            for byte in buffer.get(..count).unwrap_or_default() {
                if *byte != 0 {
                    frame.push(*byte);
                    continue;
                }
                // Frames are separated by one or more zeros.
                if frame.is_empty() {
                    continue;
                }
                // A restart cuts a frame short; the next frame is whole.
                let line = line::decode(table, &frame)
                    .unwrap_or_else(|| "(a line of the log is unreadable)".to_owned());
                frame.clear();
                if print {
                    let _ = writeln!(io::stderr(), "firmware: {line}");
                }
                kept.push(line);
            }
        }
    });
    (lines, thread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_lines_are_kept() {
        let lines = LastLines::default();
        for number in 0..KEPT + 5 {
            lines.push(number.to_string());
        }
        let all = lines.all();
        assert_eq!(all.len(), KEPT);
        assert_eq!(all.first().unwrap(), "5");
        assert_eq!(all.last().unwrap(), "24");
    }

    #[test]
    fn frames_are_told_apart_however_they_arrive() {
        struct ByteByByte(Vec<u8>);
        impl Read for ByteByByte {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                let Some(byte) = self.0.pop() else {
                    return Ok(0);
                };
                buffer[0] = byte;
                Ok(1)
            }
        }
        let image = table::tests::image(&[(1, "defmt_info", "number {=u8}")], ["4", "rzcobs"]);
        let mut wire = vec![0];
        for number in [0, 200] {
            wire.extend(rzcobs::encode(&[1, 0, number]));
            wire.extend([0, 0]);
        }
        // A frame cut short by a restart, and a frame that has not ended yet.
        wire.extend([0x80, 0]);
        wire.extend(rzcobs::encode(&[1, 0, 7]));
        let expected = [
            "INFO number 0",
            "INFO number 200",
            "(a line of the log is unreadable)",
        ];
        let (lines, thread) = follow(io::Cursor::new(wire.clone()), &image, false);
        thread.join().unwrap();
        assert_eq!(lines.all(), expected);
        wire.reverse();
        let (lines, thread) = follow(ByteByByte(wire), &image, false);
        thread.join().unwrap();
        assert_eq!(lines.all(), expected);
    }

    #[test]
    fn log_without_symbols_is_read_and_dropped() {
        let (lines, thread) = follow(&b"\x01\x02\x00garbage\x00"[..], b"no ELF", false);
        thread.join().unwrap();
        assert!(lines.all().is_empty());
    }
}
