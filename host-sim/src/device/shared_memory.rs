//! The file of the memory that QEMU shares with this program: the firmware's flash is in it.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use tempfile::{NamedTempFile, TempPath};

use super::open::OpenError;

/// Bytes of the memory, the machine's PSRAM.
pub const MEMORY_BYTES: u64 = 16 << 20;

/// Bytes at its begin that are of one run alone.
static BLOCKS: [u8; 0x5000] = [0; 0x5000];

/// Place and contents of the mark of a file that keeps a flash.
const MARK_AT: u64 = 0xf_0000;
const MARK: [u8; 32] = *b"flash of the fmc-camera in QEMU\n";

/// Time for which a lock is waited for. A program that this one is about to start holds the lock,
/// though it is given back here, until it has closed what it is not to have.
const LOCK_WAIT: Duration = Duration::from_secs(1);

/// The file, for as long as the machine runs.
#[derive(Debug)]
pub struct SharedMemory {
    file: File,
    path: PathBuf,
    /// `None` for a file that is kept.
    temporary: Option<TempPath>,
}

impl SharedMemory {
    /// Creates a file for one run, where QEMU can map one: the flash in it is blank.
    ///
    /// # Errors
    /// Those of the system.
    pub fn temporary() -> io::Result<Option<Self>> {
        if !cfg!(unix) {
            return Ok(None);
        }
        let (file, path) = NamedTempFile::new()?.into_parts();
        file.set_len(MEMORY_BYTES)?;
        Ok(Some(Self {
            file,
            path: path.to_path_buf(),
            temporary: Some(path),
        }))
    }

    /// Opens the file that keeps a flash, for this program alone; creates one that is blank.
    ///
    /// # Errors
    /// [`OpenError::Flash`] for a file that is something else, is in use, or cannot be opened.
    pub fn kept(path: &Path) -> Result<Self, OpenError> {
        let failed = |what: String| OpenError::Flash {
            path: path.to_owned(),
            what,
        };
        if !cfg!(unix) {
            return Err(failed("QEMU shares no memory on this system".to_owned()));
        }
        if path.to_str().is_none() {
            return Err(failed(
                "its name is not UTF-8, as options of QEMU are".to_owned(),
            ));
        }
        let opened = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path);
        let file = opened.map_err(|error| failed(format!("cannot be opened: {error}")))?;
        lock(&file).map_err(|error| match error {
            TryLockError::WouldBlock => failed("is in use by another program".to_owned()),
            TryLockError::Error(error) => failed(format!("cannot be locked: {error}")),
        })?;
        let system = |error: io::Error| failed(format!("cannot be used: {error}"));
        let length = file.metadata().map_err(system)?.len();
        if length == 0 {
            // The mark is written last: a file without it is none of these.
            file.set_len(MEMORY_BYTES).map_err(system)?;
            write_at(&file, MARK_AT, &MARK).map_err(system)?;
        } else if length != MEMORY_BYTES || !is_marked(&file) {
            return Err(failed(format!(
                "is not the flash of a camera in QEMU: {length} bytes instead of {MEMORY_BYTES}, or without its mark; name a new file"
            )));
        }
        // Messages that an earlier run has left are not of this one.
        write_at(&file, 0, &BLOCKS).map_err(system)?;
        Ok(Self {
            file,
            path: path.to_owned(),
            temporary: None,
        })
    }

    /// Path by which QEMU opens it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub(super) const fn file(&self) -> &File {
        &self.file
    }

    /// Returns the file; that of one run loses its name, which QEMU does not need any more.
    pub(super) fn into_file(self) -> File {
        drop(self.temporary);
        self.file
    }
}

fn is_marked(file: &File) -> bool {
    let mut mark = [0; MARK.len()];
    read_at(file, MARK_AT, &mut mark).is_ok() && mark == MARK
}

#[cfg(unix)]
pub(super) fn read_at(memory: &File, at: u64, bytes: &mut [u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(memory, bytes, at)
}

#[cfg(unix)]
pub(super) fn write_at(memory: &File, at: u64, bytes: &[u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::write_all_at(memory, bytes, at)
}

/// Fails: QEMU shares no memory here, so that there is no file.
#[cfg(not(unix))]
pub(super) fn read_at(_: &File, _: u64, _: &mut [u8]) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Fails as [`read_at`].
#[cfg(not(unix))]
pub(super) fn write_at(_: &File, _: u64, _: &[u8]) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

/// Locks a file for this program.
fn lock(file: &File) -> Result<(), TryLockError> {
    let until = Instant::now() + LOCK_WAIT;
    loop {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if Instant::now() < until => {
                thread::sleep(Duration::from_millis(5));
            }
            result => return result,
        }
    }
}

#[cfg(all(test, unix))]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use std::fs;

    use super::*;

    fn refused(path: &Path) -> String {
        SharedMemory::kept(path).unwrap_err().to_string()
    }

    #[test]
    fn flash_is_kept_for_one_program_at_a_time_and_the_messages_of_a_run_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flash");
        let first = SharedMemory::kept(&path).unwrap();
        write_at(first.file(), 4, b"open").unwrap();
        write_at(first.file(), 0x10_0000, b"kept").unwrap();
        assert!(refused(&path).contains("is in use by another program"));
        drop(first);
        let second = SharedMemory::kept(&path).unwrap();
        let mut word = [1; 4];
        read_at(second.file(), 4, &mut word).unwrap();
        assert_eq!(word, [0; 4]);
        read_at(second.file(), 0x10_0000, &mut word).unwrap();
        assert_eq!(&word, b"kept");
        assert!(second.into_file().metadata().unwrap().len() == MEMORY_BYTES);
        assert!(path.is_file());
    }

    #[test]
    fn other_file_is_refused_and_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("letter");
        fs::write(&path, "Dear").unwrap();
        let error = refused(&path);
        assert!(
            error.contains("letter: is not the flash") && error.contains("4 bytes"),
            "{error}"
        );
        assert_eq!(fs::read(&path).unwrap(), b"Dear");
        let large = folder.path().join("large");
        File::create(&large).unwrap().set_len(MEMORY_BYTES).unwrap();
        assert!(refused(&large).contains("is not the flash"));
        assert!(refused(folder.path()).contains("cannot be opened"));
    }
}
