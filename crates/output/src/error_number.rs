//! Error numbers of the system by the names that C has for them.

use std::io::{Error, ErrorKind};

/// Returns the name of the number of an error that a library has wrapped, and that has lost its own
/// number: `None` for kinds which the writing of files does not have.
#[must_use]
pub fn name(error: &Error) -> Option<&'static str> {
    Some(match error.kind() {
        ErrorKind::AlreadyExists => "EEXIST",
        ErrorKind::InvalidInput => "EINVAL",
        ErrorKind::IsADirectory => "EISDIR",
        ErrorKind::NotADirectory => "ENOTDIR",
        ErrorKind::NotFound => "ENOENT",
        ErrorKind::PermissionDenied => "EACCES",
        ErrorKind::ReadOnlyFilesystem => "EROFS",
        ErrorKind::StorageFull => "ENOSPC",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_of_a_folder_that_is_not_there_is_one_that_is_not_found() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("no/file.txt");
        let missing = crate::part::Part::create(path).unwrap_err();
        assert_eq!(name(&missing), Some("ENOENT"));
        assert_eq!(name(&Error::other("the source has ended")), None);
    }
}
