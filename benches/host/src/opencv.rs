//! `OpenCV`, in a Python beside this program: it is asked for a call when it is its turn.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use crate::timing::Contender;

/// Functions that are timed: to ideal points, and twice to measured ones.
const FUNCTIONS: [&str; 3] = [
    "undistortPoints",
    "projectPoints",
    "initUndistortRectifyMap",
];

/// A function in a Python of its own, which is ended with this value.
struct Function {
    python: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

/// Returns the functions of `OpenCV` for so many points; none where `python3` has no `OpenCV`.
pub(crate) fn all(points: usize) -> Vec<Contender<'static>> {
    let functions = FUNCTIONS.into_iter().map_while(|name| {
        let (mut function, version) = Function::start(name, points)?;
        let name = format!("OpenCV {version} {name}");
        Some(Contender::told(name, move || function.call()))
    });
    functions.collect()
}

impl Function {
    /// Starts a function, and returns it with the version of `OpenCV`.
    fn start(name: &str, points: usize) -> Option<(Self, String)> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("opencv.py");
        let mut python = Command::new("python3")
            .arg(script)
            .args([name, &points.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .ok()?;
        let (questions, answers) = python.stdin.take().zip(python.stdout.take())?;
        let mut function = Self {
            python,
            questions,
            answers: BufReader::new(answers),
        };
        let version = function.line()?;
        Some((function, version))
    }

    /// Returns the seconds of a call; not a number if Python has ended.
    fn call(&mut self) -> f64 {
        let asked = writeln!(self.questions);
        let answer = asked.ok().and_then(|()| self.line());
        answer
            .and_then(|text| text.parse().ok())
            .unwrap_or(f64::NAN)
    }

    /// Returns the next line; `None` at the end.
    fn line(&mut self) -> Option<String> {
        let mut line = String::new();
        self.answers.read_line(&mut line).ok()?;
        let line = line.trim_end();
        (!line.is_empty()).then(|| line.to_owned())
    }
}

impl Drop for Function {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.python.kill();
        let _ = self.python.wait();
    }
}
