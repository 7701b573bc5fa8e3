//! Hashes of files and calibrations.

use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::link::digest;
use fmc_camera_file::CameraFile;
use sha2::{Digest, Sha256};

/// Returns the SHA-256 of bytes, in hexadecimal digits.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    digits(&Sha256::digest(bytes))
}

/// Returns bytes in hexadecimal digits.
#[must_use]
pub fn digits(bytes: &[u8]) -> String {
    let pairs = bytes.iter().map(|byte| format!("{byte:02x}"));
    pairs.collect::<Vec<_>>().concat()
}

/// Returns the CRC-32 that the frame records of a camera with this file carry, in hexadecimal
/// digits: of its parameters as the link sends them, for a flight with the default settings.
#[must_use]
pub fn crc32(camera: &CameraFile) -> String {
    let parameters = camera.flown(&FlightSettings::default());
    let crc = digest::of_camera(&parameters);
    format!("{crc:08x}")
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
