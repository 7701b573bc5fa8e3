//! The firmware's log, decoded as it comes.

use std::collections::VecDeque;
use std::io::{self, Read, Write as _};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

use defmt_decoder::{DecodeError, Table};

/// Lines that are kept for a report of what went wrong.
pub const KEPT: usize = 20;

/// The last lines of something that runs.
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

    /// The lines, oldest first.
    #[must_use]
    pub fn all(&self) -> Vec<String> {
        let lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        lines.iter().cloned().collect()
    }
}

/// Decodes a log until it ends; `print` shows the lines on the error stream as they come. The
/// thread ends with the wire.
pub fn follow(
    mut wire: impl Read + Send + 'static,
    elf: &[u8],
    print: bool,
) -> (LastLines, JoinHandle<()>) {
    let lines = LastLines::default();
    // Without the table there is a log, but nobody can read it.
    let table = Table::parse(elf).ok().flatten();
    let kept = lines.clone();
    let thread = thread::spawn(move || {
        let mut decoder = table.as_ref().map(Table::new_stream_decoder);
        let mut buffer = [0; 1024];
        loop {
            let count = match wire.read(&mut buffer) {
                Ok(0) => return,
                Ok(count) => count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(_) => return,
            };
            let Some(decoder) = &mut decoder else {
                continue;
            };
            decoder.received(buffer.get(..count).unwrap_or_default());
            loop {
                let line = match decoder.decode() {
                    Ok(frame) => frame.display(false).to_string(),
                    Err(DecodeError::UnexpectedEof) => break,
                    // A restart cuts a frame short; the next one is whole.
                    Err(DecodeError::Malformed) => "(a line of the log is unreadable)".to_owned(),
                };
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
    fn log_without_symbols_is_read_and_dropped() {
        let (lines, thread) = follow(&b"\x01\x02\x00garbage\x00"[..], b"no ELF", false);
        thread.join().unwrap();
        assert!(lines.all().is_empty());
    }
}
