//! Errors of a conversation with a camera.

use std::io;

use fmc_camera::io::link::PROTOCOL_VERSION;
use fmc_camera::io::link::message::Refusal;

/// Data that arrived during the wait for an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Heard {
    /// Number of all bytes.
    pub bytes: usize,
    /// Number of whole messages that belong to another conversation.
    pub others: usize,
}

impl std::fmt::Display for Heard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self { bytes: 0, .. } => f.write_str("nothing arrived"),
            Self { bytes, others: 0 } => {
                write!(f, "{bytes} bytes arrived and no whole message among them")
            }
            Self { others, .. } => write!(f, "only messages of other conversations, {others}"),
        }
    }
}

/// An error of a request.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// No answer came after so many tries.
    #[error("no answer to \"{request}\" after {tries} tries: {heard}")]
    NoAnswer {
        /// Request.
        request: &'static str,
        /// Number of tries.
        tries: u32,
        /// Data that came instead.
        heard: Heard,
    },
    /// The camera uses this version of the protocol.
    #[error(
        "the camera speaks version {0} of the protocol, this program version {PROTOCOL_VERSION}"
    )]
    OtherProtocol(u8),
    /// The camera does not know the session.
    #[error(
        "the session has ended: another host has connected to the camera, or the camera has restarted"
    )]
    SessionEnded,
    /// The port was closed.
    #[error("the port closed")]
    Closed,
    /// The operating system reports an error of the port.
    #[error("the port fails: {0}")]
    Port(io::ErrorKind),
    /// The request itself was received back.
    #[error("everything that is sent comes back: an echo, not a camera")]
    Echo,
    /// The answer is to something else.
    #[error("the answer to \"{request}\" is none")]
    Unexpected {
        /// Request.
        request: &'static str,
    },
    /// A frame record differs from the one that the camera made.
    #[error("frame record {0} does not have its CRC")]
    RecordCrc(u32),
    /// The camera refuses the request.
    #[error("the camera refuses \"{request}\": {refusal}")]
    Refused {
        /// Request.
        request: &'static str,
        /// Reason.
        refusal: Refusal,
    },
}

impl From<io::Error> for LinkError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof
            | io::ErrorKind::BrokenPipe
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::NotConnected => Self::Closed,
            kind => Self::Port(kind),
        }
    }
}
