//! The wire to a camera: bytes, with a time limit.

use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Longest time that a port may take to accept a message.
pub(super) const SEND_WITHIN: Duration = Duration::from_secs(1);

/// A wire to a camera.
pub trait Port: Send {
    /// Receives the bytes that have arrived, as many as fit; where there are none yet, waits for
    /// the first until `deadline`. Returns 0 if none came.
    ///
    /// # Errors
    /// [`ErrorKind::UnexpectedEof`] where the other end has closed the port; also every other error
    /// that the system reports.
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize>;

    /// Sends all bytes.
    ///
    /// # Errors
    /// As [`Self::receive`]; [`ErrorKind::TimedOut`] where the port does not take them.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// Returns the time left until `deadline`; never zero, which ports read as "for ever".
pub(super) fn time_left(deadline: Instant) -> Duration {
    deadline
        .saturating_duration_since(Instant::now())
        .max(Duration::from_millis(1))
}

/// Interprets the result of a read: a time limit that passed is not an error, the end of the stream
/// is one.
pub(super) fn received(read: io::Result<usize>) -> io::Result<usize> {
    match read {
        Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
        Err(error) if is_time_out(&error) || error.kind() == ErrorKind::Interrupted => Ok(0),
        other => other,
    }
}

/// Interprets the result of a write: both error kinds of a passed time limit become one.
pub(super) fn sent(written: io::Result<()>) -> io::Result<()> {
    written.map_err(|error| {
        if is_time_out(&error) {
            ErrorKind::TimedOut.into()
        } else {
            error
        }
    })
}

fn is_time_out(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock)
}

/// A connection over TCP.
#[derive(Debug)]
pub struct TcpPort {
    stream: TcpStream,
}

impl TcpPort {
    /// Returns a port over an open connection.
    ///
    /// # Errors
    /// The system's error where it refuses the settings of the connection.
    pub fn new(stream: TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(SEND_WITHIN))?;
        Ok(Self { stream })
    }
}

impl Port for TcpPort {
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(time_left(deadline)))?;
        received(self.stream.read(buffer))
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        sent(self.stream.write_all(bytes))
    }
}
