//! Files that appear together.

use std::io;
use std::path::{Path, PathBuf};

use crate::part::Part;
use crate::unfinished;

/// Files that appear together, once the last of them is written.
#[derive(Debug, Default)]
pub struct FileSet {
    parts: Vec<(PathBuf, Part)>,
}

/// A file of a set that could not be given its name.
#[derive(Debug)]
pub struct Incomplete {
    /// Its name.
    pub path: PathBuf,
    /// The reason.
    pub error: io::Error,
}

impl FileSet {
    /// Writes one file of the set.
    ///
    /// # Errors
    /// Those of the file system and of `body`.
    pub fn write<E: From<io::Error>>(
        &mut self,
        path: &Path,
        body: impl FnOnce(&mut dyn io::Write) -> Result<(), E>,
    ) -> Result<(), E> {
        if let Some(mut part) = unfinished::write(path, body)? {
            // On the disk now: nothing is waited for between the names of the first and the last.
            part.file_mut().sync_all()?;
            self.parts.push((path.to_path_buf(), part));
        }
        Ok(())
    }

    /// Gives all files their names.
    ///
    /// # Errors
    /// [`Incomplete`] with the first file that cannot have its name; those before it have theirs.
    pub fn complete(self) -> Result<(), Incomplete> {
        for (path, part) in self.parts {
            part.complete()
                .map_err(|error| Incomplete { path, error })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn set_that_is_dropped_leaves_nothing_and_one_that_is_completed_has_all_files() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["a.txt", "b.txt"].map(|name| folder.path().join(name));
        let write = |set: &mut FileSet| {
            for path in &paths {
                set.write(path, |sink| sink.write_all(b"whole")).unwrap();
            }
        };
        let mut dropped = FileSet::default();
        write(&mut dropped);
        drop(dropped);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let mut set = FileSet::default();
        write(&mut set);
        set.complete().unwrap();
        for path in &paths {
            assert_eq!(fs::read(path).unwrap(), b"whole");
        }
    }

    #[test]
    fn file_whose_body_fails_is_not_in_the_set() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let mut set = FileSet::default();
        let failed = set.write(&path, |sink| {
            sink.write_all(b"half")?;
            Err(io::Error::other("the source has ended"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "the source has ended");
        set.complete().unwrap();
        assert!(!path.exists());
        let folder_itself = FileSet::default().write(folder.path(), |_| Ok::<(), io::Error>(()));
        assert_eq!(
            folder_itself.unwrap_err().kind(),
            io::ErrorKind::IsADirectory
        );
    }
}
