//! The process of QEMU: its start, its output and its end.

use std::env;
use std::ffi::OsString;
use std::io::{self, BufRead as _, BufReader, ErrorKind};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use wait_timeout::ChildExt as _;

use super::image;
use super::log::LastLines;
use super::name::Machine;
use super::shared_memory::{MEMORY_BYTES, SharedMemory};

/// Name of the program.
pub const PROGRAM: &str = "qemu-system-arm";

/// Longest time until QEMU has started and connected; it takes a second on an idle machine.
const UP_WITHIN: Duration = Duration::from_secs(20);

/// Longest time until QEMU has ended after the firmware has switched it off.
const DOWN_WITHIN: Duration = Duration::from_secs(2);

/// Program that ends a process together with the one that started it, even if that is killed
/// (util-linux).
const SETPRIV: &str = "/usr/bin/setpriv";

/// A running QEMU, which ends when this value is dropped.
#[derive(Debug)]
pub struct Process {
    child: Child,
    stderr: LastLines,
    stderr_thread: Option<JoinHandle<()>>,
}

/// QEMU and its wires: the link, the log, and those of receiver and autopilot.
#[derive(Debug)]
pub struct Started {
    /// The process.
    pub process: Process,
    /// The first UART.
    pub link: TcpStream,
    /// The second UART.
    pub log: TcpStream,
    /// The third UART and the fourth: the wires of satellite receiver and autopilot.
    pub wires: [TcpStream; 2],
    /// File of the memory that the machine shares, which QEMU opens after it has connected; `None`
    /// where it shares none.
    pub memory: Option<SharedMemory>,
}

/// Returns the program on the search path, or else the one that `cargo xtask` has fetched into this
/// program's target directory.
#[must_use]
pub fn find() -> Option<PathBuf> {
    let fetched = image::target_dir().map(|target| target.join("tools/qemu/bin"));
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path)
        .filter(|dir| !dir.as_os_str().is_empty())
        .chain(fetched)
        .map(|dir| dir.join(format!("{PROGRAM}{}", env::consts::EXE_SUFFIX)))
        .find(|file| file.is_file())
}

/// Starts a machine with an image. The memory that it shares is `kept`, or one of its own.
///
/// # Errors
/// The reason, with the output of QEMU, in words.
pub fn start(
    program: &Path,
    machine: Machine,
    image: &Path,
    kept: Option<SharedMemory>,
) -> Result<Started, String> {
    let system = |error: io::Error| format!("QEMU cannot be started: {error}");
    let link = listener().map_err(system)?;
    let log = listener().map_err(system)?;
    let receiver = listener().map_err(system)?;
    let autopilot = listener().map_err(system)?;
    let mut command = command(program);
    command
        .args(["-M", machine.qemu_name()])
        .args(["-display", "none", "-monitor", "none"])
        // One instruction takes 1 ns of virtual time, so that runs repeat exactly.
        .args(["-icount", "shift=0"])
        .args(["-semihosting-config", "enable=on,target=native"])
        .args(uart("link", &link).map_err(system)?)
        .args(uart("log", &log).map_err(system)?)
        .args(uart("receiver", &receiver).map_err(system)?)
        .args(uart("autopilot", &autopilot).map_err(system)?);
    let shared = match kept {
        Some(kept) => Some(kept),
        None => SharedMemory::temporary().map_err(system)?,
    };
    if let Some(file) = &shared {
        command.args(sharing(file.path()));
    }
    command
        .arg("-kernel")
        .arg(image)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    let mut child = command
        .spawn()
        .map_err(|error| format!("{}: cannot be started: {error}", program.display()))?;
    let stderr = LastLines::default();
    let stderr_thread = child.stderr.take().map(|pipe| {
        let kept = stderr.clone();
        thread::spawn(move || {
            for line in BufReader::new(pipe).split(b'\n').map_while(Result::ok) {
                kept.push(String::from_utf8_lossy(&line).into_owned());
            }
        })
    });
    let mut process = Process {
        child,
        stderr,
        stderr_thread,
    };
    let deadline = Instant::now() + UP_WITHIN;
    let link = process.accept(&link, deadline)?;
    let log = process.accept(&log, deadline)?;
    let receiver = process.accept(&receiver, deadline)?;
    let autopilot = process.accept(&autopilot, deadline)?;
    Ok(Started {
        process,
        link,
        log,
        wires: [receiver, autopilot],
        memory: shared,
    })
}

