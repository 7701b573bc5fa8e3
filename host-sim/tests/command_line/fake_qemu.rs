//! A shell script in QEMU's place, with a camera of the test behind its first UART.

use std::fs;
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Pid, test_kill_process};

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::support::{Answer as Output, Bench};

/// Longest wait, even on a slow PC.
pub(crate) const PATIENCE: Duration = Duration::from_mins(1);

/// Script that writes its arguments and its process number, and ends with status 7 when it is told
/// to.
pub(crate) const SCRIPT: &str = r#"#!/bin/sh
cd "$(dirname "$0")"
echo "$$ $*" > started.new
mv started.new started
while [ ! -e die ]; do sleep 0.02; done
echo "fake: triple fault" >&2
exit 7
"#;

/// A folder with `qemu-system-arm` in it, for the search path.
pub(crate) struct FakeQemu {
    pub(crate) bench: Bench,
}

impl FakeQemu {
    pub(crate) fn new(script: &str) -> Self {
        let qemu = Self {
            bench: Bench::new(),
        };
        fs::create_dir(qemu.bench.path("bin")).unwrap();
        let program = qemu.path("qemu-system-arm");
        fs::write(&program, script).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        // The program looks only at the header of the ELF file for ARM.
        let mut image = b"\x7fELF\x01\x01".to_vec();
        image.resize(52, 0);
        image[18] = 40;
        fs::write(qemu.bench.path("firmware.elf"), image).unwrap();
        qemu
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.bench.path("bin").join(name)
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = self.bench.command(arguments);
        let system = std::env::var("PATH").unwrap();
        command
            .env("PATH", format!("{}:{system}", self.path("").display()))
            .env("FMC_FIRMWARE", "firmware.elf");
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        Output::new(&self.command(arguments).output().unwrap())
    }

    /// Serves the link of the next start, then tells the script to end.
    pub(crate) fn serve(&self, mut camera: FakeCamera) {
        self.serve_with(move |mut link| camera.serve(&mut link));
    }

    pub(crate) fn serve_with(&self, serve: impl FnOnce(TcpStream) + Send + 'static) {
        let (started, die) = (self.path("started"), self.path("die"));
        thread::spawn(move || {
            let arguments = wait_for(&started);
            let uarts = ["link", "log", "receiver", "autopilot"];
            let [link, _log, _receiver, _autopilot] = uarts.map(|name| connect(&arguments, name));
            serve(link.try_clone().unwrap());
            fs::write(die, "").unwrap();
            // The link stays open until the process has ended, as a real one does.
            thread::sleep(Duration::from_millis(200));
        });
    }
}

/// Waits for the script to start; returns its process number and arguments.
pub(crate) fn wait_for(started: &Path) -> String {
    let start = Instant::now();
    loop {
        if let Ok(arguments) = fs::read_to_string(started) {
            return arguments;
        }
        assert!(start.elapsed() < PATIENCE, "QEMU was not started");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Connects to a UART, as the script.
fn connect(arguments: &str, name: &str) -> TcpStream {
    let port = arguments
        .split_once(&format!("id={name},host=127.0.0.1,port="))
        .and_then(|(_, rest)| rest.split_once(','))
        .unwrap()
        .0;
    TcpStream::connect(("127.0.0.1", port.parse().unwrap())).unwrap()
}

/// Returns true if the script's process ends in time.
pub(crate) fn ends(started: &str) -> bool {
    let process = started.split(' ').next().unwrap();
    let start = Instant::now();
    while runs(process) {
        if start.elapsed() > PATIENCE {
            return false;
        }
        thread::sleep(Duration::from_millis(10));
    }
    true
}

/// Returns true if a process runs; a zombie does not.
fn runs(process: &str) -> bool {
    let Ok(stat) = fs::read_to_string(format!("/proc/{process}/stat")) else {
        // The process has ended, or the system has no /proc.
        let process = process.parse().ok().and_then(Pid::from_raw);
        return test_kill_process(process.unwrap()).is_ok();
    };
    let (_, state) = stat.rsplit_once(')').unwrap();
    !state.trim_start().starts_with('Z')
}
