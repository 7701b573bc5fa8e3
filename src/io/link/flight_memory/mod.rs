//! Memory that a reset leaves alone, with the flight that was under way.
//!
//! The board places a [`FlightMemory`] where its start-up code does not write. In it are the number
//! of the start, the settings with which the camera was prepared, parameters that were loaded over
//! the link, the state of the flight, and every record that is not acknowledged
//! ([`Station::keep_flight_in`](super::station::Station::keep_flight_in)).
//!
//! Nothing in it is believed without its CRC-32. A reset can come between any two words: the
//! contents of a block are written before its CRC-32, which is taken away first; the state of the
//! flight has two copies, written one after the other; a record that changes is written beside its
//! old copy, which is taken away afterwards; and parameters that are exchanged in a flight are
//! written beside those before, until the state names them by their CRC-32. So of state, parameters
//! and each record at least one copy is whole at every time.

mod block;
mod contents;
#[cfg(test)]
mod keeper_tests;
#[cfg(test)]
mod tests;
mod words;

use core::sync::atomic::{AtomicU32, Ordering};

use self::block::Block;
pub(super) use self::contents::{KeptFlight, KeptHead, KeptRecord};
use self::words::{load, settle, store};
use crate::flight::record_log::{SLOTS, Slot};
use crate::flight::time::Time;

/// Most bytes of the state.
const HEAD_BYTES: usize = 288;
/// Most bytes of the settings.
const SETTINGS_BYTES: usize = 768;
/// Most bytes of the parameters of a camera.
const PARAMETERS_BYTES: usize = super::CALIBRATION_CAPACITY;
/// Most bytes of a record with its number of the flight.
const RECORD_BYTES: usize = 256;

/// The two copies of the state.
const HEADS: [Block; 2] = [Block::after(None, HEAD_BYTES), {
    let first = Block::after(None, HEAD_BYTES);
    Block::after(Some(&first), HEAD_BYTES)
}];
const SETTINGS: Block = Block::after(Some(&HEADS[1]), SETTINGS_BYTES);
/// The parameters in use, and those before.
const PARAMETERS: [Block; 2] = [Block::after(Some(&SETTINGS), PARAMETERS_BYTES), {
    let first = Block::after(Some(&SETTINGS), PARAMETERS_BYTES);
    Block::after(Some(&first), PARAMETERS_BYTES)
}];
/// The first of the records.
const RECORDS: Block = Block::after(Some(&PARAMETERS[1]), RECORD_BYTES);
/// Words of a time and its check.
const TIME_WORDS: usize = 3;
/// The two copies of the time of the last round.
const TIMES_AT: usize = RECORDS.nth(SLOTS).start();

/// Tells a time from what is in memory by chance.
const TIME_CHECK: u32 = 0x7e1a_5701;

/// Memory that a reset leaves alone.
///
/// It is made of words, with whose every content it can begin.
#[derive(Debug)]
#[repr(transparent)]
pub struct FlightMemory {
    words: [AtomicU32; Self::WORDS],
}

impl FlightMemory {
    /// Number of words of 32 bits.
    pub const WORDS: usize = TIMES_AT + 2 * TIME_WORDS;

    /// A memory without contents.
    #[must_use]
    pub const fn blank() -> Self {
        Self {
            words: [const { AtomicU32::new(0) }; Self::WORDS],
        }
    }

    /// A memory with these contents, as after a start of the camera.
    #[must_use]
    pub fn of_words(words: [u32; Self::WORDS]) -> Self {
        Self {
            words: words.map(AtomicU32::new),
        }
    }

    /// Its contents.
    #[must_use]
    pub fn words(&self) -> [u32; Self::WORDS] {
        self.words
            .each_ref()
            .map(|word| word.load(Ordering::Relaxed))
    }

    /// Takes all contents away, those of the state first.
    pub(super) fn clear(&self) {
        for at in 0..Self::WORDS {
            store(&self.words, at, 0);
        }
        settle();
    }

    /// Writes both copies of the state, one after the other.
    pub(super) fn write_head(&self, head: &KeptHead) {
        let mut buffer = [0; HEAD_BYTES];
        if let Ok(bytes) = postcard::to_slice(head, &mut buffer) {
            for block in &HEADS {
                block.write(&self.words, bytes);
            }
        }
    }

    /// Reads the state: the newer of its copies that are whole. Both are the same unless the reset
    /// came while they were written.
    pub(super) fn head(&self) -> Option<KeptHead> {
        let [first, second] = HEADS.map(|block| self.head_in(&block));
        match (first, second) {
            (Some(first), Some(second)) if second.writing > first.writing => Some(second),
            (Some(first), _) => Some(first),
            (None, second) => second,
        }
    }

