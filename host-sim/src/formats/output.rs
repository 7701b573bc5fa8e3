//! Output files that appear only when they are complete.

use std::fmt::Display;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use fmc_camera_file::InputError;
use fmc_output::file_set::FileSet;
use fmc_output::{place, unfinished};
use serde::Serialize;

use crate::failure::Failure;

/// Writes to standard output, or to a file that appears only when it is complete.
///
/// # Errors
/// [`Failure`] naming the file; nothing of it is left behind.
pub fn write(
    path: Option<&Path>,
    body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    stream(path, |sink| body(sink).map_err(Stopped::from))
}

/// A reason why an output was not completed.
#[derive(Debug)]
pub enum Stopped {
    /// The output cannot be written.
    Output(io::Error),
    /// The source of the output has failed.
    Body(Failure),
}

impl Stopped {
    fn failure(self, name: impl Display) -> Failure {
        match self {
            Self::Output(error) => Failure::writing(name, &error),
            Self::Body(failure) => failure,
        }
    }
}

impl From<io::Error> for Stopped {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

impl From<InputError> for Stopped {
    fn from(error: InputError) -> Self {
        Self::Body(error.into())
    }
}

impl From<Failure> for Stopped {
    fn from(failure: Failure) -> Self {
        Self::Body(failure)
    }
}

/// Writes as [`write()`] does, from a body that may itself fail: a file then does not appear,
/// standard output keeps what was written to it.
///
/// # Errors
/// [`Failure`] of the body, or one naming the file.
pub fn stream(
    path: Option<&Path>,
    body: impl FnOnce(&mut dyn Write) -> Result<(), Stopped>,
) -> Result<(), Failure> {
    let (written, name) = match path {
        None => {
            let mut stdout = BufWriter::new(io::stdout().lock());
            let written = body(&mut stdout).and_then(|()| Ok(stdout.flush()?));
            (written, "standard output".to_owned())
        }
        Some(path) => (write_file(path, body), path.display().to_string()),
    };
    written.map_err(|stopped| stopped.failure(name))
}

/// Refuses to replace the camera file by an answer.
///
/// # Errors
/// [`Failure`] naming the file.
pub fn check_not_the_input(out: Option<&Path>, camera: &Path) -> Result<(), Failure> {
    if out.is_some_and(|out| place::is_the_same(out, camera)) {
        return Err(Failure::bad_input(format!(
            "--out {} is the camera file itself",
            camera.display()
        )));
    }
    Ok(())
}

/// Refuses to replace another input by an answer.
///
/// # Errors
/// [`Failure`] naming the file.
pub fn check_not_an_input(out: &Path, input: &Path) -> Result<(), Failure> {
    if place::is_the_same(out, input) {
        return Err(Failure::bad_input(format!(
            "--out would replace {}, which is read; name another folder",
            input.display()
        )));
    }
    Ok(())
}

/// Returns `true` if two answers, which may not exist yet, have one place.
#[must_use]
pub fn name_the_same(one: &Path, other: &Path) -> bool {
    let place = |path: &Path| {
        let folder = path.parent().filter(|folder| *folder != Path::new(""));
        let folder = fs::canonicalize(folder.unwrap_or(Path::new("."))).ok()?;
        Some(folder.join(path.file_name()?))
    };
    one == other || place(one).is_some_and(|one| place(other) == Some(one))
}

fn write_file(
    path: &Path,
    body: impl FnOnce(&mut dyn Write) -> Result<(), Stopped>,
) -> Result<(), Stopped> {
    match unfinished::write(path, body)? {
        Some(part) => Ok(part.complete()?),
        None => Ok(()),
    }
}

/// A folder that receives files, each only when it is complete; other files in it are left alone.
#[derive(Debug, Clone)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Creates the folder unless it exists.
    ///
    /// # Errors
    /// [`Failure`] naming the folder.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        fs::create_dir_all(path).map_err(|error| Failure::writing(path.display(), &error))?;
        Ok(Self {
            path: path.to_path_buf(),
        })
    }

    /// Path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Puts the names of its files on the disk.
    ///
    /// # Errors
    /// [`Failure`] naming the folder.
    pub fn sync(&self) -> Result<(), Failure> {
        // Other systems cannot open a folder, and offer nothing safer than renaming.
        if cfg!(unix) {
            File::open(&self.path)
                .and_then(|folder| folder.sync_all())
                .map_err(|error| Failure::writing(self.path.display(), &error))?;
        }
        Ok(())
    }

    /// Writes one file of the folder.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub fn write(
        &self,
        name: &str,
        body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        write(Some(&self.path.join(name)), body)
    }

    /// Writes a value as one file of the folder, in JSON.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), Failure> {
        self.write(name, |sink| json(sink, value))
    }
}

/// Files of a folder that appear together, once the last of them is written.
#[derive(Debug)]
pub struct OutputSet<'a> {
    folder: &'a OutputFolder,
    files: FileSet,
}

impl<'a> OutputSet<'a> {
    /// Begins a set of files.
    #[must_use]
    pub fn new(folder: &'a OutputFolder) -> Self {
        Self {
            folder,
            files: FileSet::default(),
        }
    }

    /// Writes one file of the set.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub fn write(
        &mut self,
        name: &str,
        body: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        self.stream(name, |sink| body(sink).map_err(Stopped::from))
    }

    /// Writes one file of the set, from a body that may itself fail.
    ///
    /// # Errors
    /// [`Failure`] of the body, or one naming the file.
    pub fn stream(
        &mut self,
        name: &str,
        body: impl FnOnce(&mut dyn Write) -> Result<(), Stopped>,
    ) -> Result<(), Failure> {
        let path = self.folder.path.join(name);
        let written = self.files.write(&path, body);
        written.map_err(|stopped| stopped.failure(path.display()))
    }

    /// Writes a value as one file of the set, in JSON.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub fn write_json(&mut self, name: &str, value: &impl Serialize) -> Result<(), Failure> {
        self.write(name, |sink| json(sink, value))
    }

    /// Gives all files their names.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub fn complete(self) -> Result<(), Failure> {
        let completed = self.files.complete();
        completed.map_err(|file| Failure::writing(file.path.display(), &file.error))
    }
}

fn json(sink: &mut dyn Write, value: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *sink, value)?;
    writeln!(sink)
}
