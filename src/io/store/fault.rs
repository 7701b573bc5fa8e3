//! Faults of a slot and of both, and reasons for which a calibration is not stored.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::authentication::Permission;
use super::layout::{FORMAT_VERSION, MAX_BODY_WORDS, OLDEST_FORMAT};
use super::origin::OriginError;
use crate::flight::calibration_id::SerialNumber;
use crate::flight::camera::FrameError;
use crate::flight::grid_memory::GridMemoryError;
use crate::geometry::calibration::CalibrationError;
use crate::geometry::grid::{GridCarrier, GridError};

/// The reason why a slot has no calibration that this camera can use.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SlotFault {
    /// Its commit word is blank: nothing was stored, or a store was cut before its end.
    Blank,
    /// A word cannot be read: its ECC has found an error.
    Unreadable {
        /// Index of the word in the slot.
        word: u16,
    },
    /// It does not begin as a record.
    NoRecord,
    /// The commit word has another CRC-32 than it says.
    CommitCrc {
        /// CRC-32 in the word.
        stored: u32,
        /// CRC-32 of its other bytes.
        computed: u32,
    },
    /// The record is of another version of the format.
    Format(u16),
    /// No body has so many words.
    Length(u16),
    /// The body has another CRC-32 than the commit word says.
    Crc {
        /// CRC-32 in the commit word.
        stored: u32,
        /// CRC-32 of the body.
        computed: u32,
    },
    /// The body is not laid out as one of this version.
    Contents,
    /// The firmware has no key by which it knows signatures.
    NoKey,
    /// Its signature is not that of the key.
    WrongSignature,
    /// The calibration is not usable.
    Calibration(CalibrationError),
    /// It is the calibration of another camera.
    OtherCamera(SerialNumber),
    /// It has residual grids, and the camera has no memory for them.
    NoGridMemory,
    /// The file of a residual grid is none.
    Grid {
        /// Part as whose grid it is stored.
        carrier: GridCarrier,
        /// The reason.
        error: GridError,
    },
    /// The residual grids are not those that the parameters state, or do not fit the camera.
    Grids(GridMemoryError),
    /// The probe point has no frame.
    Frame(FrameError),
    /// The probe point is corrected to other bits than were stored: this firmware computes
    /// otherwise than the one that stored it.
    ProbePoint {
        /// x', y', dx and dy that were stored, bits.
        stored: [u32; 4],
        /// The same as they are computed now.
        computed: [u32; 4],
    },
}

impl fmt::Display for SlotFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Blank => f.write_str("blank"),
            Self::Unreadable { word } => write!(f, "word {word} cannot be read"),
            Self::NoRecord => f.write_str("does not begin as a record"),
            Self::CommitCrc { stored, computed } => write!(
                f,
                "the commit word has CRC-32 {computed:08x} and states {stored:08x}"
            ),
            Self::Format(version) => write!(
                f,
                "the record has format {version}; this firmware reads {OLDEST_FORMAT} to {FORMAT_VERSION}"
            ),
            Self::Length(words) => write!(
                f,
                "a body of {words} words is not among 1 to {MAX_BODY_WORDS}"
            ),
            Self::Crc { stored, computed } => write!(
                f,
                "the body has CRC-32 {computed:08x}, the commit word states {stored:08x}"
            ),
            Self::Contents => f.write_str("the body is not one of this format"),
            Self::NoKey => f.write_str("the firmware has no key that verifies signatures"),
            Self::WrongSignature => f.write_str("the signature is not that of the camera's key"),
            Self::Calibration(error) => write!(f, "the calibration is not usable: {error}"),
            Self::OtherCamera(serial) => {
                write!(f, "the calibration is of another camera, serial {serial}")
            }
            Self::NoGridMemory => f.write_str("the camera has no memory for its residual grids"),
            Self::Grid { carrier, error } => write!(f, "residual grid of the {carrier}: {error}"),
            Self::Grids(error) => error.fmt(f),
            Self::Frame(error) => write!(f, "the probe point has no frame: {error}"),
            Self::ProbePoint { stored, computed } => write!(
                f,
                "the probe point is corrected to bits {computed:08x?}, stored are {stored:08x?}"
            ),
        }
    }
}

impl core::error::Error for SlotFault {}

/// Neither slot has a calibration that this camera can use.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NothingStored {
    /// Fault of either slot.
    pub slots: [SlotFault; 2],
}

