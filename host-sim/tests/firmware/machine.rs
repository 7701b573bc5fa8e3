//! The image in a QEMU of its own, with the far ends of its link and its log.

use std::{
    env, fs,
    io::{ErrorKind, Read as _, Write as _},
    net::{TcpListener, TcpStream},
    path::Path,
    process::{Child, Command, ExitStatus},
    thread,
    time::{Duration, Instant},
};

use defmt_decoder::{DecodeError, Table};

/// The image's machines: Cortex-M4F and Cortex-M7.
pub(crate) const MACHINES: [&str; 2] = ["mps2-an386", "mps2-an500"];

/// How long anything may take on a machine that is busy with other things.
const PATIENCE: Duration = Duration::from_mins(1);
/// The kernel ends QEMU by it when the test ends, however that happens.
const SETPRIV: &str = "/usr/bin/setpriv";

/// A running machine; it ends with this.
pub(crate) struct Machine {
    qemu: Child,
    /// Requests and answers.
    pub(crate) link: TcpStream,
    log: TcpStream,
    /// Of the log, undecoded.
    logged: Vec<u8>,
    table: Table,
}

impl Machine {
    /// Starts the image as it flies.
    pub(crate) fn start(machine: &str) -> Self {
        Self::with_image("FMC_FIRMWARE", machine)
    }

    /// Starts the image that has accidents on request.
    pub(crate) fn start_with_drills(machine: &str) -> Self {
        Self::with_image("FMC_FIRMWARE_WITH_DRILLS", machine)
    }

    fn with_image(variable: &str, machine: &str) -> Self {
        let image = env::var(variable).expect("image named by the environment");
        let table = Table::parse(&fs::read(&image).expect("image"))
            .expect("image with log format")
            .expect("image that logs");
        let [link, log] = [(), ()].map(|()| TcpListener::bind("127.0.0.1:0").expect("port"));
        let mut qemu = if Path::new(SETPRIV).is_file() {
            let mut setpriv = Command::new(SETPRIV);
            setpriv.args(["--pdeathsig", "KILL", "qemu-system-arm"]);
            setpriv
        } else {
            Command::new("qemu-system-arm")
        };
        qemu.args(["-M", machine, "-kernel", &image])
            .args(["-display", "none", "-monitor", "none"])
            .args(["-icount", "shift=0"])
            .args(["-semihosting-config", "enable=on,target=native"]);
        for (name, listener) in [("link", &link), ("log", &log)] {
            let port = listener.local_addr().expect("port").port();
            qemu.arg("-chardev")
                .arg(format!(
                    "socket,id={name},host=127.0.0.1,port={port},nodelay=on"
                ))
                .args(["-serial", &format!("chardev:{name}")]);
        }
        let mut qemu = qemu.spawn().expect("QEMU");
        let [link, log] = [link, log].map(|listener| accept(&listener, &mut qemu));
        link.set_nodelay(true).expect("socket");
        Self {
            qemu,
            link,
            log,
            logged: vec![],
            table,
        }
    }

    /// Sends a line, which ends with a zero, and returns the line that comes back.
    pub(crate) fn ask(&mut self, line: &[u8]) -> Vec<u8> {
        self.link.write_all(line).expect("link");
        let mut answer = vec![];
        while answer.last() != Some(&0) {
            let mut byte = [0];
            self.link.read_exact(&mut byte).expect("answer");
            answer.extend(byte);
        }
        answer
    }

    /// Provokes the accident that stands behind the letter.
    pub(crate) fn provoke(&mut self, accident: u8) {
        self.log.write_all(&[accident]).expect("log");
    }

    /// Waits for a line in the log that contains the text and comes after those asked for before.
    pub(crate) fn wait_for_log(&mut self, text: &str) -> String {
        let mut decoder = self.table.new_stream_decoder();
        let mut bytes = std::mem::take(&mut self.logged);
        loop {
            // Frame by frame, so that what follows the line is kept for the next question.
            while let Some(end) = bytes.iter().position(|byte| *byte == 0) {
                let rest = bytes.split_off(end + 1);
                decoder.received(&bytes);
                bytes = rest;
                match decoder.decode() {
                    Ok(frame) => {
                        let line = frame.display_message().to_string();
                        if line.contains(text) {
                            self.logged = bytes;
                            return line;
                        }
                    }
                    // Frames may begin with a zero of their own, and a reset cuts one short.
                    Err(DecodeError::UnexpectedEof | DecodeError::Malformed) => {}
                }
            }
            let mut chunk = [0; 1024];
            let count = self.log.read(&mut chunk).expect("log");
            assert!(count > 0, "the log ended before {text:?}");
            bytes.extend(chunk.iter().take(count));
        }
    }

    /// Stops QEMU for a while, as a PC does that sleeps.
    pub(crate) fn stop_for(&mut self, time: Duration) {
        for signal in ["-STOP", "-CONT"] {
            let qemu = self.qemu.id().to_string();
            let kill = Command::new("kill").args([signal, &qemu]).status();
            assert!(kill.expect("kill").success());
            if signal == "-STOP" {
                thread::sleep(time);
            }
        }
    }

    /// Waits for QEMU to end by itself.
    pub(crate) fn wait_for_end(&mut self) -> ExitStatus {
        let start = Instant::now();
        loop {
            if let Some(status) = self.qemu.try_wait().expect("QEMU") {
                return status;
            }
            assert!(start.elapsed() < PATIENCE, "QEMU runs on");
            thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
    }
}

/// QEMU's connection, or a panic where it ends without one.
fn accept(listener: &TcpListener, qemu: &mut Child) -> TcpStream {
    listener.set_nonblocking(true).expect("socket");
    let start = Instant::now();
    loop {
        match listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(false).expect("socket");
                stream.set_read_timeout(Some(PATIENCE)).expect("socket");
                return stream;
            }
            Err(error) => assert_eq!(error.kind(), ErrorKind::WouldBlock, "{error}"),
        }
        let status = qemu.try_wait().expect("QEMU");
        assert!(status.is_none(), "QEMU ended before it connected");
        assert!(start.elapsed() < PATIENCE, "QEMU does not connect");
        thread::sleep(Duration::from_millis(5));
    }
}
