//! Flashes before which the ring is wrong, as the tests of its cuts must find.

use std::collections::BTreeMap;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use fmc_camera::io::store::record_flash::RecordFlash;
use fmc_camera::io::store::record_ring::ENTRY_WORDS;

use crate::store::flash_model::{Bytes, FlashOf, WORD};

/// A flash whose sectors hold few entries, so that a short flight goes round.
pub(crate) type Small = FlashOf<6, 4096>;

/// A flash that is the model, or stands before it.
pub(crate) trait RingFlash: RecordFlash + Clone {
    fn before(model: Small) -> Self;
    fn model_mut(&mut self) -> &mut Small;
    fn into_model(self) -> Small;
}

impl RingFlash for Small {
    fn before(model: Small) -> Self {
        model
    }

    fn model_mut(&mut self) -> &mut Small {
        self
    }

    fn into_model(self) -> Small {
        self
    }
}

/// Index of a word in its entry; `None` for words of the place of the sector's first word.
fn index_in_entry(offset: u32) -> Option<usize> {
    let index = usize::try_from(offset).unwrap() % Small::ERASE_SIZE / WORD;
    (index >= ENTRY_WORDS).then_some(index % ENTRY_WORDS)
}

/// Keeps the words of an entry back until the last has been written, which has the CRC-32.
#[derive(Clone)]
pub(crate) struct LastWordFirst {
    model: Small,
    kept: BTreeMap<u32, Bytes>,
}

impl RingFlash for LastWordFirst {
    fn before(model: Small) -> Self {
        Self {
            model,
            kept: BTreeMap::new(),
        }
    }

    fn model_mut(&mut self) -> &mut Small {
        &mut self.model
    }

    fn into_model(self) -> Small {
        self.model
    }
}

impl ErrorType for LastWordFirst {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for LastWordFirst {
    const READ_SIZE: usize = Small::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        match self.kept.get(&offset) {
            Some(kept) => bytes.copy_from_slice(kept),
            None => self.model.read(offset, bytes)?,
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.model.capacity()
    }
}

impl NorFlash for LastWordFirst {
    const WRITE_SIZE: usize = Small::WRITE_SIZE;
    const ERASE_SIZE: usize = Small::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.model.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        if index_in_entry(offset).is_some_and(|index| index + 1 < ENTRY_WORDS) {
            self.kept.insert(offset, bytes.try_into().unwrap());
            return Ok(());
        }
        self.model.write(offset, bytes)?;
        for (offset, bytes) in core::mem::take(&mut self.kept) {
            self.model.write(offset, &bytes)?;
        }
        Ok(())
    }
}

impl RecordFlash for LastWordFirst {
    fn begin_erasure(&mut self, offset: u32) -> Result<(), Self::Error> {
        self.model.begin_erasure(offset)
    }

    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>> {
        self.model.end_erasure()
    }
}

/// Shows the CRC-32 behind every entry that fits what is there, so that the ring takes each as
/// written to its end.
#[derive(Clone)]
pub(crate) struct ChecksAssumed(Small);

impl RingFlash for ChecksAssumed {
    fn before(model: Small) -> Self {
        Self(model)
    }

    fn model_mut(&mut self) -> &mut Small {
        &mut self.0
    }

    fn into_model(self) -> Small {
        self.0
    }
}

impl ErrorType for ChecksAssumed {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for ChecksAssumed {
    const READ_SIZE: usize = Small::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.read(offset, bytes)?;
        let Some(index) = index_in_entry(offset).filter(|index| index + 1 == ENTRY_WORDS) else {
            return Ok(());
        };
        let mut entry = Vec::new();
        for before in (1..=index).rev() {
            let mut word = [0; WORD];
            let before = u32::try_from(before * WORD).unwrap();
            self.0.read(offset - before, &mut word)?;
            entry.extend(word);
        }
        let (rest, check) = bytes.split_last_chunk_mut::<4>().unwrap();
        entry.extend_from_slice(rest);
        let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
        *check = crc.checksum(&entry).to_le_bytes();
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for ChecksAssumed {
    const WRITE_SIZE: usize = Small::WRITE_SIZE;
    const ERASE_SIZE: usize = Small::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.0.write(offset, bytes)
    }
}

impl RecordFlash for ChecksAssumed {
    fn begin_erasure(&mut self, offset: u32) -> Result<(), Self::Error> {
        self.0.begin_erasure(offset)
    }

    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>> {
        self.0.end_erasure()
    }
}
