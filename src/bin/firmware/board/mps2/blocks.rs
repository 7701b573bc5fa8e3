//! Blocks of the wires: whole requests, answers and sentences in memory that a PC shares with the
//! machine.
//!
//! QEMU takes several system calls over each byte of a UART. A PC that shares the machine's PSRAM
//! may hand over whole requests there instead, with all bytes that receiver and autopilot send
//! before: it finds [`OFFERED`] in the first word, writes [`OPEN`] into the second, and from then
//! on a byte on the link's UART, of any value, only tells that blocks have been written. Each block
//! is its length in a word, which is written last, and its bytes. The reader of a block writes
//! length 0 over it, so that a surplus byte on the UART hands over nothing twice. Without such a PC
//! the UARTs carry the bytes themselves, as on every other board.

use fmc_camera::io::instruments::Wire;
use fmc_camera::io::link::deck::RigDeck;

use super::registers::SharedMemory;
use super::uart::LINK;

/// First word: the firmware takes blocks (`FMCb`).
const OFFERED: u32 = 0x6243_4d46;
/// Second word: the PC sends blocks (`open`).
const OPEN: u32 = 0x6e65_706f;

const OFFER_AT: usize = 0;
const OPEN_AT: usize = 4;
const REQUEST_AT: usize = 0x1000;
const ANSWER_AT: usize = 0x2000;
const RECEIVER_AT: usize = 0x3000;
const AUTOPILOT_AT: usize = 0x4000;
/// Room for the bytes of a block.
const ROOM: usize = 0x0ffc;
/// Bytes of a block's length.
const LENGTH_BYTES: usize = 4;

/// The blocks, and the place in the request that is being read.
pub(super) struct Blocks {
    memory: SharedMemory,
    next: usize,
    end: usize,
    /// `true` until the bytes that came before the request have been handed over.
    told: bool,
}

impl Blocks {
    /// Offers blocks to the PC.
    pub(super) fn offered(memory: SharedMemory) -> Self {
        memory.write_word(OFFER_AT, OFFERED);
        Self {
            memory,
            next: 0,
            end: 0,
            told: false,
        }
    }

    /// Takes the next byte of the request that is being read.
    pub(super) fn next(&mut self) -> Option<u8> {
        let at = (self.next < self.end).then_some(self.next)?;
        self.next = at + 1;
        Some(self.memory.read_byte(at))
    }

    /// Takes a byte of the UART: it is one of a request, which is returned, or tells that blocks
    /// have been written. It tells nothing if the request has been taken before.
    pub(super) fn after(&mut self, byte: u8) -> Option<u8> {
        if !self.are_open() {
            return Some(byte);
        }
        let [from, end] = self.bytes_of(REQUEST_AT);
        if from < end {
            self.memory.write_word(REQUEST_AT, 0);
            [self.next, self.end] = [from, end];
            self.told = true;
        }
        None
    }

    /// Returns `true` if a request is to be read.
    pub(super) const fn hold_request(&self) -> bool {
        self.next < self.end
    }

    /// Hands over what receiver and autopilot have sent before the request.
    pub(super) fn hand_over(&mut self, deck: &mut RigDeck) {
        if !self.told {
            return;
        }
        self.told = false;
        for wire in Wire::ALL {
            let block = match wire {
                Wire::Receiver => RECEIVER_AT,
                Wire::Autopilot => AUTOPILOT_AT,
            };
            let [from, end] = self.bytes_of(block);
            for at in from..end {
                deck.hear(wire, self.memory.read_byte(at));
            }
            self.memory.write_word(block, 0);
        }
    }

    /// Sends an answer; returns the number of bytes sent.
    pub(super) fn send(&self, bytes: &[u8]) -> usize {
        if !self.are_open() {
            return super::link::send(bytes);
        }
        let from = ANSWER_AT + LENGTH_BYTES;
        for (at, byte) in (from..from + ROOM).zip(bytes) {
            self.memory.write_byte(at, *byte);
        }
        let length = u32::try_from(bytes.len()).unwrap_or_default();
        self.memory.write_word(ANSWER_AT, length);
        if LINK.put(0) { bytes.len() } else { 0 }
    }

    /// Returns where the bytes of a block begin and end.
    fn bytes_of(&self, block: usize) -> [usize; 2] {
        let length = usize::try_from(self.memory.read_word(block)).unwrap_or_default();
        let from = block + LENGTH_BYTES;
        [from, from + length.min(ROOM)]
    }

    fn are_open(&self) -> bool {
        self.memory.read_word(OPEN_AT) == OPEN
    }
}
