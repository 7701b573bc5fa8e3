//! The identity of a calibration, as the reports write it.

use fmc_camera::flight::calibration_id::CalibrationId;
use serde::Serialize;

/// Which calibration; what the camera file does not give is `None`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CalibrationIdentity {
    /// Serial number of the camera.
    pub serial: Option<String>,
    /// Version of the calibration.
    pub version: Option<u32>,
    /// CRC-32 of its numbers, in hexadecimal digits.
    pub crc32: String,
    /// Place in which the camera keeps it.
    pub storage: &'static str,
}

impl CalibrationIdentity {
    /// Returns the identity as text and numbers.
    #[must_use]
    pub fn of(id: &CalibrationId) -> Self {
        Self {
            serial: (!id.serial.is_empty()).then(|| id.serial.to_string()),
            version: (id.version != 0).then_some(id.version),
            crc32: format!("{:08x}", id.crc),
            storage: id.storage.name(),
        }
    }
}
