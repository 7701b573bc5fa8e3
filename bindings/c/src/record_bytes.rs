//! Record of a trigger as bytes: those that the link carries.

use fmc::flight::frame_record::FrameRecord;
use fmc::io::link::digest;

use crate::error::{fmc_error, fmc_status};
use crate::frame_record::fmc_record;
use crate::memory::{self, Extent};
use crate::refusal::{Failure, Refusal};
use crate::{FMC_ERROR_BYTES, FMC_ERROR_CRC};

/// Most bytes of a record.
pub const FMC_RECORD_CAPACITY: usize = 256;

/// Writes a record as bytes, and returns their number and CRC-32. Up to `FMC_RECORD_CAPACITY` are
/// needed.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
/// `capacity` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_record_to_bytes(
    record: *const fmc_record,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
    crc32: *mut u32,
    error: *mut fmc_error,
) -> fmc_status {
    let written = || {
        // SAFETY: the caller's promise; all fields are valid with all bits.
        let held = unsafe { memory::structure(record, 1) }?.record()?;
        let number = memory::output(count, 4)?;
        let sum = memory::output(crc32, 5)?;
        let extent = Extent::of(bytes, capacity, 2);
        memory::bytes_apart(Extent::of(record, 1, 1), extent, count, crc32)?;
        // SAFETY: the caller's promise.
        let place = unsafe { memory::elements_mut(bytes, capacity, 2) }?;
        let mut buffer = [0; FMC_RECORD_CAPACITY];
        let refused = || Refusal::from(Failure::of_argument(FMC_ERROR_BYTES, 1));
        let written = postcard::to_slice(&held, &mut buffer).map_err(|_| refused())?;
        let crc = digest::of_frame_record(&held).ok_or_else(refused)?;
        let place = memory::part_of(place, written.len(), 2)?;
        for (place, byte) in place.iter_mut().zip(written.iter()) {
            *place = *byte;
        }
        // SAFETY: the caller's promise.
        unsafe { number.write(written.len()) };
        // SAFETY: the caller's promise.
        unsafe { sum.write(crc) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(written(), error) }
}

/// Reads a record from its bytes, whose CRC-32 is `crc32`. After a refusal the record is as before.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
/// `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_record_from_bytes(
    record: *mut fmc_record,
    bytes: *const u8,
    count: usize,
    crc32: u32,
    error: *mut fmc_error,
) -> fmc_status {
    let read = || {
        let place = memory::output(record, 1)?;
        // SAFETY: the caller's promise.
        let bytes = unsafe { memory::elements(bytes, count, 2) }?;
        let refused = || Refusal::from(Failure::of_argument(FMC_ERROR_BYTES, 2));
        let (read, rest) =
            postcard::take_from_bytes::<FrameRecord>(bytes).map_err(|_| refused())?;
        if !rest.is_empty() {
            return Err(refused());
        }
        let found = digest::of_frame_record(&read).ok_or_else(refused)?;
        if found != crc32 {
            return Err(Failure::of_argument(FMC_ERROR_CRC, 2)
                .numbers(found, crc32)
                .into());
        }
        // SAFETY: the caller's promise.
        unsafe { place.write((&read).into()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(read(), error) }
}