impl NothingStored {
    /// Returns `true` for a store that was never written.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.slots == [SlotFault::Blank; 2]
    }
}

impl fmt::Display for NothingStored {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = &self.slots;
        write!(
            f,
            "no calibration is stored: first slot: {first}; second slot: {second}"
        )
    }
}

impl core::error::Error for NothingStored {}

/// Step of a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreStep {
    /// Erasure of the slot.
    Erase,
    /// Write of the word with this index in the slot.
    Write {
        /// Index of the word.
        word: u16,
    },
    /// Comparison of this word, which reads otherwise than it was written, or cannot be read.
    Compare {
        /// Index of the word.
        word: u16,
    },
}

/// The reason why a calibration is not stored. All but [`NotStored::Flash`] leave the flash as it
/// was.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotStored {
    /// The calibration is not usable.
    Calibration(CalibrationError),
    /// The origin is none.
    Origin(OriginError),
    /// The calibration is of another camera.
    OtherCamera {
        /// Serial number of this camera, or of the calibration that is stored.
        camera: SerialNumber,
    },
    /// It is not signed: it may be used until the next start, and is not stored.
    Unsigned,
    /// The firmware has no key by which it knows signatures.
    NoKey,
    /// It has no serial number, so that its signature would hold for every camera.
    NoSerial,
    /// The signature is not that of the camera's key, or is one of another calibration, origin or
    /// permission.
    WrongSignature,
    /// Its version is not higher than all that were stored, and it has no permission.
    VersionNotRisen {
        /// Highest version that was stored.
        highest: u32,
    },
    /// Its permission names another calibration than the one that is stored now.
    OtherPermission {
        /// The store that a permission has to name; `None` if nothing is stored.
        newest: Option<Permission>,
    },
    /// Its residual grids are not in use.
    Grids(GridMemoryError),
    /// It has residual grids, and the camera has no memory for them.
    NoGridMemory,
    /// Its probe point has no frame.
    Frame(FrameError),
    /// It is longer than a slot.
    TooLong,
    /// The flash does not do what it is told: it is worn or locked. What a start finds depends on
    /// the step:
    ///
    /// - erasure, and words of the body: the calibration before; the one before that if the newest
    ///   had no seal, since that is written over;
    /// - word 0, the commit word: the calibration before or the new one, perhaps not the same at
    ///   every start;
    /// - word 1, which stands for all seals: the new one, without a seal.
    Flash {
        /// Slot that was to be written, 0 or 1.
        slot: u8,
        /// Step that failed.
        step: StoreStep,
    },
}

impl fmt::Display for NotStored {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Calibration(error) => write!(f, "the calibration is not usable: {error}"),
            Self::Origin(error) => error.fmt(f),
            Self::OtherCamera { camera } => {
                write!(
                    f,
                    "the calibration is of another camera than serial {camera}"
                )
            }
            Self::Unsigned => f.write_str("it is not signed"),
            Self::NoKey => f.write_str("the firmware has no key that verifies signatures"),
            Self::NoSerial => f.write_str("it has no serial number: it is signed for no camera"),
            Self::WrongSignature => f.write_str(
                "the signature is not that of the camera's key, or is one of something else",
            ),
            Self::VersionNotRisen { highest } => write!(
                f,
                "its version is not higher than {highest}, which has been stored, and it has no \
                 permission"
            ),
            Self::OtherPermission {
                newest: Some(newest),
            } => write!(f, "its permission is not for what is stored now: {newest}"),
            Self::OtherPermission { newest: None } => {
                f.write_str("it has a permission, and nothing is stored")
            }
            Self::Grids(error) => error.fmt(f),
            Self::NoGridMemory => f.write_str("the camera has no memory for residual grids"),
            Self::Frame(error) => write!(f, "the probe point has no frame: {error}"),
            Self::TooLong => f.write_str("it is longer than a slot"),
            Self::Flash { slot, step } => {
                write!(f, "the flash of slot {slot} ")?;
                match step {
                    StoreStep::Erase => f.write_str("is not erased"),
                    StoreStep::Write { word } => write!(f, "does not take word {word}"),
                    StoreStep::Compare { word } => {
                        write!(f, "reads word {word} otherwise than it was written")
                    }
                }
            }
        }
    }
}

impl core::error::Error for NotStored {}
