//! A camera on a serial port: a pseudo-terminal with a camera, or something else, at its end.

use std::fs::File;
use std::io::{Read, Write};
use std::os::unix::fs::symlink;
use std::process::Stdio;
use std::sync::mpsc;
use std::thread;

use fmc_camera::io::link::PROTOCOL_VERSION;
use fmc_camera::io::link::deck::FlightDeck;

use crate::command_line::fake_camera::FakeCamera;
use crate::command_line::support::{Bench, EXPOSURE};
use crate::command_line::terminal::Terminal;
use crate::command_line::wire_format::frame_of;

/// A pseudo-terminal whose far end is served by a thread.
pub(crate) struct Port {
    pub(crate) name: String,
    /// Keeps the terminal open between two programs, as a real port stays.
    near: File,
}

impl Port {
    fn with(serve: impl FnOnce(File) + Send + 'static) -> Self {
        let Terminal { far, near, name } = Terminal::open();
        thread::spawn(move || serve(far));
        Self { name, near }
    }

    pub(crate) fn with_camera<Deck: FlightDeck + Send + 'static>(
        mut camera: FakeCamera<Deck>,
    ) -> Self {
        Self::with(move |mut far| camera.serve(&mut far))
    }

    pub(crate) fn device(&self) -> String {
        format!("serial:{}", self.name)
    }

    fn correct(&self, bench: &Bench) -> crate::command_line::support::Answer {
        bench.points("correct", &["--device", &self.device()])
    }
}

#[test]
fn camera_on_a_serial_port_answers_as_the_one_in_process() {
    let bench = Bench::new();
    let port = Port::with_camera(FakeCamera::new());
    for command in ["correct", "distort", "frame"] {
        let here = bench.points(command, &[]).ok();
        let there = bench.points(command, &["--device", &port.device()]).ok();
        assert_eq!(here.stdout, there.stdout);
    }
    let answer = bench
        .run(&[
            "verify",
            "--device",
            &port.device(),
            "--camera",
            "camera.toml",
        ])
        .ok();
    let mut lines = answer.stdout.lines();
    let first = lines.next().unwrap();
    for part in [&port.device(), "board fake", "build of the test"] {
        assert!(first.contains(part), "{first}");
    }
    let second = lines.next().unwrap();
    assert!(
        second.contains("52,920 shown by digest") && second.contains("6,720"),
        "{second}"
    );
}

#[test]
fn what_is_no_serial_port_is_named() {
    let bench = Bench::new();
    for (path, why) in [
        ("nowhere", "there is no such port"),
        ("camera.toml", "is not a serial port"),
        (".", "is not a serial port"),
        ("/dev/null", "is not a serial port"),
    ] {
        bench
            .points("correct", &["--device", &format!("serial:{path}")])
            .failed(3, &[&format!("{path}: {why}")]);
    }
    bench
        .points("correct", &["--device", "serial:"])
        .refused(&["serial:PATH"]);
}

#[test]
fn port_in_use_is_refused() {
    let bench = Bench::new();
    let port = Port::with_camera(FakeCamera::new());
    let name = &port.name;
    let first = serialport::new(name, 115_200).open().unwrap();
    port.correct(&bench)
        .failed(3, &[name, "in use by another program"]);
    // A symbolic link leads to the same port.
    symlink(name, bench.path("camera-port")).unwrap();
    bench
        .points("correct", &["--device", "serial:camera-port"])
        .failed(3, &["camera-port", "in use"]);
    drop(first);
    port.correct(&bench).ok();
}

#[test]
fn port_that_closes_half_way_is_named() {
    let bench = Bench::new();
    for answers_given in [1, 2, 3] {
        let mut camera = FakeCamera::new();
        camera.goes_on = Box::new(move |answers| answers < answers_given);
        // The far end closes when the service ends.
        let port = Port::with_camera(camera);
        let device = port.device();
        port.correct(&bench).failed(3, &[&device, "closed"]);
    }
}

#[test]
fn silence_is_no_camera() {
    let bench = Bench::new();
    let (hold, held) = mpsc::channel::<()>();
    let port = Port::with(move |far| {
        let _ = held.recv();
        drop(far);
    });
    port.correct(&bench).failed(
        3,
        &[
            "does not answer as a camera",
            "nothing arrived",
            "Are RX and TX crossed",
        ],
    );
    drop(hold);
}

#[test]
fn echo_is_no_camera() {
    let port = Port::with(|mut far| {
        let mut buffer = [0; 100];
        // Until the test gives up the port.
        while let Ok(count) = far.read(&mut buffer) {
            if far.write_all(&buffer[..count]).is_err() {
                return;
            }
        }
    });
    port.correct(&Bench::new())
        .failed(3, &["does not answer as a camera", "an echo"]);
}

#[test]
fn flood_of_garbage_is_no_camera() {
    let port = Port::with(|mut far| {
        let mut byte = 1_u32;
        let mut garbage = std::iter::repeat_with(|| {
            byte = byte.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            byte.to_be_bytes()[0]
        });
        // A write to a full terminal waits until the other end reads.
        while far
            .write_all(&garbage.by_ref().take(500).collect::<Vec<u8>>())
            .is_ok()
        {}
    });
    port.correct(&Bench::new()).failed(
        3,
        &["does not answer as a camera", "no whole message among them"],
    );
}

#[test]
fn camera_of_another_protocol_is_named_with_both_versions() {
    const OTHER: u8 = PROTOCOL_VERSION + 1;
    let port = Port::with(|mut far| {
        let mut byte = [0];
        while let Ok(count) = far.read(&mut byte) {
            if count == 1 && byte == [0] {
                let _ = far.write_all(&frame_of(&[OTHER, 1, 2, 3]));
            }
        }
    });
    let versions =
        format!("version {OTHER} of the protocol, this program version {PROTOCOL_VERSION}");
    port.correct(&Bench::new())
        .failed(3, &[&versions, "cargo xtask firmware"]);
}

#[test]
fn host_killed_in_the_middle_of_a_batch_leaves_a_camera_that_the_next_can_use() {
    let rows: String = (0..20_000).map(|_| "p,1,2\n").collect();
    let bench = Bench::with(
        crate::command_line::support::CAMERA,
        format!("id,x_mm,y_mm\n{rows}").as_bytes(),
    );
    // After ten answers the camera waits until the host is dead.
    let (ten_given, ten_are_given) = mpsc::channel();
    let (killed, host_is_killed) = mpsc::channel::<()>();
    let mut camera = FakeCamera::new();
    camera.goes_on = Box::new(move |answers| {
        if answers == 10 && ten_given.send(()).is_ok() {
            let _ = host_is_killed.recv();
        }
        true
    });
    let port = Port::with_camera(camera);
    let mut host = bench
        .command(
            &[
                &["correct"],
                &EXPOSURE[..],
                &["--device", &port.device(), "points.csv"],
            ]
            .concat(),
        )
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    ten_are_given.recv().unwrap();
    host.kill().unwrap();
    assert!(!host.wait().unwrap().success());
    // The lock on an open port is released when all have closed it, but the near end here stays
    // open.
    rustix::termios::ioctl_tiocnxcl(&port.near).unwrap();
    drop((ten_are_given, killed));
    std::fs::write(
        bench.path("points.csv"),
        crate::command_line::support::POINTS,
    )
    .unwrap();
    let there = port.correct(&bench).ok();
    assert_eq!(there.stdout, bench.points("correct", &[]).ok().stdout);
}
