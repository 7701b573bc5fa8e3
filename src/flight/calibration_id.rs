//! Identity of a calibration: its camera, its version and its numbers.

use core::fmt;

/// Identity of a calibration.
///
/// Two calibrations with the same [`Self::crc`] have the same numbers, serial number and version;
/// the CRC does not cover the place in which they are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CalibrationId {
    /// Serial number of the camera, as its certificate states it.
    pub serial: SerialNumber,
    /// Version of the calibration; 0: none is given.
    pub version: u32,
    /// CRC-32 (ISO-HDLC) of the camera's parameters as `postcard` writes them, serial number and
    /// version among them.
    pub crc: u32,
    /// Place in which it is kept.
    pub storage: Storage,
}

impl fmt::Display for CalibrationId {
    /// `serial 5282, version 3, CRC-32 deadbeef, volatile`, without what is not given.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.serial.is_empty() {
            write!(f, "serial {}, ", self.serial)?;
        }
        if self.version != 0 {
            write!(f, "version {}, ", self.version)?;
        }
        write!(f, "CRC-32 {:08x}, {}", self.crc, self.storage.name())
    }
}

/// Place in which a calibration is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Storage {
    /// In memory alone: gone with the supply, or at the next restart while the camera is not
    /// prepared.
    Volatile,
    /// In the board's own store, from which its firmware loads it at the start.
    Stored,
}

impl Storage {
    /// The name in documents and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Volatile => "volatile",
            Self::Stored => "stored",
        }
    }
}

/// The serial number of a camera: up to [`SerialNumber::CAPACITY`] printable ASCII characters, none
/// where it is not known.
#[derive(Clone, Copy, PartialEq, Eq, Default)]
pub struct SerialNumber {
    /// The characters, then zeros, which are no characters of a serial number.
    ascii: [u8; Self::CAPACITY],
}

impl SerialNumber {
    /// Most characters.
    pub const CAPACITY: usize = 16;

    /// No serial number.
    pub const EMPTY: Self = Self {
        ascii: [0; Self::CAPACITY],
    };

    /// The serial number of these characters.
    ///
    /// # Errors
    /// [`SerialError`] for a text that is too long, or has characters other than `' '` to `'~'`.
    ///
    /// # Examples
    /// ```
    /// use fmc_camera::flight::calibration_id::{SerialError, SerialNumber};
    ///
    /// assert_eq!(SerialNumber::new("RC30-5282").unwrap().as_str(), "RC30-5282");
    /// assert_eq!(SerialNumber::new("Nº 7"), Err(SerialError::NotPrintable { index: 1 }));
    /// ```
    pub fn new(text: &str) -> Result<Self, SerialError> {
        Self::from_bytes(text.as_bytes())
    }

    /// The serial number of these bytes, which need not be a text.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SerialError> {
        let mut ascii = [0; Self::CAPACITY];
        for (index, byte) in bytes.iter().enumerate() {
            if !is_printable(*byte) {
                return Err(SerialError::NotPrintable { index });
            }
            if let Some(place) = ascii.get_mut(index) {
                *place = *byte;
            }
        }
        if bytes.len() > Self::CAPACITY {
            let length = bytes.len();
            return Err(SerialError::TooLong { length });
        }
        Ok(Self { ascii })
    }

    /// The characters, then zeros.
    #[must_use]
    pub const fn padded(&self) -> &[u8; Self::CAPACITY] {
        &self.ascii
    }

    /// The characters.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let characters = self.ascii.split(|byte| *byte == 0).next();
        // Of ASCII characters alone: they are a text.
        core::str::from_utf8(characters.unwrap_or_default()).unwrap_or_default()
    }

    /// Returns `true` if no serial number is given.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        matches!(self.ascii, [0, ..])
    }
}

impl fmt::Debug for SerialNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl fmt::Display for SerialNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for SerialNumber {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{=str}", self.as_str());
    }
}

/// Written as a text for people, and as all its bytes for `postcard`, so that the camera needs no
/// code that reads texts.
#[cfg(feature = "serde")]
impl serde::Serialize for SerialNumber {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if serializer.is_human_readable() {
            serializer.serialize_str(self.as_str())
        } else {
            self.ascii.serialize(serializer)
        }
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for SerialNumber {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        use serde::de::Error as _;
        if deserializer.is_human_readable() {
            let text = heapless::String::<{ Self::CAPACITY }>::deserialize(deserializer)?;
            return Self::new(&text).map_err(D::Error::custom);
        }
        let ascii = <[u8; Self::CAPACITY]>::deserialize(deserializer)?;
        // Zeros come after all characters.
        let mut rest = ascii.iter().skip_while(|byte| is_printable(**byte));
        if rest.all(|byte| *byte == 0) {
            Ok(Self { ascii })
        } else {
            Err(D::Error::custom("not a serial number"))
        }
    }
}

