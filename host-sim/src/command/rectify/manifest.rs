//! manifest.csv: what became of every frame of a block.

use std::collections::{HashMap, HashSet};
use std::fs::{self, File};
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord, WriterBuilder};
use fmc_output::part::Part;
use serde::Serialize;

use crate::cli::Shard;
use crate::failure::Failure;

/// Names of the columns.
const COLUMNS: [&str; 10] = [
    "file",
    "sequence",
    "status",
    "output",
    "width_px",
    "height_px",
    "pixels_crc32",
    "border_percent",
    "seconds",
    "error",
];

/// A row of the manifest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Row {
    /// The frame, as it was named.
    pub(super) file: String,
    pub(super) sequence: Option<u32>,
    /// Exit code: 0 done, 2 bad input, 3 device or I/O failure.
    pub(super) status: u8,
    pub(super) output: Option<String>,
    pub(super) width_px: Option<u32>,
    pub(super) height_px: Option<u32>,
    pub(super) pixels_crc32: Option<String>,
    pub(super) border_percent: Option<String>,
    pub(super) seconds: Option<String>,
    pub(super) error: String,
}

/// The manifest of a folder, or of a part of the frames.
///
/// Several programs may append to it: each locks it for the time of a row. A program that was
/// killed may have left half a row, which the next one removes.
#[derive(Debug)]
pub(super) struct Manifest {
    path: PathBuf,
}

impl Manifest {
    /// Opens the manifest of a folder, which need not exist before its first row.
    ///
    /// # Errors
    /// [`Failure`] naming the file, for one that is something else.
    pub(super) fn open(folder: &Path, shard: Option<Shard>) -> Result<Self, Failure> {
        let manifest = Self {
            path: folder.join(name(shard)),
        };
        if manifest.path.exists() {
            manifest.keep_last_rows()?;
        }
        Ok(manifest)
    }

    /// Returns the outputs, without extension, of the frames whose row says that they are done.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub(super) fn done(&self) -> Result<HashSet<String>, Failure> {
        if !self.path.exists() {
            return Ok(HashSet::new());
        }
        let mut file = self.locked().map_err(|error| self.failed(&error))?;
        let rows = self.rows(&mut file)?;
        let done = rows.iter().filter(|row| row.get(2) == Some("0"));
        Ok(done.map(key).collect())
    }

    /// Appends a row.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub(super) fn append(&self, row: &Row) -> Result<(), Failure> {
        let appended = || -> io::Result<()> {
            let mut file = self.locked()?;
            end_at_whole_row(&mut file)?;
            let mut bytes = Vec::new();
            let mut writer = WriterBuilder::new()
                .has_headers(false)
                .from_writer(&mut bytes);
            if file.stream_position()? == 0 {
                writer.write_record(COLUMNS)?;
            }
            writer.serialize(row)?;
            writer.flush()?;
            drop(writer);
            file.write_all(&bytes)
        };
        appended().map_err(|error| self.failed(&error))
    }

    /// Keeps the last row of every frame: a frame that is done anew, or by two programs at the same
    /// time, has one for each time.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub(super) fn keep_last_rows(&self) -> Result<(), Failure> {
        let mut file = self.locked().map_err(|error| self.failed(&error))?;
        let rows = self.rows(&mut file)?;
        let mut last: HashMap<String, usize> = HashMap::new();
        for (place, row) in rows.iter().enumerate() {
            last.insert(key(row), place);
        }
        if last.len() == rows.len() && !rows.is_empty() {
            return Ok(());
        }
        let kept = rows.iter().enumerate();
        let kept = kept.filter(|(place, row)| last.get(&key(row)) == Some(place));
        let replaced = || -> io::Result<()> {
            let mut writer = csv::Writer::from_writer(Part::create(self.path.clone())?);
            writer.write_record(COLUMNS)?;
            for (_, row) in kept {
                writer.write_record(row)?;
            }
            let part = writer
                .into_inner()
                .map_err(|error| io::Error::other(error.to_string()))?;
            part.complete()
        };
        replaced().map_err(|error| self.failed(&error))
    }

    /// Keeps the last row of every frame, or removes the manifest if no row says that a frame is
    /// done.
    ///
    /// # Errors
    /// [`Failure`] naming the file.
    pub(super) fn remove_without_frames(&self) -> Result<(), Failure> {
        let mut file = self.locked().map_err(|error| self.failed(&error))?;
        let rows = self.rows(&mut file)?;
        if rows.iter().any(|row| row.get(2) == Some("0")) {
            drop(file);
            return self.keep_last_rows();
        }
        fs::remove_file(&self.path).map_err(|error| self.failed(&error))
    }

    /// Reads the rows of a file that is locked.
    fn rows(&self, file: &mut File) -> Result<Vec<StringRecord>, Failure> {
        let mut text = Vec::new();
        file.read_to_end(&mut text)
            .map_err(|error| self.failed(&error))?;
        let whole = text
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |end| end + 1);
        let foreign = |line: u64, fault: &str| {
            Failure::bad_input(format!(
                "{}, line {line}: {fault}; it is not the manifest of this command",
                self.path.display()
            ))
            .with_help("another --out, or another name for that file")
        };
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .from_reader(text.get(..whole).unwrap_or_default());
        let mut rows = Vec::new();
        for row in reader.records() {
            let row = row.map_err(|error| {
                let line = error.position().map_or(1, csv::Position::line);
                foreign(line, "not the columns of the header")
            })?;
            rows.push(row);
        }
        match rows.first() {
            None => Ok(rows),
            Some(header) if header == COLUMNS.as_slice() => Ok(rows.split_off(1)),
            Some(_) => Err(foreign(1, &format!("not the header {}", COLUMNS.join(",")))),
        }
    }

    /// Opens the file and locks it.
    fn locked(&self) -> io::Result<File> {
        loop {
            let file = File::options()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(&self.path)?;
            // Some network file systems have no locks; there each machine has a part of its own.
            let _ = file.lock();
            // Another program may have replaced it before it was locked.
            let opened = same_file::Handle::from_file(file.try_clone()?)?;
            if same_file::Handle::from_path(&self.path).is_ok_and(|named| named == opened) {
                return Ok(file);
            }
        }
    }

    fn failed(&self, error: &io::Error) -> Failure {
        Failure::writing(self.path.display(), error)
    }
}

