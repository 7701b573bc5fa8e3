//! Processor time per output pixel of the kernels of resampling, one thread, RGB of 16 bits, with
//! the places of the lens of an `iXM-RS150F`, beside a copy of the same bytes and `remap` of
//! `OpenCV`.
//!
//! `cargo bench -p fmc-rectification --bench rows [-- ROUNDS [WIDTH HEIGHT]] [NAME…]`: every
//! contender, or every one whose name has one of these words in it, is timed once per round, so
//! that all meet the same state of the machine. `OpenCV` takes part if `python3` has it
//! (`opencv-python-headless`), or every program that `PYTHON` names, one behind the other with
//! colons between them: several versions are timed in turns. Its maps are ready before it is
//! timed. Prints CSV: contender, least and median ns per pixel, and for every kernel how many times
//! as long the same kernel of each `OpenCV` takes, by the least and by the median.

#![expect(
    clippy::unwrap_used,
    clippy::indexing_slicing,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::too_many_lines,
    reason = "a measurement, which ends where anything is amiss"
)]

#[cfg(unix)]
fn main() {
    unix::main();
}

#[cfg(not(unix))]
fn main() {
    eprintln!("processor time is not measured on this system");
}

#[cfg(unix)]
mod unix {
    use std::io::{BufRead, BufReader, Write};
    use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

    use fmc_camera::flight::exposure::Exposure;
    use fmc_camera_file::CameraFile;
    use fmc_camera_file::published::CAMERA_FILES;
    use fmc_camera_kernel::host::Level;
    use fmc_rectification::{Centre, Rectification, Request, Resampling, SourceBand, Window};
    use nix::time::{ClockId, clock_gettime};

    const BANDS: usize = 3;
    const PYTHON: &str = include_str!("remap.py");
    const OF_OPENCV: [&str; 4] = ["nearest", "linear", "cubic", "lanczos4"];
    /// Kernels, and those of `OpenCV` that they are compared with.
    const SAME: [(&str, &str); 4] = [
        ("nearest", "nearest"),
        ("bilinear", "linear"),
        ("bicubic", "cubic"),
        ("lanczos3", "lanczos4"),
    ];

