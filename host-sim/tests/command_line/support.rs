//! A folder with a camera file and points, and commands run on them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use assert_cmd::cargo::cargo_bin;
use tempfile::TempDir;

/// Arguments that name the camera file of a [`Bench`], and an exposure within its limits.
pub(crate) const EXPOSURE: [&str; 6] = [
    "--camera",
    "camera.toml",
    "--vh",
    "0.1",
    "--exposure",
    "1/200",
];

/// A camera with every table of the camera file.
pub(crate) const CAMERA: &str = r#"name = "Test camera"
principal_distance_mm = 100.0
exit_pupil_mm = 110.0
principal_point_mm = [0.02, -0.01]
[sensor]
width_px = 9216
height_px = 9216
pixel_um = 8.75
[distortion]
sign = "distortion"
k0 = 0.0
k1 = -1.0e-6
k2 = 2.0e-10
k3 = 0.0
p1 = 1.0e-6
p2 = -2.0e-6
b1 = 1.0e-5
b2 = 2.0e-5
[fmc]
axis = "+y"
mechanism = "stage"
strategy = "centred"
acceleration_mm_s2 = 1000.0
settling_ms = 5.0
stroke_mm = 4.0
flatness_um = [0.0, 1.0]
[shutter]
profile = "trapezoid"
opening_fraction = 0.2
closing_fraction = 0.1
[limits]
vh_per_s = [0.05, 0.17]
exposure_s = [0.001, 0.02]
[fitted]
km0 = 1.0e-4
km1 = -1.0e-6
km2 = 2.0e-10
kd1 = 1.0e-6
pm1 = 5.0e-7
"#;

pub(crate) const POINTS: &str = "id,x_mm,y_mm\na,10.0,-20.0\nb,-40.32,40.32\nc,0,0\n";

/// A temporary folder with `camera.toml` and `points.csv`.
pub(crate) struct Bench {
    folder: TempDir,
}

impl Bench {
    pub(crate) fn new() -> Self {
        Self::with(CAMERA, POINTS.as_bytes())
    }

    pub(crate) fn with(camera: &str, points: &[u8]) -> Self {
        let bench = Self {
            folder: TempDir::new().unwrap(),
        };
        fs::write(bench.path("camera.toml"), camera).unwrap();
        fs::write(bench.path("points.csv"), points).unwrap();
        bench
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Runs host-sim in the folder.
    pub(crate) fn run(&self, arguments: &[&str]) -> Answer {
        Answer::new(&self.command(arguments).output().unwrap())
    }

    /// Returns host-sim in the folder, without the image that the caller's environment names.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(cargo_bin!("host-sim"));
        command
            .current_dir(&self.folder)
            .env_remove("FMC_FIRMWARE")
            .args(arguments);
        command
    }

    /// Runs `command` on the camera and the points, with more arguments.
    pub(crate) fn points(&self, command: &str, more: &[&str]) -> Answer {
        let mut arguments = vec![command, "--camera", "camera.toml"];
        if !more.contains(&"--vh") {
            arguments.extend(["--vh", "0.1"]);
        }
        if !more.contains(&"--exposure") {
            arguments.extend(["--exposure", "1/200"]);
        }
        arguments.extend(more);
        if command != "frame" {
            arguments.push("points.csv");
        }
        self.run(&arguments)
    }

    /// Returns the names of the files in the folder.
    pub(crate) fn files(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.folder())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

/// Exit code and output of a command.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Answer {
    pub(crate) fn new(output: &Output) -> Self {
        Self {
            code: output.status.code().unwrap(),
            stdout: String::from_utf8(output.stdout.clone()).unwrap(),
            stderr: String::from_utf8(output.stderr.clone()).unwrap(),
        }
    }

    /// Checks that the command succeeded.
    pub(crate) fn ok(self) -> Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }

    /// Checks that the command refused its input, wrote nothing, and named every one of `words`.
    pub(crate) fn refused(&self, words: &[&str]) {
        self.failed(2, words);
    }

    /// Checks that the command ended with `code` and an error that names every one of `words`.
    pub(crate) fn failed(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, code, "{}{}", self.stdout, self.stderr);
        assert_eq!(self.stdout, "", "nothing is half-written");
        assert!(!self.stderr.contains("panicked"), "{}", self.stderr);
        for word in words {
            assert!(
                self.stderr.contains(word),
                "{word:?} is not in:\n{}",
                self.stderr
            );
        }
    }

    /// Returns the tables of the answer, line by line: headings, a double rule, rows.
    pub(crate) fn tables(&self) -> Vec<Vec<&str>> {
        let mut tables = Vec::new();
        let mut lines = self.stdout.lines();
        while let Some(rule) = lines.find(|line| line.starts_with('─')) {
            let inside = lines.by_ref().take_while(|line| *line != rule);
            tables.push(inside.collect());
        }
        tables
    }

    /// Returns the rows of the answer: id and the four numbers.
    pub(crate) fn rows(&self) -> Vec<(String, [f64; 4])> {
        let mut reader = csv::Reader::from_reader(self.stdout.as_bytes());
        reader
            .records()
            .map(|row| {
                let row = row.unwrap();
                let number = |index: usize| row[index].parse::<f64>().unwrap();
                (
                    row[0].to_owned(),
                    [number(1), number(2), number(3), number(4)],
                )
            })
            .collect()
    }
}
