//! Messages of an autopilot (`MAVLink` 1 and 2): speed, heights, attitude and time, byte by byte.
//!
//! The receiver reads `GLOBAL_POSITION_INT`, `DISTANCE_SENSOR`, `ALTITUDE`, `ATTITUDE` and
//! `SYSTEM_TIME` of the common dialect, and ignores every other message: it searches the bytes of
//! such a message for the beginning of one that it reads. After a candidate whose checksum is wrong
//! the search goes on from its second byte, so that no frame is lost behind a false beginning. One
//! byte computes one checksum of a wrong candidate at most. Signatures are not verified.
//!
//! The link check of `tests/no-panic` covers this module, and the flight images contain it. A test
//! compares it with the crate `mavlink`.

mod message;
mod payload;
mod reading;
mod unexplained;

use core::cell::Cell;

use crc::{CRC_16_MCRF4XX, Crc, Table};
use heapless::Vec;

use self::message::{Memory, Message};
use self::payload::Payload;
use self::unexplained::Unexplained;

pub use self::message::{ALTITUDE_PREFERRED, TRACK_WITHIN_MS};
pub use self::payload::LONGEST_PAYLOAD;
pub use self::reading::{MAX_SAMPLES, MavlinkError, MavlinkReading, MavlinkSender};

/// Longest frame that is read: version 2 with that payload and a signature, bytes.
pub const LONGEST_PACKET: usize = 10 + LONGEST_PAYLOAD + CHECKSUM_BYTES + SIGNATURE_BYTES;

/// First byte of a frame of version 1, and of version 2.
const BEGINNINGS: [u8; 2] = [0xfe, 0xfd];

const CRC: Crc<u16, Table<1>> = Crc::<u16, Table<1>>::new(&CRC_16_MCRF4XX);

/// In version 2: the frame ends with a signature.
const SIGNED: u8 = 1;

const SIGNATURE_BYTES: usize = 13;

const CHECKSUM_BYTES: usize = 2;

/// Offsets of the parts of a frame.
#[derive(Debug, Clone, Copy)]
struct Layout {
    sender: MavlinkSender,
    payload_at: usize,
    payload_bytes: usize,
    bytes: usize,
}

/// The beginning of the bytes received.
#[derive(Debug, Clone, Copy)]
enum Beginning {
    /// A frame that is read, if its checksum is right.
    Read(Layout, Message),
    /// A frame of so many bytes that is not read, if it is one.
    PassedOver(usize),
    /// There are too few bytes to tell.
    Incomplete,
    /// No frame.
    None,
}

/// Cuts an autopilot's bytes into messages and reads them.
///
/// Some messages depend on earlier ones of the same sender: `ATTITUDE` on the track of
/// `GLOBAL_POSITION_INT`, whose altitude depends on `ALTITUDE`. Where several senders share a wire,
/// each makes the receiver forget the messages of the others; the wires of `io::instruments` listen
/// to one of them.
#[derive(Debug, Clone, Default)]
pub struct MavlinkReceiver {
    received: Vec<u8, LONGEST_PACKET>,
    memory: Memory,
    unexplained: Unexplained,
}

