//! Times of the points of a flight: `host-sim correct --frames` at the end of a pipe, beside a copy
//! of the same bytes.

use std::error::Error;
use std::fs;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::cpu_time::{CpuTime, Of};
use crate::stream::{camera, host_sim, through_a_pipe};
use crate::timing::Times;

/// The points of a flight: so many in each of so many frames, one frame after the other.
#[derive(Clone, Copy)]
pub(crate) struct Flight {
    pub(crate) frames: usize,
    pub(crate) points: usize,
}

impl Flight {
    /// Returns the number of points.
    pub(crate) const fn rows(self) -> usize {
        self.frames * self.points
    }

    /// Times the copy and the command in turns: wall time and, if it is known, processor time.
    ///
    /// # Errors
    /// A message that says what failed.
    pub(crate) fn times(self, rounds: usize) -> Result<Vec<Times>, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let table = folder.path().join("frames.csv");
        fs::write(&table, self.table()).map_err(|error| error.to_string())?;
        let Self { frames, points } = self;
        let named = |what: &str| Times {
            name: format!("npy of {frames} frames of {points} points, {what}"),
            copy: "",
            rounds: Vec::new(),
        };
        let mut times = ["copy through a pipe", "host-sim correct"]
            .map(|what| [named(what), named(&format!("{what}, processor time"))]);
        for _ in 0..rounds {
            for (is_command, [wall, cpu]) in [false, true].into_iter().zip(&mut times) {
                let of = if is_command {
                    Of::Children
                } else {
                    Of::Ourselves
                };
                let before = CpuTime::now(of);
                let start = Instant::now();
                let done = if is_command {
                    self.correct(&table)
                } else {
                    through_a_pipe(move |sink| self.feed(sink)).map_err(Into::into)
                };
                done.map_err(|error: Box<dyn Error>| error.to_string())?;
                wall.rounds.push(start.elapsed().as_secs_f64());
                let spent = CpuTime::now(of).zip(before);
                cpu.rounds
                    .extend(spent.map(|(now, before)| now.since(before)));
            }
        }
        let [[copied, copied_cpu], [wall, cpu]] = times;
        let all = [copied, wall, copied_cpu, cpu];
        Ok(all
            .into_iter()
            .filter(|times| !times.rounds.is_empty())
            .collect())
    }

    /// Returns the table of exposures: each has its own V/H and exposure time.
    fn table(self) -> String {
        let mut text = String::from("sequence,vh,exposure\n");
        for sequence in 1..=self.frames {
            let [vh, exposure] = [60 + sequence % 97, 20 + sequence % 31];
            let row = format!("{sequence},0.{vh:03},0.00{exposure}\n");
            text.push_str(&row);
        }
        text
    }

    /// Writes the points as an array of NumPy: sequence, x and y.
    fn feed(self, sink: &mut dyn Write) -> io::Result<()> {
        let rows = self.rows();
        let shape = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, 3), }}");
        // Version 1.0 of NumPy's format: 10 bytes before the text, which ends at byte 128.
        sink.write_all(b"\x93NUMPY\x01\x00\x76\x00")?;
        writeln!(sink, "{shape:117}")?;
        let mut random = fastrand::Rng::with_seed(1);
        let mut sink = BufWriter::with_capacity(1 << 18, sink);
        for frame in 1..=self.frames {
            let sequence = f64::from(u32::try_from(frame).unwrap_or(u32::MAX));
            for _ in 0..self.points {
                let [x, y] = [random.f64(), random.f64()].map(|share| 80.0 * share - 40.0);
                for number in [sequence, x, y] {
                    sink.write_all(&number.to_le_bytes())?;
                }
            }
        }
        sink.flush()
    }

    fn correct(self, table: &Path) -> Result<(), Box<dyn Error>> {
        let mut command = Command::new(host_sim()?);
        command.args([
            "correct",
            "--format",
            "npy",
            "-",
            "--answer",
            "ideal-shifted",
        ]);
        command.arg("--camera").arg(camera());
        command.arg("--frames").arg(table);
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (stdin, stdout) = (child.stdin.take(), child.stdout.take());
        let answered = std::thread::spawn(move || {
            let mut buffer = vec![0; 1 << 18];
            let mut bytes = 0;
            if let Some(mut stdout) = stdout {
                while let read @ 1.. = stdout.read(&mut buffer)? {
                    bytes += read;
                }
            }
            Ok::<usize, io::Error>(bytes)
        });
        if let Some(mut stdin) = stdin {
            self.feed(&mut stdin)?;
        }
        let status = child.wait()?;
        let bytes = answered
            .join()
            .unwrap_or_else(|_| Err(io::Error::other("the reading thread ended")))?;
        let expected = 128 + 32 * self.rows();
        if !status.success() || bytes != expected {
            return Err(
                format!("host-sim ends with {status} after {bytes} of {expected} bytes").into(),
            );
        }
        Ok(())
    }
}
