//! Wires to a machine that shares memory with this program: whole requests and answers.
//!
//! QEMU takes several system calls over each byte of a UART, and a round of the control loop is a
//! hundred bytes. Firmware that offers it finds each request in memory instead, with what receiver
//! and autopilot have sent before, and leaves its answer there; a byte on the link's UART tells
//! either side that blocks have been written. The packets in the blocks are those of the wire.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::sync::{Arc, OnceLock};
use std::time::Instant;

use super::port::{Port, TcpPort};
use super::shared_memory::{SharedMemory, read_at, write_at};

/// First word, by the firmware: it takes blocks.
const OFFERED: [u8; 4] = *b"FMCb";
/// Second word, by this program: it sends blocks.
const OPEN: [u8; 4] = *b"open";
const OPEN_AT: u64 = 4;
const REQUEST_AT: u64 = 0x1000;
const ANSWER_AT: u64 = 0x2000;
const RECEIVER_AT: u64 = 0x3000;
const AUTOPILOT_AT: u64 = 0x4000;
/// Room for the bytes of a block.
const ROOM: usize = 0x0ffc;
/// Bytes of a block's length.
const LENGTH_BYTES: usize = 4;

/// The memory, once the firmware has offered it.
type Memory = Arc<OnceLock<File>>;

/// A wire beside memory that the machine shares; without such memory, or firmware that offers it,
/// the wire alone.
#[derive(Debug)]
pub struct BlockPort {
    wire: TcpPort,
    memory: Memory,
    kind: Kind,
}

/// Content of a wire.
#[derive(Debug)]
enum Kind {
    /// Requests and answers. The memory's file has a name, by which QEMU opens it, until the
    /// firmware offers blocks.
    Link(Option<SharedMemory>),
    /// Bytes of the aircraft, in the block at this place.
    Aircraft(u64),
}

impl BlockPort {
    /// Returns the ports of link, receiver and autopilot, whose bytes go over the wires until the
    /// firmware offers blocks.
    #[must_use]
    pub fn all(
        link: TcpPort,
        [receiver, autopilot]: [TcpPort; 2],
        memory: Option<SharedMemory>,
    ) -> [Self; 3] {
        let shared = Memory::default();
        [
            (link, Kind::Link(memory)),
            (receiver, Kind::Aircraft(RECEIVER_AT)),
            (autopilot, Kind::Aircraft(AUTOPILOT_AT)),
        ]
        .map(|(wire, kind)| Self {
            wire,
            memory: Arc::clone(&shared),
            kind,
        })
    }
}

/// Puts the memory into use if the firmware offers blocks.
fn open(named: &mut Option<SharedMemory>, memory: &Memory) -> io::Result<()> {
    let Some(file) = named.take() else {
        return Ok(());
    };
    let mut offered = [0; OFFERED.len()];
    read_at(file.file(), 0, &mut offered)?;
    if offered == OFFERED {
        write_at(file.file(), OPEN_AT, &OPEN)?;
        // QEMU has opened it by now, and its name is not needed any more.
        let _ = memory.set(file.into_file());
    } else {
        *named = Some(file);
    }
    Ok(())
}

/// Writes a block: the bytes, and then the length, by which the firmware knows that they are there.
fn write_block(memory: &File, at: u64, bytes: &[u8]) -> io::Result<()> {
    let length = u32::try_from(bytes.len()).map_err(|_| ErrorKind::InvalidInput)?;
    write_at(memory, at + LENGTH_BYTES as u64, bytes)?;
    write_at(memory, at, &length.to_le_bytes())
}

/// Reads a block into a buffer; returns its length.
fn read_block(memory: &File, at: u64, buffer: &mut [u8]) -> io::Result<usize> {
    let mut block = [0; LENGTH_BYTES + ROOM];
    read_at(memory, at, &mut block)?;
    let (length, bytes) = block.split_first_chunk().ok_or(ErrorKind::InvalidData)?;
    let length = usize::try_from(u32::from_le_bytes(*length)).unwrap_or(usize::MAX);
    let bytes = bytes.get(..length).ok_or(ErrorKind::InvalidData)?;
    let place = buffer.get_mut(..length).ok_or(ErrorKind::InvalidData)?;
    place.copy_from_slice(bytes);
    Ok(length)
}

impl Port for BlockPort {
    fn receive(&mut self, buffer: &mut [u8], deadline: Instant) -> io::Result<usize> {
        let Some(memory) = self.memory.get() else {
            return self.wire.receive(buffer, deadline);
        };
        let mut told = [0; 64];
        match self.wire.receive(&mut told, deadline)? {
            0 => Ok(0),
            _ => read_block(memory, ANSWER_AT, buffer),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Kind::Link(named) = &mut self.kind {
            open(named, &self.memory)?;
        }
        let Some(memory) = self.memory.get().filter(|_| bytes.len() <= ROOM) else {
            return self.wire.send(bytes);
        };
        match self.kind {
            Kind::Link(_) => {
                write_block(memory, REQUEST_AT, bytes)?;
                self.wire.send(&[0])
            }
            // The request that follows hands them over, and is answered before others come.
            Kind::Aircraft(at) => write_block(memory, at, bytes),
        }
    }
}