/// Returns the name of the manifest, of all frames or of a part.
pub(super) fn name(shard: Option<Shard>) -> String {
    match shard {
        None => "manifest.csv".to_owned(),
        Some(Shard { number, of }) => format!("manifest-{number}-of-{of}.csv"),
    }
}

/// Returns the name of a row's output without extension, which is that of the frame.
fn key(row: &StringRecord) -> String {
    let stem = row.get(0).and_then(|file| Path::new(file).file_stem());
    stem.map_or(String::new(), |stem| stem.to_string_lossy().into_owned())
}

/// Goes to the end of the last whole row, and removes what follows.
fn end_at_whole_row(file: &mut File) -> io::Result<()> {
    /// Bytes that are read at once.
    const STEP: u64 = 4096;
    let mut end = file.seek(SeekFrom::End(0))?;
    let length = end;
    let mut bytes = Vec::new();
    while end > 0 {
        let start = end.saturating_sub(STEP);
        file.seek(SeekFrom::Start(start))?;
        bytes.clear();
        file.take(end - start).read_to_end(&mut bytes)?;
        if let Some(newline) = bytes.iter().rposition(|byte| *byte == b'\n') {
            end = start + newline as u64 + 1;
            break;
        }
        end = start;
    }
    if end < length {
        file.set_len(end)?;
    }
    file.seek(SeekFrom::Start(end))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(file: &str) -> Row {
        Row {
            file: file.to_owned(),
            sequence: Some(1),
            status: 0,
            output: Some("a, b.tif".to_owned()),
            width_px: Some(10),
            height_px: Some(20),
            pixels_crc32: Some("0123abcd".to_owned()),
            border_percent: Some("0.000".to_owned()),
            seconds: Some("0.10".to_owned()),
            error: String::new(),
        }
    }

    fn opened(folder: &Path) -> Manifest {
        Manifest::open(folder, None).unwrap()
    }

    #[test]
    fn manifest_without_a_finished_frame_can_be_removed_and_another_not() {
        let folder = tempfile::tempdir().unwrap();
        let manifest = opened(folder.path());
        let failed = Row {
            status: 2,
            output: None,
            ..row("1.tif")
        };
        manifest.append(&failed).unwrap();
        manifest.append(&row("2.tif")).unwrap();
        manifest.remove_without_frames().unwrap();
        let path = folder.path().join("manifest.csv");
        assert!(path.exists());
        fs::remove_file(&path).unwrap();
        manifest.append(&failed).unwrap();
        manifest.remove_without_frames().unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn frame_that_is_done_anew_has_one_row() {
        let folder = tempfile::tempdir().unwrap();
        let manifest = opened(folder.path());
        for name in ["1.tif", "2.tif", "./1.tif"] {
            manifest.append(&row(name)).unwrap();
        }
        let failed = Row {
            status: 3,
            ..row("2.tif")
        };
        manifest.append(&failed).unwrap();
        manifest.keep_last_rows().unwrap();
        assert_eq!(manifest.done().unwrap(), HashSet::from(["1".to_owned()]));
        let text = fs::read_to_string(folder.path().join("manifest.csv")).unwrap();
        let expected = "file,sequence,status,output,width_px,height_px,pixels_crc32,border_percent,seconds,error\n\
             ./1.tif,1,0,\"a, b.tif\",10,20,0123abcd,0.000,0.10,\n\
             2.tif,1,3,\"a, b.tif\",10,20,0123abcd,0.000,0.10,\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn half_a_row_of_a_killed_program_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("manifest.csv");
        let manifest = opened(folder.path());
        manifest.append(&row("1.tif")).unwrap();
        let whole = fs::read(&path).unwrap();
        for half in ["2", "2.tif,1,0,a.ti", &"x".repeat(10_000)] {
            fs::write(&path, [&whole, half.as_bytes()].concat()).unwrap();
            manifest.append(&row("3.tif")).unwrap();
            let done = manifest.done().unwrap();
            assert_eq!(done, HashSet::from(["1".to_owned(), "3".to_owned()]));
        }
    }

    #[test]
    fn file_that_is_no_manifest_is_refused_and_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("manifest.csv");
        for text in ["a,b\n1,2\n", "file,sequence\n1.tif,2\n"] {
            fs::write(&path, text).unwrap();
            assert!(Manifest::open(folder.path(), None).is_err());
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
    }
}
