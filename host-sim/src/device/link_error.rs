//! How a conversation with a camera fails.

use std::io;

use fmc_camera::io::link::PROTOCOL_VERSION;
use fmc_camera::io::link::message::Refusal;

/// What arrived while an answer was waited for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Heard {
    /// All bytes.
    pub bytes: usize,
    /// Whole messages that belong to another conversation.
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

/// A request has no usable answer.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LinkError {
    /// It was sent so many times.
    #[error("no answer to \"{request}\" after {tries} tries: {heard}")]
    NoAnswer {
        /// What was asked.
        request: &'static str,
        /// How often.
        tries: u32,
        /// What came instead.
        heard: Heard,
    },
    /// The camera speaks this version of the protocol.
    #[error(
        "the camera speaks version {0} of the protocol, this program version {PROTOCOL_VERSION}"
    )]
    OtherProtocol(u8),
    /// The camera knows nothing of the session.
    #[error(
        "the session has ended: another host has connected to the camera, or the camera has restarted"
    )]
    SessionEnded,
    /// The port closed.
    #[error("the port closed")]
    Closed,
    /// The system reports an error of the port.
    #[error("the port fails: {0}")]
    Port(io::ErrorKind),
    /// The request itself came back.
    #[error("what is sent comes back: an echo, not a camera")]
    Echo,
    /// An answer to something else.
    #[error("the answer to \"{request}\" is none")]
    Unexpected {
        /// What was asked.
        request: &'static str,
    },
    /// A flight record is not the one that the camera made.
    #[error("flight record {0} does not have its CRC")]
    RecordCrc(u32),
    /// The camera refuses.
    #[error("the camera refuses \"{request}\": {refusal}")]
    Refused {
        /// What was asked.
        request: &'static str,
        /// Why.
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
