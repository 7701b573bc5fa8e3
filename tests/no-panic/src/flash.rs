//! A flash of unknown behaviour.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use fmc_camera::io::store::record_flash::RecordFlash;

/// Flash of which any call can fail.
#[derive(Debug)]
pub(crate) struct Flash;

#[inline(never)]
fn unknown() -> Result<(), NorFlashErrorKind> {
    core::hint::black_box(Err(NorFlashErrorKind::Other))
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, _: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        for byte in bytes {
            *byte = core::hint::black_box(0);
        }
        unknown()
    }

    fn capacity(&self) -> usize {
        core::hint::black_box(0)
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 32;
    const ERASE_SIZE: usize = 128 * 1024;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), Self::Error> {
        unknown()
    }

    fn write(&mut self, _: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        core::hint::black_box(bytes);
        unknown()
    }
}

impl RecordFlash for Flash {
    fn begin_erasure(&mut self, _: u32) -> Result<(), Self::Error> {
        unknown()
    }

    fn end_erasure(&mut self) -> Option<Result<(), Self::Error>> {
        core::hint::black_box(Some(unknown()))
    }
}
