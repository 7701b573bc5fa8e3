//! Statement that a laboratory signs.

use heapless::Vec;

use super::authentication::Permission;
use super::layout::{ORIGIN_BYTES, PERMISSION_BYTES};
use super::origin::Origin;
use crate::flight::camera::CameraParameters;
use crate::io::link::CALIBRATION_CAPACITY;
use crate::io::link::loading::Upload;

/// First bytes of every statement: a signature of other bytes by the same key, such as that of a
/// certificate, is none of a calibration.
const TAG: &[u8] = b"fmc-camera: calibration to be stored, 1\n";

/// Most bytes in front of the grids: tag, permission, origin, two lengths of grids, parameters.
const HEAD_CAPACITY: usize =
    TAG.len() + PERMISSION_BYTES + ORIGIN_BYTES + 2 * 3 + (2 + CALIBRATION_CAPACITY);

/// Statement that a laboratory signs: that this calibration is to be stored.
///
/// # Model
/// `fmc-camera: calibration to be stored, 1` and a line feed, 40 bytes; then as `postcard` writes
/// them: the permission ([`Option`] of [`Permission`]), the origin (lens, laboratory, date), the
/// lengths of the files of both grids (u16, lens and sensor; 0 without), and the camera's
/// parameters with their length, serial number and version among them, as the link carries them
/// ([`Upload::bytes`]); then the files of both grids, byte for byte.
///
/// Everything that is stored is a part of it but the probe point, which the camera itself computes.
#[derive(Debug, Clone)]
pub struct Statement<'a> {
    head: Vec<u8, HEAD_CAPACITY>,
    files: [&'a [u8]; 2],
}

impl<'a> Statement<'a> {
    /// Returns the statement of a calibration with the files of the grids of lens and sensor,
    /// empty without; `None` only if it were longer than a calibration can be.
    #[must_use]
    pub fn of(
        parameters: &CameraParameters,
        origin: &Origin,
        permission: Option<Permission>,
        files: [&'a [u8]; 2],
    ) -> Option<Self> {
        let upload = Upload::of(parameters)?;
        Self::of_bytes(upload.bytes(), origin, permission, files)
    }

    /// Returns the same with the bytes of the parameters.
    pub(super) fn of_bytes(
        camera: &[u8],
        origin: &Origin,
        permission: Option<Permission>,
        files: [&'a [u8]; 2],
    ) -> Option<Self> {
        let [lens, sensor] = files.map(|file| u16::try_from(file.len()));
        let lengths = [lens.ok()?, sensor.ok()?];
        let mut buffer = [0; HEAD_CAPACITY];
        let fields = (permission, origin, lengths, camera);
        let fields = postcard::to_slice(&fields, &mut buffer).ok()?;
        let mut head = Vec::from_slice(TAG).ok()?;
        head.extend_from_slice(fields).ok()?;
        Some(Self { head, files })
    }

    /// The bytes, in three pieces, one behind the other.
    #[must_use]
    pub fn pieces(&self) -> [&[u8]; 3] {
        let [lens, sensor] = self.files;
        [&self.head, lens, sensor]
    }
}

#[cfg(test)]
mod tests {
    use super::super::origin::{LABORATORY_BYTES, LENS_BYTES};
    use super::*;

    #[test]
    fn longest_statement_has_its_place() {
        let [lens, laboratory] = [LENS_BYTES, LABORATORY_BYTES].map(|bytes| "x".repeat(bytes));
        let origin = Origin::new(&lens, &laboratory, "2026-05-17").unwrap();
        let permission = Permission {
            store: u32::MAX,
            crc: u32::MAX,
        };
        let camera = [0xff; CALIBRATION_CAPACITY];
        let file = std::vec![0; usize::from(u16::MAX)];
        let statement = Statement::of_bytes(&camera, &origin, Some(permission), [&file; 2]);
        let statement = statement.unwrap();
        assert_eq!(
            statement.head.len(),
            HEAD_CAPACITY,
            "no byte is reserved in vain"
        );
        assert_eq!(statement.pieces()[1..], [&file[..]; 2]);
    }
}
