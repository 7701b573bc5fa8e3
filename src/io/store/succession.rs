//! Succession of calibrations: which may follow the one that is stored.

use super::authentication::{Authentication, Permission, Signature};
use super::commit::Commit;
use super::fault::NotStored;
use super::judgement::Record;
use crate::flight::calibration_id::SerialNumber;
use crate::io::link::digest;

/// The newest record that is signed, whether the camera can use it or not: the calibration that a
/// store follows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Newest {
    pub(super) serial: SerialNumber,
    /// Number of its store and CRC-32 of its calibration: what a permission has to name.
    permission: Permission,
    signature: Signature,
    /// Highest version that was ever stored.
    highest: u32,
}

impl Newest {
    pub(super) fn of(commit: &Commit, record: &Record) -> Self {
        Self {
            serial: record.parameters.serial,
            permission: Permission {
                store: commit.sequence,
                crc: digest::of_camera(&record.parameters),
            },
            signature: record.head.authentication.signature,
            highest: record.head.highest,
        }
    }
}

/// Returns the highest version that will have been stored, if a calibration may follow: one of a
/// higher version than all before, the newest itself, or one with a permission that names the
/// newest.
///
/// # Errors
/// [`NotStored::OtherPermission`], and [`NotStored::VersionNotRisen`] without a permission.
pub(super) fn check(
    newest: Option<&Newest>,
    version: u32,
    authentication: &Authentication,
) -> Result<u32, NotStored> {
    let permission = authentication.permission;
    let Some(newest) = newest else {
        return match permission {
            None => Ok(version),
            Some(_) => Err(NotStored::OtherPermission { newest: None }),
        };
    };
    let highest = newest.highest;
    // A signature is that of one statement.
    if authentication.signature == newest.signature {
        return Ok(highest);
    }
    match permission {
        Some(permission) if permission == newest.permission => Ok(highest.max(version)),
        Some(_) => Err(NotStored::OtherPermission {
            newest: Some(newest.permission),
        }),
        None if version > highest => Ok(version),
        None => Err(NotStored::VersionNotRisen { highest }),
    }
}
