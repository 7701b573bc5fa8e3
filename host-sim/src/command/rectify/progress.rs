//! Progress over the frames of a block.

use std::fs;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

/// A bar on a terminal, with frames, bytes per second and the remaining time.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    /// Size of each frame's file.
    bytes: Vec<u64>,
    begun: usize,
    /// Bytes of the frames before this one.
    before: u64,
}

impl Progress {
    pub(super) fn new<'a>(frames: impl Iterator<Item = &'a Path>) -> Self {
        let bytes: Vec<u64> = frames
            .map(|path| fs::metadata(path).map_or(0, |metadata| metadata.len()))
            .collect();
        let bar = ProgressBar::new(bytes.iter().sum());
        if let Ok(style) =
            ProgressStyle::with_template("{bar:10} {msg} frames, {bytes_per_sec}, {eta} left")
        {
            bar.set_style(style);
        }
        Self {
            bar,
            bytes,
            begun: 0,
            before: 0,
        }
    }

    /// Begins the next frame.
    pub(super) fn begin(&mut self) {
        self.bar
            .set_message(format!("{}/{}", self.begun, self.bytes.len()));
        self.begun += 1;
    }

    /// Ends the frame.
    pub(super) fn end(&mut self) {
        self.before += self.bytes_of_frame();
        self.bar.set_position(self.before);
        self.bar
            .set_message(format!("{}/{}", self.begun, self.bytes.len()));
    }

    /// Shows that so many rows of the frame are done.
    pub(super) fn within(&self, rows: usize, of: usize) {
        let bytes = u128::from(self.bytes_of_frame());
        let done = bytes * rows as u128 / of.max(1) as u128;
        let done = u64::try_from(done).unwrap_or_default();
        self.bar.set_position(self.before + done);
    }

    fn bytes_of_frame(&self) -> u64 {
        let frame = self.begun.checked_sub(1);
        frame
            .and_then(|frame| self.bytes.get(frame))
            .copied()
            .unwrap_or_default()
    }

    /// Prints something beside the bar.
    pub(super) fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