/// Returns the arguments that make a file the machine's PSRAM.
fn sharing(path: &Path) -> [OsString; 4] {
    // A comma ends an option, unless it is doubled.
    let path = path.to_string_lossy().replace(',', ",,");
    [
        "-machine".into(),
        "memory-backend=shared".into(),
        "-object".into(),
        format!("memory-backend-file,id=shared,size={MEMORY_BYTES},mem-path={path},share=on")
            .into(),
    ]
}

/// Returns the command that runs `program` so that it does not outlive this process.
fn command(program: &Path) -> Command {
    if Path::new(SETPRIV).is_file() {
        let mut command = Command::new(SETPRIV);
        command.args(["--pdeathsig", "KILL", "--"]).arg(program);
        command
    } else {
        Command::new(program)
    }
}

/// Opens a listener on a port of the system's choice; it does not block.
fn listener() -> io::Result<TcpListener> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    listener.set_nonblocking(true)?;
    Ok(listener)
}

/// Returns the arguments that connect the next UART to a listener.
fn uart(name: &str, listener: &TcpListener) -> io::Result<[OsString; 4]> {
    let port = listener.local_addr()?.port();
    Ok([
        "-chardev".into(),
        format!("socket,id={name},host=127.0.0.1,port={port},nodelay=on").into(),
        "-serial".into(),
        format!("chardev:{name}").into(),
    ])
}

impl Process {
    /// Waits for QEMU's connection to a listener.
    fn accept(&mut self, listener: &TcpListener, deadline: Instant) -> Result<TcpStream, String> {
        loop {
            match listener.accept() {
                Ok((stream, _)) => {
                    return stream
                        .set_nonblocking(false)
                        .map(|()| stream)
                        .map_err(|error| format!("QEMU's connection fails: {error}"));
                }
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
                Err(error) => return Err(format!("QEMU's connection fails: {error}")),
            }
            if let Ok(Some(status)) = self.child.try_wait() {
                return Err(self.ended(status, "at once"));
            }
            if Instant::now() >= deadline {
                return Err(format!(
                    "QEMU has not come up within {} s{}",
                    UP_WITHIN.as_secs(),
                    self.said()
                ));
            }
            thread::sleep(Duration::from_millis(2));
        }
    }

    /// The operating system's number of the process.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Returns how the process ended, if it has ended or does so within a moment.
    #[must_use]
    pub fn end(&mut self) -> Option<String> {
        let status = self.child.wait_timeout(Duration::from_millis(300)).ok()??;
        Some(self.ended(status, "half way"))
    }

    fn ended(&mut self, status: ExitStatus, when: &str) -> String {
        // The process has ended, so its pipe ends and the thread can be joined.
        if let Some(thread) = self.stderr_thread.take() {
            let _ = thread.join();
        }
        format!("QEMU ended {when}: {status}{}", self.said())
    }

    /// The output on the error stream.
    fn said(&self) -> String {
        indented("its error stream", &self.stderr.all())
    }

    /// Waits until the process has ended by itself, and kills it if it does not.
    pub fn wait_or_kill(&mut self) {
        if let Ok(Some(_)) = self.child.wait_timeout(DOWN_WITHIN) {
            return;
        }
        self.kill();
    }

    fn kill(&mut self) {
        // `kill` fails if the process has ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Returns lines under a heading, for the end of an error; an empty text without lines.
pub(super) fn indented(heading: &str, lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    format!("\n{heading}:\n  {}", lines.join("\n  "))
}
