//! Output files that appear only when they are complete, alone or together.
//!
//! ```
//! use std::io::{self, Write as _};
//!
//! use fmc_output::file_set::FileSet;
//!
//! let folder = tempfile::tempdir()?;
//! let [one, other] = ["one.txt", "other.txt"].map(|name| folder.path().join(name));
//! let mut set = FileSet::default();
//! set.write(&one, |sink| sink.write_all(b"1"))?;
//! set.write(&other, |sink| sink.write_all(b"2"))?;
//! assert!(!one.exists() && !other.exists());
//! set.complete().map_err(|incomplete| incomplete.error)?;
//! assert!(one.exists() && other.exists());
//! # Ok::<(), io::Error>(())
//! ```

#![forbid(unsafe_code)]

pub mod error_number;
pub mod file_set;
pub mod interruption;
pub mod part;
pub mod place;
pub mod unfinished;