    fn head_in(&self, block: &Block) -> Option<KeptHead> {
        let mut buffer = [0; HEAD_BYTES];
        let bytes = block.read(&self.words, &mut buffer)?;
        postcard::from_bytes(bytes).ok()
    }

    /// Writes settings, or parameters; returns their CRC-32, `None` if there is no room.
    #[inline(never)]
    pub(super) fn write_settings(&self, settings: &impl serde::Serialize) -> Option<u32> {
        let mut buffer = [0; SETTINGS_BYTES];
        let bytes = postcard::to_slice(settings, &mut buffer).ok()?;
        Some(SETTINGS.write(&self.words, bytes))
    }

    /// Reads the settings that have this CRC-32.
    #[inline(never)]
    pub(super) fn settings<T: serde::de::DeserializeOwned>(&self, crc: u32) -> Option<T> {
        let mut buffer = [0; SETTINGS_BYTES];
        let bytes = SETTINGS.read(&self.words, &mut buffer)?;
        let is_meant = block::sum(bytes) == crc;
        postcard::from_bytes(bytes).ok().filter(|_| is_meant)
    }

    /// Writes the parameters of a camera beside those in use, which have a CRC-32.
    #[inline(never)]
    pub(super) fn write_parameters(
        &self,
        parameters: &impl serde::Serialize,
        in_use: Option<u32>,
    ) -> Option<()> {
        let mut buffer = [0; PARAMETERS_BYTES];
        let [first, second] = &PARAMETERS;
        let in_first = first.read(&self.words, &mut buffer).map(block::sum);
        let spare = if in_first.is_some() && in_first == in_use {
            second
        } else {
            first
        };
        let bytes = postcard::to_slice(parameters, &mut buffer).ok()?;
        spare.write(&self.words, bytes);
        Some(())
    }

    /// Reads the bytes of a camera's parameters that have a CRC-32.
    #[inline(never)]
    pub(super) fn parameters<T>(&self, crc: u32, read: impl Fn(&[u8]) -> Option<T>) -> Option<T> {
        let mut buffer = [0; PARAMETERS_BYTES];
        let in_block = |block: &Block| {
            let bytes = block.read(&self.words, &mut buffer)?;
            read(bytes).filter(|_| block::sum(bytes) == crc)
        };
        PARAMETERS.iter().find_map(in_block)
    }

    /// Writes a record into a slot, and takes its old copy away.
    #[inline(never)]
    pub(super) fn write_record(&self, record: &KeptRecord, slot: Slot, outdated: Option<Slot>) {
        let mut buffer = [0; RECORD_BYTES];
        if let Ok(bytes) = postcard::to_slice(record, &mut buffer) {
            Self::record_block(slot).write(&self.words, bytes);
        }
        if let Some(outdated) = outdated {
            Self::record_block(outdated).take_away(&self.words);
        }
    }

    /// Reads the record of a slot; `None` if there is none, or it is damaged.
    #[inline(never)]
    pub(super) fn record(&self, slot: Slot) -> Option<KeptRecord> {
        let mut buffer = [0; RECORD_BYTES];
        let bytes = Self::record_block(slot).read(&self.words, &mut buffer)?;
        postcard::from_bytes(bytes).ok()
    }

    const fn record_block(slot: Slot) -> Block {
        RECORDS.nth(slot as usize)
    }

    /// Notes the time of a round.
    pub(super) fn write_time(&self, time: Time) {
        let us = time.us();
        #[expect(clippy::cast_possible_truncation, reason = "the halves of a number")]
        let (low, high) = (us as u32, (us >> 32) as u32);
        for copy in [0, TIME_WORDS] {
            store(&self.words, TIMES_AT + copy + 2, 0);
            settle();
            store(&self.words, TIMES_AT + copy, low);
            store(&self.words, TIMES_AT + copy + 1, high);
            settle();
            store(
                &self.words,
                TIMES_AT + copy + 2,
                low ^ high.rotate_left(16) ^ TIME_CHECK,
            );
            settle();
        }
    }

    /// Time of the last round; `None` before the first, or if both copies are damaged.
    pub(super) fn time(&self) -> Option<Time> {
        [0, TIME_WORDS].into_iter().find_map(|copy| {
            let [low, high, check] =
                [0, 1, 2].map(|word| load(&self.words, TIMES_AT + copy + word));
            let is_whole = check == low ^ high.rotate_left(16) ^ TIME_CHECK;
            is_whole.then(|| Time::from_us(u64::from(high) << 32 | u64::from(low)))
        })
    }
}
