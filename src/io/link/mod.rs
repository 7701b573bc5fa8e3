//! The serial link between camera and PC: messages, frames, and the camera's end of it.
//!
//! # On the wire
//! A message is one *frame*: `COBS(payload ‖ CRC-32 of the payload, little-endian) ‖ 0x00`. COBS keeps
//! the zero byte out of a frame, so that a zero always ends one and whoever joins in the middle finds
//! the next. Empty frames mean nothing: a sender may put zeros before a frame. The CRC is CRC-32
//! (ISO-HDLC); under COBS one wrong bit on the wire can displace bytes of the payload, and a CRC of
//! 16 bits lets some errors of 3 bits through.
//!
//! The payload is [`PROTOCOL_VERSION`] as one byte, then a [`message::Header`] and a
//! [`message::Request`] or [`message::Answer`] as `postcard` writes them. The first byte keeps its
//! meaning in every version, so that two versions can tell each other apart.
//!
//! # Conversation
//! The PC asks, the camera answers; one request at a time is on the way, which is what keeps either
//! side from being overrun. A [`message::Request::Connect`] starts a session under a number of the PC's choice and
//! ends any other. Requests of a session are numbered one after the other: one that comes again is
//! answered again, from memory and without being acted on twice, so that the PC may repeat what was
//! not answered; any other number is refused.
//!
//! Nothing is acted on but a whole frame with the right CRC, of this version, that decodes to its
//! last byte, from the open session and in order. Everything else is counted ([`message::Counters`]).

pub mod digest;
pub mod frame;
pub mod message;
pub mod station;

/// The version of frames and messages. Changes whenever a message does.
pub const PROTOCOL_VERSION: u8 = 1;

/// Points in one message; every buffer's size follows from it.
pub const MAX_POINTS: usize = 64;

/// Longest payload, bytes: [`MAX_POINTS`] answers of four numbers, and what surrounds them.
pub const LONGEST_PAYLOAD: usize = 16 * MAX_POINTS + 16;

/// Longest payload with its CRC, bytes.
pub(crate) const LONGEST_CHECKED: usize = LONGEST_PAYLOAD + 4;

/// Longest frame, bytes, with its final zero.
pub const LONGEST_FRAME: usize = cobs::max_encoding_length(LONGEST_CHECKED) + 1;
