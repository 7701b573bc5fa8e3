//! Calibration as bytes: those of the link and of a board's store.

use fmc::flight::camera::CameraParameters;
use fmc::io::link::loading::{self, Upload};
use fmc::io::link::{CALIBRATION_CAPACITY, MAX_PART};

use crate::camera::{self, fmc_camera};
use crate::camera_record::fmc_camera_record;
use crate::code::{self, fmc_code};
use crate::error::{fmc_error, fmc_status};
use crate::memory::{self, Extent};
use crate::refusal::{Failure, Refusal};
use crate::{FMC_ERROR_BYTES, FMC_ERROR_CRC, FMC_ERROR_GRIDS};

/// Most bytes of a calibration.
pub const FMC_BLOB_CAPACITY: usize = 336;

const _: () = assert!(FMC_BLOB_CAPACITY == CALIBRATION_CAPACITY);

/// Validates the bytes of a calibration and puts the camera into storage. The bytes are those that
/// the link loads and `fmc_camera_record_to_blob` writes, `crc32` is their CRC-32, `storage` where
/// they are kept. After a refusal the storage is as before.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
/// `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_camera_init_from_blob(
    camera: *mut fmc_camera,
    bytes: *const u8,
    count: usize,
    crc32: u32,
    storage: fmc_code,
    error: *mut fmc_error,
) -> fmc_status {
    let initialised = || {
        memory::room(camera, 1)?;
        // SAFETY: the caller's promise.
        let bytes = unsafe { memory::elements(bytes, count, 2) }?;
        let parameters = read(bytes, crc32)?;
        // SAFETY: the caller's promise; `room` has accepted the storage.
        unsafe { camera::put(camera, &parameters, code::storage(storage)?) }
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(initialised(), error) }
}

/// Writes the bytes of a camera's record, and returns their number and CRC-32. Up to
/// `FMC_BLOB_CAPACITY` are needed.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
/// `capacity` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_camera_record_to_blob(
    record: *const fmc_camera_record,
    bytes: *mut u8,
    capacity: usize,
    count: *mut usize,
    crc32: *mut u32,
    error: *mut fmc_error,
) -> fmc_status {
    let written = || {
        // SAFETY: the caller's promise.
        let parameters = unsafe { memory::input(record, 1) }?.parameters()?;
        let number = memory::output(count, 4)?;
        let sum = memory::output(crc32, 5)?;
        let extent = Extent::of(bytes, capacity, 2);
        memory::bytes_apart(Extent::of(record, 1, 1), extent, count, crc32)?;
        // SAFETY: the caller's promise.
        let place = unsafe { memory::elements_mut(bytes, capacity, 2) }?;
        let upload = Upload::of(&parameters).ok_or(Failure::new(FMC_ERROR_BYTES))?;
        let length = upload.parts(MAX_PART).map(|part| part.bytes.len()).sum();
        let mut rest = memory::part_of(place, length, 2)?;
        for part in upload.parts(MAX_PART) {
            let halves = rest.split_at_mut_checked(part.bytes.len());
            let (piece, behind) = halves.unwrap_or_default();
            for (place, byte) in piece.iter_mut().zip(&part.bytes) {
                *place = *byte;
            }
            rest = behind;
        }
        // SAFETY: the caller's promise.
        unsafe { number.write(length) };
        // SAFETY: the caller's promise.
        unsafe { sum.write(upload.crc()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(written(), error) }
}

/// Returns the parameters that bytes make, if they have this CRC-32.
fn read(bytes: &[u8], crc32: u32) -> Result<CameraParameters, Refusal> {
    let refused = || Refusal::from(Failure::of_argument(FMC_ERROR_BYTES, 2));
    if bytes.len() > FMC_BLOB_CAPACITY {
        return Err(refused());
    }
    let (mut parameters, rest) =
        postcard::take_from_bytes::<CameraParameters>(bytes).map_err(|_| refused())?;
    if !rest.is_empty() {
        let whole = loading::parameters(bytes).filter(|whole| whole.grids.is_empty());
        parameters = whole.ok_or(Failure::of_argument(FMC_ERROR_GRIDS, 2))?;
    }
    // Parameters have one form, so that their CRC-32 is that of the bytes.
    let found = Upload::of(&parameters).ok_or_else(refused)?.crc();
    if found != crc32 {
        return Err(Failure::of_argument(FMC_ERROR_CRC, 2)
            .numbers(found, crc32)
            .into());
    }
    Ok(parameters)
}
