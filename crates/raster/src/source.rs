//! Bytes at places of a file.

use std::fs::File;
use std::io::{self, Read};
use std::sync::Arc;

/// A file whose bytes are read at any place, by several readers at once.
pub trait Source: Send + Sync {
    /// Returns the length in bytes.
    ///
    /// # Errors
    /// The error of the operating system.
    fn length(&self) -> io::Result<u64>;

    /// Reads bytes at an offset and returns how many were read; 0 is the end of the file.
    ///
    /// # Errors
    /// The error of the operating system.
    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> io::Result<usize>;
}

impl Source for File {
    fn length(&self) -> io::Result<u64> {
        Ok(self.metadata()?.len())
    }

    #[cfg(unix)]
    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> io::Result<usize> {
        std::os::unix::fs::FileExt::read_at(self, bytes, offset)
    }

    #[cfg(windows)]
    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> io::Result<usize> {
        std::os::windows::fs::FileExt::seek_read(self, bytes, offset)
    }
}

impl Source for Vec<u8> {
    fn length(&self) -> io::Result<u64> {
        Ok(self.len() as u64)
    }

    fn read_at(&self, offset: u64, mut bytes: &mut [u8]) -> io::Result<usize> {
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let mut rest = self.get(start..).unwrap_or_default();
        let count = rest.len().min(bytes.len());
        io::copy(&mut rest.by_ref().take(count as u64), &mut bytes)?;
        Ok(count)
    }
}

/// A stretch of a file, read from its beginning to its end.
pub(crate) struct Segment {
    source: Arc<dyn Source>,
    offset: u64,
    left_bytes: u64,
}

impl Segment {
    /// Returns the stretch of so many bytes from an offset on.
    pub(crate) fn new(source: Arc<dyn Source>, offset: u64, length: u64) -> Self {
        Self {
            source,
            offset,
            left_bytes: length,
        }
    }
}

impl Read for Segment {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let wanted = usize::try_from(self.left_bytes).unwrap_or(usize::MAX);
        let count = wanted.min(bytes.len());
        let bytes = bytes.get_mut(..count).unwrap_or_default();
        let read = self.source.read_at(self.offset, bytes)?;
        self.offset += read as u64;
        self.left_bytes -= read as u64;
        Ok(read)
    }
}
