//! Hashes of files and calibrations.

use crc::{CRC_32_ISO_HDLC, Crc};
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera_file::CameraFile;
use sha2::{Digest, Sha256};

/// Returns the SHA-256 of bytes, in hexadecimal digits.
pub(super) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect::<Vec<_>>()
        .concat()
}

/// Returns the CRC-32 that the frame records of a camera with this file carry, in hexadecimal
/// digits: of its parameters as the link sends them, for a flight with the default settings.
pub(super) fn crc32(camera: &CameraFile) -> String {
    let parameters = camera.flown(&FlightSettings::default());
    // Numbers have a fixed length, so that writing them to memory cannot fail.
    let bytes = postcard::to_allocvec(&parameters).unwrap_or_default();
    format!("{:08x}", Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hash_of_nothing_is_the_known_one() {
        let expected = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        assert_eq!(sha256(b""), expected);
    }
}
