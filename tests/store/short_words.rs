//! Flash of words of 8 bytes and sectors of 4 kB, in which the store is not at the beginning.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use fmc_camera::io::store::{CalibrationStore, MAX_SLOT_BYTES};

use crate::store::calibrations::{Credulous, calibration, order};

/// Offset of the store.
const OFFSET: usize = 4096;

/// Bytes of a slot: nine sectors.
const SLOT: usize = 9 * 4096;

/// A byte that belongs to others.
const OTHERS: u8 = 0x5a;

/// A flash that is full of the bytes of others.
#[derive(Debug)]
struct ShortWords {
    bytes: Vec<u8>,
}

impl ErrorType for ShortWords {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for ShortWords {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let offset = usize::try_from(offset).unwrap();
        bytes.copy_from_slice(&self.bytes[offset..offset + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for ShortWords {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = 4096;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        let [from, to] = [from, to].map(|offset| usize::try_from(offset).unwrap());
        self.bytes[from..to].fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        let offset = usize::try_from(offset).unwrap();
        let place = &mut self.bytes[offset..offset + bytes.len()];
        assert!(place.iter().all(|byte| *byte == 0xff), "written once");
        place.copy_from_slice(bytes);
        Ok(())
    }
}

#[test]
fn store_behind_others_in_small_sectors_writes_its_two_slots_alone() {
    let flash = ShortWords {
        bytes: vec![OTHERS; OFFSET + 2 * SLOT + 4096],
    };
    let store = CalibrationStore::new(flash, u32::try_from(OFFSET).unwrap());
    let mut store = store.unwrap().trusting(Credulous);
    for version in [6, 7] {
        let stored = store.store(&calibration(version), &order(version), None);
        assert_eq!(stored.unwrap().parameters, calibration(version));
    }
    let found = store.load(None).unwrap();
    assert_eq!((found.parameters, found.identity.slot), (calibration(7), 1));
    let bytes = store.into_flash().bytes;
    let (before, slots) = bytes.split_at(OFFSET);
    let (slots, behind) = slots.split_at(2 * SLOT);
    for others in [before, behind] {
        assert!(others.iter().all(|byte| *byte == OTHERS));
    }
    // A record without grids has some twenty words; the rest of its slot has been erased.
    for slot in slots.chunks(SLOT) {
        assert_eq!(&slot[..4], b"FMCS");
        assert!(slot[1024..].iter().all(|byte| *byte == 0xff));
    }
    const { assert!(MAX_SLOT_BYTES > SLOT - 4096 && MAX_SLOT_BYTES <= SLOT) };
}