    /// Processor time of this process, s.
    fn now_s() -> f64 {
        let time = clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID).unwrap();
        time.tv_sec() as f64 + time.tv_nsec() as f64 * 1e-9
    }

    /// A Python process that resamples an image of the same size when it is asked.
    struct OpenCv {
        child: Child,
        to: ChildStdin,
        from: BufReader<ChildStdout>,
        version: String,
    }

    impl OpenCv {
        /// Starts all that `PYTHON` names.
        fn all(made: &Rectification, size_px: [u32; 2]) -> Vec<Self> {
            let names = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
            let started = names.split(':').map(|python| {
                let started = Self::start(python, made, size_px);
                if started.is_none() {
                    eprintln!("{python}: no OpenCV takes part");
                }
                started
            });
            started.flatten().collect()
        }

        fn start(python: &str, made: &Rectification, [width, height]: [u32; 2]) -> Option<Self> {
            let mut child = Command::new(python)
                .args(["-c", PYTHON, &width.to_string(), &height.to_string()])
                .stdin(Stdio::piped())
                .stdout(Stdio::piped())
                .spawn()
                .ok()?;
            let mut to = child.stdin.take()?;
            let mut from = BufReader::new(child.stdout.take()?);
            let mut version = String::new();
            from.read_line(&mut version).ok()?;
            if version.trim().is_empty() {
                return None;
            }
            for axis in 0..2 {
                for row in 0..height {
                    let places = made.mesh().row_px(row);
                    let mut bytes = Vec::with_capacity(4 * width as usize);
                    for place in places {
                        let place = place.map_or(-1.0, |place| place[axis]) as f32;
                        bytes.extend(place.to_le_bytes());
                    }
                    to.write_all(&bytes).ok()?;
                }
            }
            let version = version.trim().to_owned();
            Some(Self {
                child,
                to,
                from,
                version,
            })
        }

        fn seconds(&mut self, kernel: &str) -> f64 {
            writeln!(self.to, "{kernel}").unwrap();
            let mut line = String::new();
            self.from.read_line(&mut line).unwrap();
            line.trim().parse().unwrap()
        }
    }

    impl Drop for OpenCv {
        fn drop(&mut self) {
            let _ = self.to.write_all(b"end\n");
            let _ = self.child.wait();
        }
    }

    pub(super) fn main() {
        let numbers: Vec<u32> = std::env::args()
            .filter_map(|word| word.parse().ok())
            .collect();
        let words: Vec<String> = std::env::args().skip(1).collect();
        let words: Vec<&String> = words
            .iter()
            .filter(|word| word.parse::<u32>().is_err() && !word.starts_with("--"))
            .collect();
        let is_asked =
            |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word.as_str()));
        let rounds = numbers.first().copied().unwrap_or(5);
        let (name, text) = CAMERA_FILES[0];
        let mut text = text.to_owned();
        if let [_, width, height] = numbers[..] {
            text = text.replace("14204", &width.to_string());
            text = text.replace("10652", &height.to_string());
        }
        let (_, camera) = CameraFile::parse(name, &text).unwrap();
        let frame = camera.frame(&Exposure::new(0.05, 0.002)).unwrap();
        let sensor = *frame.correction.sensor();
        let size_px = [sensor.width_px(), sensor.height_px()];
        let [width, height] = size_px.map(|side| side as usize);
        let made = |resampling, level| {
            let request = Request {
                window: Window::Same,
                centre: Centre::PrincipalPoint,
                resampling,
            };
            let point = frame.interior.principal_point;
            Rectification::new(&frame.correction, point, &request)
                .unwrap()
                .at(level)
        };
        let start = now_s();
        let first = made(Resampling::Nearest, Level::BASELINE);
        let pixels = width as f64 * height as f64;
        let mesh_s = now_s() - start;
        println!(
            "mesh,{:.3},{}",
            1e9 * mesh_s / pixels,
            first.mesh_spacing_px()
        );

        let row = width * BANDS;
        let mut state = 1_u32;
        let source: Vec<u16> = (0..row * height)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 16) as u16
            })
            .collect();
        let rows: Vec<&[u16]> = source.chunks(row).collect();
        let mut out = vec![1_u16; row * height];
        let mut mask = vec![1_u8; width];
        let mut opencv = if is_asked("OpenCV") {
            OpenCv::all(&first, size_px)
        } else {
            Vec::new()
        };

        let mut contenders: Vec<(String, Vec<f64>)> = vec![("memcpy".into(), Vec::new())];
        let mut all = Vec::new();
        for level in Level::all() {
            for resampling in Resampling::ALL {
                let name = format!("{resampling} {level}");
                if is_asked(&name) {
                    contenders.push((name, Vec::new()));
                    all.push(made(resampling, level));
                }
            }
        }
        for opencv in &opencv {
            for kernel in OF_OPENCV {
                contenders.push((format!("OpenCV {} {kernel}", opencv.version), Vec::new()));
            }
        }
        for _ in 0..rounds {
            let mut times = contenders.iter_mut().map(|(_, times)| times);
            let start = now_s();
            out.copy_from_slice(&source);
            times.next().unwrap().push(now_s() - start);
            for made in &all {
                let start = now_s();
                for (row_px, out) in (0..).zip(out.chunks_mut(row)) {
                    let needed = made.source_rows(row_px..row_px + 1);
                    let band = &rows[needed.start as usize..needed.end as usize];
                    let band = SourceBand::new(size_px, BANDS, needed.start, band).unwrap();
                    made.row(row_px, &band, out, &mut mask).unwrap();
                }
                times.next().unwrap().push(now_s() - start);
            }
            for opencv in &mut opencv {
                for kernel in OF_OPENCV {
                    times.next().unwrap().push(opencv.seconds(kernel));
                }
            }
        }
        println!("contender,least_ns_per_px,median_ns_per_px");
        let mut found = Vec::new();
        for (name, mut times) in contenders {
            times.sort_by(f64::total_cmp);
            let ns = [times[0], times[times.len() / 2]].map(|seconds| 1e9 * seconds / pixels);
            println!("{name},{:.3},{:.3}", ns[0], ns[1]);
            found.push((name, ns));
        }
        println!("contender,beside,least_ratio,median_ratio");
        for (name, ns) in &found {
            let kernel = name.split(' ').next().unwrap_or_default();
            let Some((_, of_opencv)) = SAME.iter().find(|(ours, _)| *ours == kernel) else {
                continue;
            };
            let is_same = |other: &str| other.starts_with("OpenCV ") && other.ends_with(of_opencv);
            for (other, its) in found.iter().filter(|(other, _)| is_same(other)) {
                println!("{name},{other},{:.2},{:.2}", its[0] / ns[0], its[1] / ns[1]);
            }
        }
    }
}
