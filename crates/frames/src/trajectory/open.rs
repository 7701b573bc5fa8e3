//! Opening of a trajectory.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use csv::StringRecord;
use fmc_camera_file::InputError;

use super::accuracy::Accuracy;
use super::clock::{Clock, TimeScale};
use super::heading::{Coordinates, Heading};
use super::index::Index;
use super::sample::OrientationSigma;
use super::samples::{SampleFile, SampleFormat, SamplePlace, table_reader};
use super::{Trajectory, sbet};
use crate::Lines;
use crate::columns::{check_length, csv_error, names};

/// Longest interval between samples that is interpolated, s, unless another is asked for.
pub const LONGEST_GAP_S: f64 = 1.5;

/// Bytes of a file from which its format is told.
const START: usize = 64;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Facts of a trajectory that its file does not state.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryOptions {
    /// Scale of the times of an SBET file; `None` stands for GPS time. A table says it itself.
    pub scale: Option<TimeScale>,
    /// Longest interval between samples that is interpolated, s.
    pub longest_gap_s: f64,
    /// σ of a trajectory without σ.
    pub sigma: Option<OrientationSigma>,
    /// File of σ ("smrmsg") that goes with an SBET file.
    pub accuracy: Option<PathBuf>,
}

impl Default for TrajectoryOptions {
    fn default() -> Self {
        Self {
            scale: None,
            longest_gap_s: LONGEST_GAP_S,
            sigma: None,
            accuracy: None,
        }
    }
}

impl Trajectory {
    /// Opens a file, and reads it once from beginning to end; `read_bytes` is told how far.
    ///
    /// Text is a table in CSV, everything else an SBET file.
    ///
    /// # Errors
    /// [`InputError`] naming file, line or record, field, value and allowed range: half a record, a
    /// number that is none or out of its range, a time that does not ascend, columns that are
    /// missing, fewer than three samples.
    pub fn open(
        path: &Path,
        options: &TrajectoryOptions,
        read_bytes: impl Fn(u64),
    ) -> Result<Self, InputError> {
        let unreadable = |error| InputError::reading(path, &error);
        let file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let mut file = BufReader::with_capacity(1 << 18, file);
        let start = file.fill_buf().map_err(unreadable)?;
        let start = start.get(..START).unwrap_or(start);
        let name = path.display().to_string();
        let (mut file, from) = if start.is_empty() {
            return Err(InputError::invalid(format!("{name}: the file is empty")));
        } else if is_text(start) {
            let mark = start.starts_with(BYTE_ORDER_MARK);
            if options.scale.is_some() {
                return Err(InputError::invalid(format!(
                    "--trajectory-time: the columns of {name} say the scale of its times"
                )));
            }
            table(
                name,
                file,
                if mark {
                    BYTE_ORDER_MARK.len() as u64
                } else {
                    0
                },
            )?
        } else {
            records(name, file, length, options.scale.unwrap_or_default())?
        };
        let accuracy = match (&options.accuracy, &file.format) {
            (None, _) => None,
            (Some(accuracy), SampleFormat::Sbet) => Some(Accuracy::read(accuracy)?),
            (Some(accuracy), SampleFormat::Table(_)) => {
                return Err(InputError::invalid(format!(
                    "{}: goes with an SBET file; the table {} has σ in its columns",
                    accuracy.display(),
                    file.name
                )));
            }
        };
        let index = Index::of(&mut file, from, options.longest_gap_s, read_bytes)?;
        Ok(Self {
            coordinates: match &file.format {
                SampleFormat::Sbet => Coordinates::Geographic,
                SampleFormat::Table(heading) => heading.coordinates,
            },
            file,
            index,
            longest_gap_s: options.longest_gap_s,
            sigma: options.sigma,
            accuracy,
            part: None,
            samples: Vec::new(),
        })
    }
}

/// Returns `true` if a file begins with text: the header of a table.
fn is_text(start: &[u8]) -> bool {
    let start = start.strip_prefix(BYTE_ORDER_MARK).unwrap_or(start);
    start
        .iter()
        .all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace())
}

fn records(
    name: String,
    file: BufReader<File>,
    length: u64,
    scale: TimeScale,
) -> Result<(SampleFile, SamplePlace), InputError> {
    let bytes = sbet::BYTES as u64;
    if !length.is_multiple_of(bytes) {
        return Err(InputError::invalid(format!(
            "{name}: {length} bytes are not whole records of {bytes} bytes: {} bytes follow record {}",
            length % bytes,
            length / bytes
        ))
        .with_help("--trajectory takes SBET files and CSV"));
    }
    let clock = Clock { scale, week: None };
    let format = SampleFormat::Sbet;
    let from = SamplePlace {
        number: 1,
        ..SamplePlace::default()
    };
    Ok((
        SampleFile {
            name,
            file,
            format,
            clock,
        },
        from,
    ))
}

fn table(
    name: String,
    mut file: BufReader<File>,
    start: u64,
) -> Result<(SampleFile, SamplePlace), InputError> {
    let unreadable = |error| InputError::reading(name.as_ref(), &error);
    file.seek(SeekFrom::Start(start)).map_err(unreadable)?;
    let mut rows = table_reader(&mut file);
    let mut row = StringRecord::new();
    let mut next = |row: &mut StringRecord| {
        rows.read_record(row)
            .map_err(|error| csv_error(&name, &[], &StringRecord::new(), &error))
    };
    next(&mut row)?;
    let heading = Heading::find(&name, names(&name, &row)?)?;
    if !next(&mut row)? {
        return Err(InputError::invalid(format!("{name}: it holds no samples")));
    }
    let number = Lines::default().of(row.position());
    check_length(&name, number, &row, &heading.names)?;
    let clock = heading
        .clock(&row)
        .map_err(|fault| InputError::invalid(format!("{name}, line {number}: {fault}")))?;
    let from = SamplePlace {
        byte: start + row.position().map_or(0, csv::Position::byte),
        number,
        added_s: 0.0,
    };
    Ok((
        SampleFile {
            name,
            file,
            format: SampleFormat::Table(Box::new(heading)),
            clock,
        },
        from,
    ))
}
