//! The serial link between camera and PC: messages, packets, and the camera's end of it.
//!
//! # On the wire
//! A message is one *packet*: `0x00 ‖ length ‖ COBS(payload) ‖ CRC ‖ 0x00`. COBS keeps the zero
//! byte out of the payload, so that a zero always ends a packet and a receiver that joins in the
//! middle finds the next. Empty packets have no meaning, and the zero in front ends a packet that
//! was left half-sent.
//!
//! Length and CRC are in bytes of seven bits, the lowest first, bit 7 set, so that they hold no
//! zero either: two bytes for the number of bytes that COBS made, five for the CRC-32 (ISO-HDLC) of
//! length and encoded payload, the bytes *as they are on the wire*. A CRC of the payload would not
//! suffice: one wrong bit in a block length of COBS turns other block lengths into data, so that
//! three wrong bits on the wire may become dozens in the payload, which its CRC then passes by
//! chance. Over the wire's bytes CRC-32 finds every error of up to three bits in packets of this
//! length; the packet's length detects errors that make a zero and so cut the packet in two
//! (`tests/link/wrong_bits.rs` tries all of them).
//!
//! The payload is [`PROTOCOL_VERSION`] as one byte, then a [`message::Header`] and a
//! [`message::Request`] or [`message::Answer`] as `postcard` writes them. The first byte keeps its
//! meaning in every version, so that two versions can tell each other apart.
//!
//! # Conversation
//! The PC asks, the camera answers; one request at a time is on the way, which keeps either side
//! from being overrun. A [`message::Request::Connect`] starts a session under a number of the PC's
//! choice and ends any other; 0 belongs to no session. Requests of a session are numbered one after
//! the other: a repeated request is answered again, from memory and without being acted on twice,
//! so that the PC may repeat a request that was not answered; any other number is refused.
//!
//! A [`message::Request::ConnectReading`] opens a second session beside it, for reading alone:
//! status, counters, inputs, what is stored, and frame records with their acknowledgement. It ends
//! neither session nor flight of the other. Its requests may be repeated, so that they are answered
//! anew, whatever their numbers.
//!
//! The camera acts only on a whole packet with the right CRC, of this version, that decodes to its
//! last byte, from the open session and in order. Everything else is counted
//! ([`message::Counters`]).

pub mod after_reset;
mod batch;
mod contents;
pub mod deck;
pub mod digest;
mod fitting;
mod flight_keeper;
pub mod flight_memory;
mod grid_loading;
mod identity;
pub mod link_event;
pub mod loading;
pub mod message;
pub mod packet;
mod point_correction;
#[cfg(feature = "store")]
mod record_keeper;
pub mod records_in_flash;
pub mod refusal;
mod reply;
mod responder;
#[cfg(feature = "store")]
mod ring_contents;
#[cfg(feature = "store")]
mod ring_taking_up;
mod round;
mod shelf;
pub mod station;
#[cfg(feature = "store")]
mod storing;
mod taking_up;
pub mod wired_deck;

/// Version of packets and messages. It changes whenever a message does.
pub const PROTOCOL_VERSION: u8 = 11;

/// Number of points in one message; every buffer's size follows from it.
pub const MAX_POINTS: usize = 64;

/// Number of observations in one message: as many as fit the payload of [`MAX_POINTS`] answers.
pub const MAX_OBSERVATIONS: usize = 40;

/// Most bytes of a camera's parameters, as `postcard` writes a
/// [`CameraParameters`](crate::flight::camera::CameraParameters): the camera keeps them until they
/// are complete.
pub const CALIBRATION_CAPACITY: usize = 336;

/// Most bytes of a camera's parameters in one message. A calibration comes in two to five, so that
/// every one that is loaded shows that parts are put together.
pub const MAX_PART: usize = 64;

/// Most bytes of a residual grid in one message: as many as those of [`MAX_POINTS`] points.
pub const MAX_GRID_PART: usize = 8 * MAX_POINTS;

/// Longest payload, bytes: [`MAX_POINTS`] answers of four numbers, and the fields around them.
pub const LONGEST_PAYLOAD: usize = 16 * MAX_POINTS + 16;

/// Longest packet of an answer that a session for reading asks for, bytes.
pub const LONGEST_READING: usize = 448;

/// Bytes of a CRC on the wire.
pub(crate) const CRC_BYTES: usize = 5;

/// Bytes of a length on the wire.
pub(crate) const LENGTH_BYTES: usize = 2;

/// Largest number of bytes between two zeros.
pub(crate) const LONGEST_CHECKED: usize =
    LENGTH_BYTES + cobs::max_encoding_length(LONGEST_PAYLOAD) + CRC_BYTES;

/// Longest packet, bytes, with a zero at either end.
pub const LONGEST_PACKET: usize = LONGEST_CHECKED + 2;
