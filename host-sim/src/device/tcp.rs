//! A camera whose link another program, or a converter, forwards over TCP.

use std::io;
use std::net::{TcpStream, ToSocketAddrs as _};
use std::path::PathBuf;
use std::time::Duration;

use super::error::DeviceError;
use super::link_error::LinkError;
use super::open::OpenError;
use super::port::TcpPort;
use super::remote::{Remote, Session};

/// Longest time for a connection to be made.
const CONNECTED_WITHIN: Duration = Duration::from_secs(5);

/// Advice for an address where nobody answers.
const NOBODY: &str = "is the program or the converter that forwards the camera's link running, and \
                      is this its port?";

/// Advice for an address where something else answers.
const HINTS: &str = "is it the camera's link that is forwarded, its bytes unchanged? Is the camera \
                     on and flashed with the firmware of this program?";

/// Connects to the camera at an address, as `HOST:PORT`.
///
/// # Errors
/// [`OpenError::Port`] where nobody answers, or not as a camera.
pub fn connect(address: &str, session: Session) -> Result<Remote<TcpPort>, OpenError> {
    let port = open(address)?;
    Remote::connect(&format!("tcp:{address}"), port, session).map_err(|error| match error {
        DeviceError::Link { error, .. } if !matches!(error, LinkError::OtherProtocol(_)) => {
            let what = format!("the device there does not answer as a camera: {error}");
            failed(address, what, HINTS)
        }
        other => OpenError::Device(other),
    })
}

/// Opens the link at an address, as `HOST:PORT`, without asking anything.
///
/// # Errors
/// [`OpenError::Port`] where nobody answers.
pub fn open(address: &str) -> Result<TcpPort, OpenError> {
    dial(address)
        .and_then(TcpPort::new)
        .map_err(|error| failed(address, format!("no connection: {error}"), NOBODY))
}

fn failed(address: &str, what: String, help: &'static str) -> OpenError {
    OpenError::Port {
        path: PathBuf::from(address),
        what,
        help: Some(help),
    }
}

/// Tries each address of a host, and returns the last error if none answers.
fn dial(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECTED_WITHIN) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = error,
        }
    }
    Err(last)
}
