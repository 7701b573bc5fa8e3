//! `serve`: a camera on a TCP port, for one program after another.

use std::io::{BufRead as _, BufReader, Read as _};
use std::net::{TcpListener, TcpStream};
use std::process::{Child, ChildStderr, Stdio};
use std::time::Duration;

use rustix::process::{Pid, kill_process};

use crate::command_line::signals::ctrl_c;
use crate::command_line::support::Bench;

/// A program that serves the camera's code in itself.
struct Server {
    program: Child,
    said: BufReader<ChildStderr>,
    /// Device of the camera, as others name it.
    device: String,
}

impl Server {
    fn start(bench: &Bench, arguments: &[&str]) -> Self {
        let mut command = bench.command(&[&["serve"], arguments].concat());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut program = command.spawn().unwrap();
        let mut device = String::new();
        let mut stdout = BufReader::new(program.stdout.take().unwrap());
        stdout.read_line(&mut device).unwrap();
        let said = BufReader::new(program.stderr.take().unwrap());
        let device = device.trim_end().to_owned();
        Self {
            program,
            said,
            device,
        }
    }

    fn address(&self) -> &str {
        self.device.strip_prefix("tcp:").unwrap()
    }

    /// Waits for the next line on the error stream.
    fn line(&mut self) -> String {
        let mut line = String::new();
        self.said.read_line(&mut line).unwrap();
        line
    }

    /// Ends it with Ctrl-C; returns its exit code.
    fn end(mut self) -> Option<i32> {
        kill_process(Pid::from_child(&self.program), ctrl_c()).unwrap();
        self.program.wait().unwrap().code()
    }
}

#[test]
fn camera_is_served_to_one_program_after_another_and_stays_as_it_is() {
    let bench = Bench::new();
    let mut server = Server::start(&bench, &[]);
    let served = ["--device", &server.device];
    for command in ["frame", "correct"] {
        let here = bench.points(command, &[]).ok();
        let there = bench.points(command, &served).ok();
        assert_eq!(here.stdout, there.stdout);
    }
    // A flight, and its records by another program.
    let device = server.device.clone();
    let prepare = [
        "camera",
        "--device",
        &device,
        "prepare",
        "--camera",
        "camera.toml",
    ];
    bench.run(&prepare).ok();
    let status = bench.run(&["camera", "--device", &device, "status"]).ok();
    assert!(status.stdout.contains("standby"), "{}", status.stdout);
    for said in ["connected", "disconnected"].repeat(4) {
        assert!(server.line().trim_end().ends_with(said));
    }

    // While one is connected, another is closed, and the first goes on.
    let first = TcpStream::connect(server.address()).unwrap();
    assert!(server.line().contains("connected"));
    let mut second = TcpStream::connect(server.address()).unwrap();
    second
        .set_read_timeout(Some(Duration::from_secs(10)))
        .unwrap();
    assert_eq!(second.read(&mut [0; 8]).unwrap(), 0);
    assert!(server.line().contains("another program is connected"));
    drop(first);
    assert_eq!(server.line(), "disconnected\n");
    bench.points("correct", &["--device", &device]).ok();
    assert_eq!(server.end(), Some(0));
}

#[test]
fn port_that_cannot_be_had_is_named() {
    let bench = Bench::new();
    let taken = TcpListener::bind(("127.0.0.1", 0)).unwrap();
    let address = taken.local_addr().unwrap().to_string();
    bench
        .run(&["serve", "--listen", &address])
        .failed(3, &[&address, "another program has this port", "port 0"]);
    bench
        .run(&["serve", "--listen", "203.0.113.7:4000"])
        .failed(3, &["203.0.113.7:4000", "does not have this address"]);
    for wrong in ["4000", "127.0.0.1", "localhost:4000", "127.0.0.1:65536"] {
        bench
            .run(&["serve", "--listen", wrong])
            .refused(&[wrong, "ADDRESS:PORT"]);
    }
    bench
        .run(&["serve", "--device", "serial:/dev/no-such-port"])
        .failed(3, &["/dev/no-such-port"]);
    bench
        .run(&["serve", "--firmware", "x.elf"])
        .refused(&["--firmware", "--device qemu"]);
}
