//! Orders in which words reach the flash: that of the store, and two that must be caught.

use std::collections::BTreeMap;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use fmc_camera::io::store::SEAL_WORDS;

use crate::store::flash_model::{BLANK, Bytes, FlashModel, SECTOR, WORD};

/// A flash that is the model, or stands before it.
pub(crate) trait Order: NorFlash {
    fn before(model: FlashModel) -> Self;
    fn model(self) -> FlashModel;
}

impl Order for FlashModel {
    fn before(model: FlashModel) -> Self {
        model
    }

    fn model(self) -> FlashModel {
        self
    }
}

fn index(offset: u32) -> usize {
    usize::try_from(offset).unwrap() % SECTOR / WORD
}

/// Keeps the words of a body back until the commit word has been written.
pub(crate) struct CommitFirst {
    model: FlashModel,
    kept: BTreeMap<u32, Bytes>,
}

impl Order for CommitFirst {
    fn before(model: FlashModel) -> Self {
        Self {
            model,
            kept: BTreeMap::new(),
        }
    }

    fn model(self) -> FlashModel {
        self.model
    }
}

impl ErrorType for CommitFirst {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for CommitFirst {
    const READ_SIZE: usize = FlashModel::READ_SIZE;

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

impl NorFlash for CommitFirst {
    const WRITE_SIZE: usize = FlashModel::WRITE_SIZE;
    const ERASE_SIZE: usize = FlashModel::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.model.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        if index(offset) > usize::from(SEAL_WORDS) {
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

/// Shows a seal behind every commit word, so that the store takes each as written to its end.
pub(crate) struct SealsAssumed(FlashModel);

impl Order for SealsAssumed {
    fn before(model: FlashModel) -> Self {
        Self(model)
    }

    fn model(self) -> FlashModel {
        self.0
    }
}

impl ErrorType for SealsAssumed {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for SealsAssumed {
    const READ_SIZE: usize = FlashModel::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.0.read(offset, bytes)?;
        let sector = usize::try_from(offset).unwrap() / SECTOR;
        if index(offset) == 1 && bytes == BLANK && !self.0.sectors[sector].is_empty() {
            bytes.fill(0);
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for SealsAssumed {
    const WRITE_SIZE: usize = FlashModel::WRITE_SIZE;
    const ERASE_SIZE: usize = FlashModel::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.0.write(offset, bytes)
    }
}