impl MavlinkReceiver {
    /// A receiver before the first byte.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            received: Vec::new(),
            memory: Memory::NONE,
            unexplained: Unexplained::NONE,
        }
    }

    /// Takes one byte; a reading, or the reason why there is none, where the byte ends a message.
    ///
    /// Behind a false beginning several messages may end with one byte: [`Self::buffered`] gives
    /// the others, or each of the next bytes one of them.
    ///
    /// # Errors
    /// [`MavlinkError`]; a whole frame that follows is read whatever came before it, at most
    /// [`LONGEST_PACKET`] bytes late.
    pub fn receive(&mut self, byte: u8) -> Option<Result<MavlinkReading, MavlinkError>> {
        self.receive_from(byte, |_| true)
    }

    /// Takes one byte as [`Self::receive`] does; messages of a sender that is not listened to are
    /// not read.
    ///
    /// # Errors
    /// As [`Self::receive`], and [`MavlinkError::OtherSender`].
    pub(crate) fn receive_from(
        &mut self,
        byte: u8,
        is_listened_to: impl FnMut(MavlinkSender) -> bool,
    ) -> Option<Result<MavlinkReading, MavlinkError>> {
        if self.received.push(byte).is_err() {
            // A full buffer is a whole frame, and was cut.
            self.received.clear();
        }
        self.buffered_from(is_listened_to)
    }

    /// The next message among the bytes that have come.
    ///
    /// # Errors
    /// As [`Self::receive`].
    pub fn buffered(&mut self) -> Option<Result<MavlinkReading, MavlinkError>> {
        self.buffered_from(|_| true)
    }

    /// The next message among the bytes that have come, as [`Self::receive_from`].
    ///
    /// # Errors
    /// As [`Self::receive_from`].
    pub(crate) fn buffered_from(
        &mut self,
        is_listened_to: impl FnMut(MavlinkSender) -> bool,
    ) -> Option<Result<MavlinkReading, MavlinkError>> {
        let mut passed = 0;
        let answer = self.search(&mut passed, is_listened_to);
        // Once, however many beginnings were false.
        if passed > 0 {
            self.drop_first(passed);
        }
        answer
    }

    /// Searches the bytes from a place on, and moves the place behind those that are done with.
    fn search(
        &mut self,
        passed: &mut usize,
        mut is_listened_to: impl FnMut(MavlinkSender) -> bool,
    ) -> Option<Result<MavlinkReading, MavlinkError>> {
        loop {
            let bytes = self.received.get(*passed..)?;
            let (layout, message) = match beginning(bytes) {
                Beginning::Incomplete => return None,
                Beginning::None => {
                    *passed += give_up_beginning(bytes, None, &mut self.unexplained);
                    continue;
                }
                Beginning::PassedOver(frame_bytes) => {
                    *passed += give_up_beginning(bytes, Some(frame_bytes), &mut self.unexplained);
                    continue;
                }
                Beginning::Read(layout, message) => (layout, message),
            };
            if bytes.len() < layout.bytes {
                return None;
            }
            let Some(payload) = checked_payload(bytes, layout, message) else {
                *passed += give_up_beginning(bytes, None, &mut self.unexplained);
                return Some(Err(MavlinkError::Checksum));
            };
            self.unexplained.read_frame();
            *passed += layout.bytes;
            if !is_listened_to(layout.sender) {
                return Some(Err(MavlinkError::OtherSender));
            }
            let reading = message::read(layout.sender, message, &payload, &mut self.memory);
            if let Some(reading) = reading.transpose() {
                return Some(reading);
            }
        }
    }

    /// Returns `true` if a message has begun and not ended.
    #[must_use]
    pub fn is_under_way(&self) -> bool {
        !self.received.is_empty()
    }

    /// Bytes that belong to no frame since this was asked last: many of them mean a wrong baud
    /// rate. Frames that are not read count as frames where another one follows them.
    pub const fn take_unexplained(&mut self) -> u32 {
        self.unexplained.take()
    }

    fn drop_first(&mut self, count: usize) {
        let left = self.received.len().saturating_sub(count);
        let bytes = Cell::from_mut(self.received.as_mut_slice()).as_slice_of_cells();
        for (to, from) in bytes.iter().zip(bytes.get(count..).unwrap_or_default()) {
            to.set(from.get());
        }
        self.received.truncate(left);
    }
}

/// Returns the number of bytes up to the next that may begin a frame, and notes them as the
/// beginning of a frame of so many bytes that is not read, or of none.
fn give_up_beginning(
    bytes: &[u8],
    frame_bytes: Option<usize>,
    unexplained: &mut Unexplained,
) -> usize {
    let begins = |byte: &u8| BEGINNINGS.contains(byte);
    let next = bytes.iter().skip(1).position(begins);
    let count = next.map_or(bytes.len(), |next| next + 1);
    unexplained.pass(count, frame_bytes);
    count
}

/// Header of a frame: version 1 has 6 bytes, version 2 has 10.
fn beginning(bytes: &[u8]) -> Beginning {
    let (sender, message, payload_at, payload_bytes, signature_bytes) = match *bytes {
        [] => return Beginning::Incomplete,
        [0xfe, length, _, system, component, id, ..] => {
            let sender = MavlinkSender { system, component };
            (sender, u32::from(id), 6, length, 0)
        }
        [0xfd, _, flags, ..] if flags & !SIGNED != 0 => return Beginning::None,
        [
            0xfd,
            length,
            flags,
            _,
            _,
            system,
            component,
            low,
            middle,
            high,
            ..,
        ] => {
            let sender = MavlinkSender { system, component };
            let id = u32::from_le_bytes([low, middle, high, 0]);
            let signature_bytes = if flags == SIGNED { SIGNATURE_BYTES } else { 0 };
            (sender, id, 10, length, signature_bytes)
        }
        [0xfe | 0xfd, ..] => return Beginning::Incomplete,
        _ => return Beginning::None,
    };
    let payload_bytes = usize::from(payload_bytes);
    let bytes = payload_at + payload_bytes + CHECKSUM_BYTES + signature_bytes;
    let layout = Layout {
        sender,
        payload_at,
        payload_bytes,
        bytes,
    };
    match Message::of(message) {
        Some(message) if payload_bytes <= LONGEST_PAYLOAD => Beginning::Read(layout, message),
        _ => Beginning::PassedOver(bytes),
    }
}

/// The payload, if the checksum is right.
fn checked_payload(bytes: &[u8], layout: Layout, message: Message) -> Option<Payload> {
    let (frame, rest) = bytes.split_at_checked(layout.payload_at + layout.payload_bytes)?;
    let (checksum, _) = rest.split_first_chunk::<CHECKSUM_BYTES>()?;
    let (_, checked) = frame.split_first()?;
    let mut right = CRC.digest();
    right.update(checked);
    right.update(&[message.extra_of_checksum()]);
    if u16::from_le_bytes(*checksum) != right.finalize() {
        return None;
    }
    frame.get(layout.payload_at..).map(Payload::of)
}
