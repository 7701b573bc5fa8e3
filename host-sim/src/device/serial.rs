//! A camera on a serial port.

use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;
use std::time::Instant;

use super::error::DeviceError;
use super::link_error::LinkError;
use super::open::OpenError;
use super::port::{self, Port, SEND_WITHIN};
use super::remote::{Remote, Session};
use super::serial_line::SerialLine;

/// Advice for a port with another device or none.
const HINTS: &str = "is it the camera's port? Is the camera on and flashed with the firmware of \
                     this program? Are RX and TX crossed, and grounds joined? The link runs at \
                     921,600 baud, 8N1, without flow control; for firmware that was built with \
                     FMC_LINK_BAUD name its speed: serial:PATH:BAUD.";

/// A serial port in the exclusive use of this program.
pub struct SerialPort {
    port: Box<dyn serialport::SerialPort>,
}

impl std::fmt::Debug for SerialPort {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SerialPort").finish_non_exhaustive()
    }
}

impl SerialPort {
    /// Opens a port for the exclusive use of this program.
    ///
    /// # Errors
    /// [`OpenError::Port`] naming the port, where it is missing, not a serial port, or in use.
    pub fn open(line: &SerialLine) -> Result<Self, OpenError> {
        let path = line.path.as_path();
        let failed = |what: String, help| OpenError::Port {
            path: path.to_owned(),
            what,
            help,
        };
        check_file(path).map_err(|(what, help)| failed(what, help))?;
        let name = path.to_string_lossy();
        let port = serialport::new(name, line.baud)
            .timeout(SEND_WITHIN)
            .open()
            .map_err(|error| match error.kind() {
                serialport::ErrorKind::NoDevice => failed(
                    "is in use by another program, or gone".to_owned(),
                    Some("close the other program; one at a time can talk to a camera"),
                ),
                serialport::ErrorKind::Io(ErrorKind::PermissionDenied) => failed(
                    "permission denied".to_owned(),
                    Some("on most Linux systems the port belongs to the group dialout: add the user to it and log in again"),
                ),
                serialport::ErrorKind::Io(_) => {
                    failed(format!("cannot be opened: {error}"), None)
                }
                _ => failed(format!("is not a serial port: {error}"), None),
            })?;
        // Bytes that arrived before belong to another conversation.
        let _ = port.clear(serialport::ClearBuffer::Input);
        Ok(Self { port })
    }
}

/// Refuses a path that cannot be a port, with a more precise message than the system's.
#[cfg(unix)]
fn check_file(path: &Path) -> Result<(), (String, Option<&'static str>)> {
    use std::os::unix::fs::FileTypeExt as _;
    match std::fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Err((
            "there is no such port".to_owned(),
            Some(
                "is the camera plugged in? Ports appear as /dev/ttyACM*, /dev/ttyUSB* or /dev/cu.*",
            ),
        )),
        Err(error) => Err((format!("cannot be opened: {error}"), None)),
        Ok(file) if !file.file_type().is_char_device() => {
            Err(("is not a serial port".to_owned(), None))
        }
        Ok(_) => Ok(()),
    }
}

/// Ports of Windows are not files.
#[cfg(not(unix))]
fn check_file(_: &Path) -> Result<(), (String, Option<&'static str>)> {
    Ok(())
}

impl Port for SerialPort {
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize> {
        self.port.set_timeout(port::time_left(deadline))?;
        port::received(self.port.read(buffer))
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.set_timeout(SEND_WITHIN)?;
        port::sent(self.port.write_all(bytes))
    }
}

/// Opens a port and connects to the camera on it.
///
/// # Errors
/// [`OpenError::Port`] where the port cannot be opened, or the device on it is not a camera.
pub fn connect(line: &SerialLine, session: Session) -> Result<Remote<SerialPort>, OpenError> {
    let port = SerialPort::open(line)?;
    let name = format!("serial:{line}");
    Remote::connect(&name, port, session).map_err(|error| match error {
        DeviceError::Link { error, .. }
            if !matches!(error, LinkError::OtherProtocol(_) | LinkError::Closed) =>
        {
            OpenError::Port {
                path: line.path.clone(),
                what: format!("the device on it does not answer as a camera: {error}"),
                help: Some(HINTS),
            }
        }
        other => OpenError::Device(other),
    })
}
