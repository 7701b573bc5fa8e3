//! The camera: validated, in storage of the caller.

use core::ffi::c_char;

use fmc::flight::calibration_id::{self, CalibrationId};
use fmc::flight::camera::{Camera, CameraParameters};
use fmc::geometry::focus_table::FocusTable;
use fmc::geometry::grid::GridChecksums;
use fmc::io::link::digest;

use crate::camera_record::fmc_camera_record;
use crate::code;
use crate::error::{fmc_error, fmc_status};
use crate::memory::{self, Storage};
use crate::refusal::{Failure, Refusal};
use crate::version::checked;
use crate::{FMC_ERROR_UNINITIALISED, FMC_SERIAL_LENGTH};

/// Words of a camera.
pub const FMC_CAMERA_WORDS: usize = 66;

/// A validated camera, in storage of the caller; it may be copied.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_camera {
    /// Words of the library alone.
    pub opaque: [u64; FMC_CAMERA_WORDS],
}

impl Storage for fmc_camera {
    type Object = Camera;
    const LETTERS: [u8; 4] = *b"camr";
}

/// Identity of a calibration.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct fmc_calibration_id {
    /// Serial number, filled with zeros; without a zero at the end if it fills the field.
    pub serial: [c_char; FMC_SERIAL_LENGTH],
    /// Version of the calibration; 0: none is given.
    pub calibration_version: u32,
    /// CRC-32 of all numbers, serial number and version.
    pub crc32: u32,
    /// `FMC_VOLATILE` or `FMC_STORED`.
    pub storage: code::fmc_code,
}

impl From<&CalibrationId> for fmc_calibration_id {
    fn from(id: &CalibrationId) -> Self {
        let mut serial: [c_char; FMC_SERIAL_LENGTH] = [0; FMC_SERIAL_LENGTH];
        for (place, byte) in serial.iter_mut().zip(id.serial.as_str().bytes()) {
            *place = c_char::from_ne_bytes([byte]);
        }
        Self {
            serial,
            calibration_version: id.version,
            crc32: id.crc,
            storage: code::code_of_storage(id.storage),
        }
    }
}

/// Fills a record with the defaults of a camera file. `size` is that of the structure, `version` is
/// `FMC_CAMERA_VERSION`. Principal distance, sides and pixel remain to be filled.
///
/// # Safety
/// Unless it is NULL or misaligned, `record` is to `size` bytes of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_camera_record_defaults(
    record: *mut fmc_camera_record,
    size: u32,
    version: u32,
    error: *mut fmc_error,
) -> fmc_status {
    let filled = || {
        checked([size, version], size_of::<fmc_camera_record>(), 2)?;
        let place = memory::output(record, 1)?;
        // SAFETY: the caller's promise.
        unsafe { place.write(fmc_camera_record::DEFAULT) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(filled(), error) }
}

/// Validates a record and puts the camera into storage. After a refusal the storage is as before.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_camera_init(
    camera: *mut fmc_camera,
    record: *const fmc_camera_record,
    error: *mut fmc_error,
) -> fmc_status {
    let initialised = || {
        memory::room(camera, 1)?;
        // SAFETY: the caller's promise.
        let record = unsafe { memory::input(record, 2) }?;
        let storage = code::storage(record.storage)?;
        let mut parameters = record.parameters()?;
        // A record has neither; said here, the compiler knows.
        (parameters.grids, parameters.focus) = (GridChecksums::NONE, FocusTable::NONE);
        // SAFETY: the caller's promise; `room` has accepted the storage.
        unsafe { put(camera, &parameters, storage) }
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(initialised(), error) }
}

/// Returns the identity of a camera's calibration: frames of cameras with the same CRC-32 are
/// exchangeable.
///
/// # Safety
/// Unless they are NULL or misaligned, the pointers are to objects of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_camera_id(
    camera: *const fmc_camera,
    id: *mut fmc_calibration_id,
    error: *mut fmc_error,
) -> fmc_status {
    let answered = || {
        // SAFETY: the caller's promise.
        let camera = unsafe { memory::object(camera, 1) }?;
        let place = memory::output(id, 2)?;
        let id = camera
            .id()
            .ok_or(Failure::of_argument(FMC_ERROR_UNINITIALISED, 1))?;
        // SAFETY: the caller's promise.
        unsafe { place.write((&id).into()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(answered(), error) }
}

/// Puts the camera of parameters, with its identity, into storage.
///
/// # Errors
/// The refusal of the parameters.
///
/// # Safety
/// As of [`memory::put`].
#[expect(
    clippy::inline_always,
    reason = "a program whose cameras come from records is without grids and focus table"
)]
#[inline(always)]
pub(crate) unsafe fn put(
    camera: *mut fmc_camera,
    parameters: &CameraParameters,
    storage: calibration_id::Storage,
) -> Result<(), Refusal> {
    let crc = digest::of_camera(parameters);
    match Camera::identified(parameters, crc, storage) {
        Ok(made) => {
            // SAFETY: the caller's promise.
            unsafe { memory::put(camera, crc, made) };
            Ok(())
        }
        Err(error) => Err(error.into()),
    }
}

/// CRC-32 of a camera's calibration, by which frames and meshes know their camera.
pub(crate) fn stamp(camera: &Camera) -> u32 {
    camera.id().map_or(0, |id| id.crc)
}