/// Returns `true` if a byte is a character of a serial number.
const fn is_printable(byte: u8) -> bool {
    matches!(byte, b' '..=b'~')
}

/// The reason why a text is not a serial number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SerialError {
    /// It has more characters than [`SerialNumber::CAPACITY`].
    TooLong {
        /// Number of them.
        length: usize,
    },
    /// A character is not printable ASCII.
    NotPrintable {
        /// Its index, bytes.
        index: usize,
    },
}

impl fmt::Display for SerialError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { length } => write!(
                f,
                "has {length} characters; up to {} are allowed",
                SerialNumber::CAPACITY
            ),
            Self::NotPrintable { index } => write!(
                f,
                "holds other than printable ASCII, ' ' to '~', at byte {index}"
            ),
        }
    }
}

impl core::error::Error for SerialError {}

#[cfg(test)]
mod tests {
    use std::string::ToString as _;

    use super::*;

    #[test]
    fn serial_number_holds_sixteen_printable_characters() {
        for text in ["", "5282", "0123456789abcdef", "~ !"] {
            let serial = SerialNumber::new(text).unwrap();
            assert_eq!(serial.as_str(), text);
            assert_eq!(serial.is_empty(), text.is_empty());
        }
        assert_eq!(SerialNumber::default(), SerialNumber::EMPTY);
        let refused = |text| SerialNumber::new(text).unwrap_err();
        let long = refused("0123456789abcdefg");
        assert_eq!(long, SerialError::TooLong { length: 17 });
        assert_eq!(long.to_string(), "has 17 characters; up to 16 are allowed");
        for (text, index) in [("a\0", 1), ("\n", 0), ("12\u{7f}", 2), ("µ", 0)] {
            assert_eq!(refused(text), SerialError::NotPrintable { index });
        }
    }

    #[test]
    fn identity_is_shown_without_what_is_not_given() {
        let mut id = CalibrationId {
            serial: SerialNumber::EMPTY,
            version: 0,
            crc: 0xbeef,
            storage: Storage::Volatile,
        };
        assert_eq!(id.to_string(), "CRC-32 0000beef, volatile");
        id.serial = SerialNumber::new("5282").unwrap();
        id.version = 3;
        id.storage = Storage::Stored;
        assert_eq!(
            id.to_string(),
            "serial 5282, version 3, CRC-32 0000beef, stored"
        );
    }

    #[cfg(feature = "link")]
    #[test]
    fn serial_number_that_is_none_is_not_read() {
        let read = |bytes: &[u8; 16]| postcard::from_bytes::<SerialNumber>(bytes);
        assert_eq!(
            read(b"0123456789abcdef").unwrap().as_str(),
            "0123456789abcdef"
        );
        assert_eq!(read(&[0; 16]).unwrap(), SerialNumber::EMPTY);
        for wrong in [
            b"012\n\0\0\0\0\0\0\0\0\0\0\0\0",
            b"012\x005\0\0\0\0\0\0\0\0\0\0\0",
        ] {
            assert!(read(wrong).is_err(), "{wrong:?}");
        }
        let serial = SerialNumber::new("RC30-5282").unwrap();
        let mut buffer = [0; 16];
        let bytes = postcard::to_slice(&serial, &mut buffer).unwrap();
        assert_eq!(postcard::from_bytes(bytes), Ok(serial));
    }

    #[cfg(feature = "serde")]
    #[test]
    fn serial_number_is_a_text_for_people() {
        let serial = SerialNumber::new("RC30-5282").unwrap();
        assert_eq!(serde_json::to_string(&serial).unwrap(), "\"RC30-5282\"");
        let read = |text: &str| serde_json::from_str::<SerialNumber>(text);
        assert_eq!(read("\"RC30-5282\"").unwrap(), serial);
        let refused = [
            ("\"0123456789abcdefg\"", ""),
            ("\"12\\u007f\"", "printable ASCII"),
            ("5282", ""),
        ];
        for (wrong, reason) in refused {
            let error = read(wrong).unwrap_err().to_string();
            assert!(error.contains(reason), "{wrong}: {error}");
        }
    }
}
