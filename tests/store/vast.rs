//! Flashes as no board has them: one without an end, whose words nobody can write.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use fmc_camera::io::store::record_flash::RecordFlash;
use fmc_camera::io::store::record_ring::{Erasing, RecordRing, RingState};
use fmc_camera::io::store::{CalibrationStore, LayoutError};

use crate::store::flash_model::{SECTOR, WORD};

/// A blank flash of as many bytes as there are addresses, which takes nothing.
#[derive(Debug, Clone)]
struct Vast;

impl ErrorType for Vast {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Vast {
    const READ_SIZE: usize = WORD;

    fn read(&mut self, _: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        bytes.fill(0xff);
        Ok(())
    }

    fn capacity(&self) -> usize {
        usize::MAX
    }
}

impl NorFlash for Vast {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), Self::Error> {
        Err(NorFlashErrorKind::Other)
    }

    fn write(&mut self, _: u32, _: &[u8]) -> Result<(), Self::Error> {
        Err(NorFlashErrorKind::Other)
    }
}

impl RecordFlash for Vast {
    fn begin_erasure(&mut self, _: u32) -> Result<(), Self::Error> {
        Err(NorFlashErrorKind::Other)
    }

    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>> {
        None
    }
}

#[test]
fn store_and_ring_end_where_offsets_of_32_bits_do() {
    let capacity = usize::MAX;
    let sector = u32::try_from(SECTOR).unwrap();
    let last = u32::MAX - (sector - 1);
    let of_store = |offset| CalibrationStore::new(Vast, offset).map(|_| ());
    assert_eq!(of_store(last - 2 * sector), Ok(()));
    let required = usize::try_from(last).unwrap() + 2 * SECTOR;
    let no_place = LayoutError::NoPlace { required, capacity };
    assert_eq!(of_store(last), Err(no_place));
    let of_ring = |offset| RecordRing::open(Vast, offset, 3).map(|_| ());
    assert_eq!(of_ring(last - 3 * sector), Ok(()));
    let required = required + SECTOR;
    let no_place = LayoutError::NoPlace { required, capacity };
    assert_eq!(of_ring(last), Err(no_place));
}

#[test]
fn ring_whose_sectors_cannot_be_erased_is_worn_and_takes_no_entry() {
    let mut ring = RecordRing::open(Vast, 0, 6).unwrap();
    assert_eq!(ring.state(), RingState::Idle);
    let steps = (0..1000).take_while(|_| ring.step(Erasing::Ahead) != RingState::Worn);
    assert!(steps.count() < 100, "it gives up");
    assert_eq!((ring.holds_entry(), ring.erasures()), (false, 0));
    assert!(!ring.push(b"entry"));
    assert!(!ring.holds_entry());
    assert_eq!(ring.step(Erasing::Ahead), RingState::Worn);
}
