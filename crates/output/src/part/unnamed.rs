//! Files without a name, which the system removes when the program ends, however it does.

use std::fs::File;
use std::io;
use std::os::fd::AsRawFd;
use std::path::{Path, PathBuf};

use rustix::fs::{AtFlags, CWD, Mode, OFlags, linkat, openat};

/// Opens a file without a name in a folder, where the file system has them (`O_TMPFILE`).
pub(super) fn create(folder: &Path) -> Option<File> {
    let flags = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
    // As any new file of this user: the umask is taken off.
    let file = File::from(openat(CWD, folder, flags, Mode::from_raw_mode(0o666)).ok()?);
    // Without this it cannot be given a name.
    handle(&file).exists().then_some(file)
}

/// Gives the file a name that no other has.
///
/// # Errors
/// `AlreadyExists`, and others of the file system.
pub(super) fn link(file: &File, path: &Path) -> io::Result<()> {
    Ok(linkat(
        CWD,
        handle(file),
        CWD,
        path,
        AtFlags::SYMLINK_FOLLOW,
    )?)
}

fn handle(file: &File) -> PathBuf {
    Path::new("/proc/self/fd").join(file.as_raw_fd().to_string())
}
