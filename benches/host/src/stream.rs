//! Times of streams of points: `host-sim correct` at the end of a pipe, beside the work that limits
//! it.
//!
//! Text is limited by its parser: the reader of `host-sim` and its conversion of numbers, alone,
//! over the same bytes. An array is limited by the pipe: a copy of the same bytes through a pipe,
//! with both ends.

use std::env;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Instant;

use crate::cpu_time::{CpuTime, Of};
use crate::timing::Times;

/// Number of rows that are repeated, so that memory is constant here, too.
pub(crate) const ROWS: usize = 100_000;

/// Buffer size that `host-sim` gives its reader of text.
const BUFFER: usize = 1 << 18;

/// Points in a format: a header, and rows that repeat.
struct Written {
    header: Vec<u8>,
    rows: Vec<u8>,
    repeats: usize,
}

/// Bytes of [`Written`], one after the other.
struct Bytes<'a> {
    written: &'a Written,
    now: &'a [u8],
    left: usize,
}

/// Work that is timed.
#[derive(Clone, Copy)]
enum Work {
    /// Parsing of records and numbers of text, in this thread.
    Parse,
    /// Copying of bytes through a pipe, from one thread to another.
    Copy,
    /// The command, fed through a pipe.
    Correct(&'static str),
}

/// Times all works in turns, for [`ROWS`] rows or a multiple of it: wall time and, if it is known,
/// processor time. A round takes some seconds per 1e7 rows.
///
/// # Errors
/// A message that says what failed.
pub(crate) fn times(rows: usize, rounds: usize) -> Result<Vec<Times>, String> {
    let text = Written::text(rows).map_err(|error| error.to_string())?;
    let array = Written::array(rows).map_err(|error| error.to_string())?;
    let works = [
        ("csv, parser alone", Work::Parse, &text),
        ("csv, host-sim correct", Work::Correct("csv"), &text),
        ("npy, copy through a pipe", Work::Copy, &array),
        ("npy, host-sim correct", Work::Correct("npy"), &array),
    ];
    let named = |name: &str, copy| Times {
        name: name.to_owned(),
        copy,
        rounds: Vec::new(),
    };
    let mut wall = works.map(|(name, _, _)| named(name, ""));
    let mut cpu = works.map(|(name, _, _)| named(&format!("{name}, processor time"), ""));
    for _ in 0..rounds {
        for ((wall, cpu), (name, work, written)) in wall.iter_mut().zip(&mut cpu).zip(works) {
            let before = CpuTime::now(work.process());
            let start = Instant::now();
            work.run(written)
                .map_err(|error| format!("{name}: {error}"))?;
            wall.rounds.push(start.elapsed().as_secs_f64());
            let spent = CpuTime::now(work.process()).zip(before);
            cpu.rounds
                .extend(spent.map(|(now, before)| now.since(before)));
        }
    }
    let measured = wall.into_iter().chain(cpu);
    Ok(measured.filter(|times| !times.rounds.is_empty()).collect())
}

impl Written {
    fn text(rows: usize) -> io::Result<Self> {
        let mut text = Vec::new();
        for (index, [x, y]) in places().enumerate() {
            writeln!(text, "p{index},{x:.4},{y:.4}")?;
        }
        Ok(Self {
            header: b"id,x_mm,y_mm\n".to_vec(),
            rows: text,
            repeats: rows / ROWS,
        })
    }

    fn array(rows: usize) -> io::Result<Self> {
        let shape = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, 2), }}");
        // Version 1.0 of NumPy's format: 10 bytes before the text, which ends at byte 128.
        let mut header = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        writeln!(header, "{shape:117}")?;
        Ok(Self {
            header,
            rows: places().flatten().flat_map(f32::to_le_bytes).collect(),
            repeats: rows / ROWS,
        })
    }

    fn bytes(&self) -> Bytes<'_> {
        Bytes {
            written: self,
            now: &self.header,
            left: self.repeats,
        }
    }
}

/// Returns points all over the sensor, in random order, so that the next one cannot be predicted.
fn places() -> impl Iterator<Item = [f32; 2]> {
    let mut random = fastrand::Rng::with_seed(1);
    (0..ROWS).map(move |_| [random.f32(), random.f32()].map(|share| 80.0 * share - 40.0))
}

impl Read for Bytes<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.now.is_empty() && self.left > 0 {
            self.now = &self.written.rows;
            self.left -= 1;
        }
        self.now.read(buffer)
    }
}

impl Bytes<'_> {
    /// Writes all bytes, in pieces as large as they are stored.
    fn feed(mut self, sink: &mut (impl Write + ?Sized)) -> io::Result<()> {
        sink.write_all(self.now)?;
        while self.left > 0 {
            sink.write_all(&self.written.rows)?;
            self.left -= 1;
        }
        Ok(())
    }
}

impl Work {
    const fn process(self) -> Of {
        match self {
            Self::Parse | Self::Copy => Of::Ourselves,
            Self::Correct(_) => Of::Children,
        }
    }

    fn run(self, written: &Written) -> Result<(), Box<dyn std::error::Error>> {
        match self {
            Self::Parse => parse(written.bytes()),
            Self::Copy => Ok(copy(written)?),
            Self::Correct(format) => correct(written, format),
        }
    }
}

fn parse(bytes: Bytes<'_>) -> Result<(), Box<dyn std::error::Error>> {
    let mut reader = csv::ReaderBuilder::new()
        .buffer_capacity(BUFFER)
        .from_reader(bytes);
    let mut record = csv::ByteRecord::new();
    let mut sum = 0.0;
    while reader.read_byte_record(&mut record)? {
        for field in record.iter().skip(1) {
            sum += fast_float2::parse::<f64, _>(field)?;
        }
    }
    std::hint::black_box(sum);
    Ok(())
}

fn copy(written: &Written) -> io::Result<()> {
    through_a_pipe(|sink| written.bytes().feed(sink))
}

/// Reads what `feed` writes, from one thread to another.
pub(crate) fn through_a_pipe(
    feed: impl FnOnce(&mut dyn Write) -> io::Result<()> + Send,
) -> io::Result<()> {
    let (mut reader, mut writer) = io::pipe()?;
    thread::scope(|scope| {
        let feeder = scope.spawn(move || feed(&mut writer));
        let mut buffer = vec![0; BUFFER];
        while reader.read(&mut buffer)? > 0 {}
        feeder
            .join()
            .unwrap_or_else(|_| Err(io::Error::other("the feeding thread ended")))
    })
}

fn correct(written: &Written, format: &str) -> Result<(), Box<dyn std::error::Error>> {
    let mut command = Command::new(host_sim()?);
    command.args(["correct", "--vh", "0.17", "--exposure", "1/200"]);
    command.args(["--format", format, "-", "--camera"]);
    let mut child = command
        .arg(camera())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()?;
    if let Some(mut stdin) = child.stdin.take() {
        written.bytes().feed(&mut stdin)?;
    }
    let status = child.wait()?;
    if !status.success() {
        return Err(format!("host-sim ends with {status}").into());
    }
    Ok(())
}

/// Returns the camera of the points.
pub(crate) fn camera() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-sim/cameras/rc30-5324.toml")
}

/// Returns the path of the command, which is built beside this program.
pub(crate) fn host_sim() -> io::Result<PathBuf> {
    let name = format!("host-sim{}", env::consts::EXE_SUFFIX);
    let path = env::current_exe()?.with_file_name(name);
    if path.is_file() {
        return Ok(path);
    }
    Err(io::Error::other(format!(
        "{} is missing: cargo build --release -p host-sim",
        path.display()
    )))
}
