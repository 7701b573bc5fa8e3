//! Unfinished files.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// Beginning and end of the name of an unfinished file.
const PART: [&str; 2] = [".host-sim-", ".part"];

/// A file that is being written: it has its name once it is complete, and is removed otherwise.
///
/// It is locked as long as it is written, so that what a killed program has left can be told from
/// what another one is writing.
#[derive(Debug)]
pub struct Part {
    file: NamedTempFile,
    path: PathBuf,
}

impl Part {
    /// Creates a file that will be `path`.
    ///
    /// # Errors
    /// Those of the file system, without the name of the unfinished file, which means nothing to
    /// the user.
    pub fn create(path: PathBuf) -> io::Result<Self> {
        let folder = match path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        let [prefix, suffix] = PART;
        builder.prefix(prefix).suffix(suffix);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let nameless = |error: io::Error| io::Error::from(error.kind());
        let file = loop {
            let file = builder.tempfile_in(folder).map_err(nameless)?;
            // Some network file systems have no locks; there an unfinished file is never removed
            // by another program.
            let _ = file.as_file().lock();
            // Another program may have removed it before it was locked.
            if file.path().exists() {
                break file;
            }
        };
        if let Ok(existing) = fs::metadata(&path) {
            file.as_file().set_permissions(existing.permissions())?;
        }
        Ok(Self { file, path })
    }

    /// The file, for reading and for writing at any place.
    pub fn file_mut(&mut self) -> &mut File {
        self.file.as_file_mut()
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// Those of the file system; a full disk may be reported only here.
    pub fn complete(self) -> io::Result<()> {
        self.file.as_file().sync_all()?;
        self.file.persist(&self.path).map_err(io::Error::from)?;
        Ok(())
    }

    /// Removes the unfinished files of a folder that no program is writing.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn remove_abandoned(folder: &Path) -> io::Result<()> {
        let [prefix, suffix] = PART;
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name();
            let is_part = name
                .to_str()
                .is_some_and(|name| name.starts_with(prefix) && name.ends_with(suffix));
            if !is_part {
                continue;
            }
            // A file that has gone meanwhile was another program's.
            let Ok(file) = File::options().write(true).open(entry.path()) else {
                continue;
            };
            if file.try_lock().is_ok() {
                match fs::remove_file(entry.path()) {
                    // Another program has removed it, too.
                    Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                    _ => {}
                }
            }
        }
        Ok(())
    }
}

impl Write for Part {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn only_parts_that_nobody_writes_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let mut written = Part::create(folder.path().join("a.tif")).unwrap();
        written.write_all(b"half").unwrap();
        fs::write(
            folder.path().join(".host-sim-left.part"),
            b"of a killed program",
        )
        .unwrap();
        fs::write(folder.path().join("kept.part"), b"of somebody else").unwrap();
        Part::remove_abandoned(folder.path()).unwrap();
        assert_eq!(names(folder.path()).len(), 2);
        written.complete().unwrap();
        assert_eq!(names(folder.path()), ["a.tif", "kept.part"]);
        assert_eq!(fs::read(folder.path().join("a.tif")).unwrap(), b"half");
    }

    #[test]
    fn part_that_is_dropped_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        drop(Part::create(folder.path().join("a.tif")).unwrap());
        assert_eq!(names(folder.path()), Vec::<String>::new());
    }
}
