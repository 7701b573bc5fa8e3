//! The header of an array of NumPy (`.npy`): type, order and shape, in the versions 1.0, 2.0 and
//! 3.0 of the format.
//!
//! <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>

mod dictionary;
mod structure;

use std::io::{self, ErrorKind, Read, Write};

pub use dictionary::DictionaryError;
pub use structure::{Field, fields};

const MAGIC: [u8; 6] = *b"\x93NUMPY";

/// Length of the longest header, bytes: the largest of version 1.0. NumPy reads 10,000 unless told
/// otherwise.
const LONGEST: u32 = 65_535;

/// The offset of the first number is a multiple of so many bytes.
const ALIGNMENT: usize = 64;

/// Content of the header of an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NpyHeader {
    /// The type of a number, as Python writes it: `'<f8'`, or the list of a structured type.
    pub description: String,
    /// `true` if columns are stored one behind the other, rather than rows.
    pub is_fortran_order: bool,
    /// Length of each axis.
    pub shape: Vec<u64>,
}

/// A reason why the header of a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum NpyHeaderError {
    /// The file has another format.
    #[error("it does not begin as one")]
    NoMagic,
    /// The version is not known here.
    #[error("version {major}.{minor} of the format is not known")]
    Version {
        /// Number before the point.
        major: u8,
        /// Number behind the point.
        minor: u8,
    },
    /// The file ends too early.
    #[error("it ends within its header")]
    Truncated,
    /// The header is longer than this program reads.
    #[error("its header has {0} bytes, more than {LONGEST}")]
    TooLong(u32),
    /// The text of a header of version 3.0 is not UTF-8.
    #[error("its header is not UTF-8 text")]
    NoUtf8,
    /// The dictionary in the header is wrong.
    #[error("its header is wrong: {0}")]
    Dictionary(#[from] DictionaryError),
    /// The file cannot be read.
    #[error(transparent)]
    Reading(io::Error),
}

impl NpyHeader {
    /// Reads the header, and nothing behind it.
    ///
    /// # Errors
    /// [`NpyHeaderError`] for a file that does not begin with a header.
    pub fn read(source: &mut impl Read) -> Result<Self, NpyHeaderError> {
        let magic = bytes(source).map_err(|error| match error {
            NpyHeaderError::Truncated => NpyHeaderError::NoMagic,
            error => error,
        })?;
        if magic != MAGIC {
            return Err(NpyHeaderError::NoMagic);
        }
        let [major, minor] = bytes(source)?;
        let length = match (major, minor) {
            (1, 0) => u16::from_le_bytes(bytes(source)?).into(),
            (2 | 3, 0) => u32::from_le_bytes(bytes(source)?),
            _ => return Err(NpyHeaderError::Version { major, minor }),
        };
        if length > LONGEST {
            return Err(NpyHeaderError::TooLong(length));
        }
        let mut text = Vec::new();
        let read = source.take(length.into()).read_to_end(&mut text);
        if read.map_err(NpyHeaderError::Reading)? < length as usize {
            return Err(NpyHeaderError::Truncated);
        }
        let text = if major == 3 {
            String::from_utf8(text).map_err(|_| NpyHeaderError::NoUtf8)?
        } else {
            // Latin-1: each byte is the code of its character.
            text.into_iter().map(char::from).collect()
        };
        Ok(dictionary::parse(&text)?)
    }

    /// Writes the header of an array in C order, in version 1.0; `number` is the type of a number,
    /// as `<f8`.
    ///
    /// # Errors
    /// Those of the writer, and [`ErrorKind::InvalidInput`] for a shape whose header would be too
    /// long.
    pub fn write(number: &str, shape: &[u64], sink: &mut dyn Write) -> io::Result<()> {
        Self::write_described(&format!("'{number}'"), shape, sink)
    }

    /// Writes the header of an array of any type, as Python writes it.
    ///
    /// # Errors
    /// As [`Self::write`].
    pub fn write_described(
        description: &str,
        shape: &[u64],
        sink: &mut dyn Write,
    ) -> io::Result<()> {
        let axes: Vec<String> = shape.iter().map(|length| format!("{length}, ")).collect();
        let axes = axes.concat();
        let dictionary =
            format!("{{'descr': {description}, 'fortran_order': False, 'shape': ({axes}), }}");
        // Version 1.0 has Latin-1 and a length of two bytes, 3.0 UTF-8 and four.
        let is_ascii = dictionary.is_ascii();
        let length_bytes = if is_ascii {
            size_of::<u16>()
        } else {
            size_of::<u32>()
        };
        let before = MAGIC.len() + 2 + length_bytes;
        // A line break ends the header.
        let end = (before + dictionary.len() + 1).next_multiple_of(ALIGNMENT);
        let length = u16::try_from(end - before)
            .map_err(|error| io::Error::new(ErrorKind::InvalidInput, error))?;
        sink.write_all(&MAGIC)?;
        if is_ascii {
            sink.write_all(&[1, 0])?;
            sink.write_all(&length.to_le_bytes())?;
        } else {
            sink.write_all(&[3, 0])?;
            sink.write_all(&u32::from(length).to_le_bytes())?;
        }
        let blanks = usize::from(length) - 1 - dictionary.len();
        writeln!(sink, "{dictionary}{:blanks$}", "")
    }
}

/// Returns a text of a file for a message: without control characters, and no longer than a line.
pub(super) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut shown = String::new();
    for character in text.chars().take(LONGEST) {
        if character.is_control() {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    if text.chars().nth(LONGEST).is_some() {
        shown.push('…');
    }
    shown
}

fn bytes<const COUNT: usize>(source: &mut impl Read) -> Result<[u8; COUNT], NpyHeaderError> {
    let mut bytes = [0; COUNT];
    source
        .read_exact(&mut bytes)
        .map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => NpyHeaderError::Truncated,
            _ => NpyHeaderError::Reading(error),
        })?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_of_a_file_is_a_line_without_control_characters() {
        assert_eq!(shown("'>f8' µ"), "'>f8' µ");
        assert_eq!(shown("\x1b[2J\n"), "\\u{1b}[2J\\n");
        assert_eq!(shown(&"x".repeat(60)), "x".repeat(60));
        assert_eq!(shown(&"x".repeat(4000)), "x".repeat(60) + "…");
    }

    /// Returns a file of a version, with that text as its header.
    fn file(version: [u8; 2], text: &[u8]) -> Vec<u8> {
        let mut file = MAGIC.to_vec();
        file.extend(version);
        if version[0] == 1 {
            file.extend(u16::try_from(text.len()).unwrap().to_le_bytes());
        } else {
            file.extend(u32::try_from(text.len()).unwrap().to_le_bytes());
        }
        file.extend(text);
        file
    }

    fn read(file: &[u8]) -> Result<NpyHeader, String> {
        NpyHeader::read(&mut &*file).map_err(|error| error.to_string())
    }

    const TEXT: &[u8] = b"{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }   \n";

    #[test]
    fn versions_1_to_3_are_read_up_to_the_first_number() {
        for version in [[1, 0], [2, 0], [3, 0]] {
            let mut file = file(version, TEXT);
            file.extend(b"rows");
            let mut rest = file.as_slice();
            let header = NpyHeader::read(&mut rest).unwrap();
            let expected = NpyHeader {
                description: "'<f8'".to_owned(),
                is_fortran_order: false,
                shape: vec![3, 2],
            };
            assert_eq!(header, expected);
            assert_eq!(rest, b"rows");
        }
    }

    #[test]
    fn headers_that_numpy_wrote_are_read() {
        // NumPy 2: numpy.save of zeros(2, dtype=[('x', '<f4'), ('ä', '<f8', (2,))]).
        let fields = "[('x', '<f4'), ('ä', '<f8', (2,))]";
        let text = format!("{{'descr': {fields}, 'fortran_order': False, 'shape': (2,), }}");
        let latin: Vec<u8> = text.chars().map(|c| u8::try_from(c).unwrap()).collect();
        for file in [file([1, 0], &latin), file([3, 0], text.as_bytes())] {
            assert_eq!(read(&file).unwrap().description, fields);
        }
        // numpy.save(float64(3)), numpy.save(asfortranarray(...)).
        let scalar = b"{'descr': '<f8', 'fortran_order': False, 'shape': (), }\n";
        assert!(read(&file([1, 0], scalar)).unwrap().shape.is_empty());
        let columns = b"{'descr': '<f8', 'fortran_order': True, 'shape': (3, 2), }\n";
        assert!(read(&file([1, 0], columns)).unwrap().is_fortran_order);
    }

    #[test]
    fn written_header_is_the_one_of_earlier_files_and_is_read_again() {
        let mut file = Vec::new();
        NpyHeader::write("<f4", &[1_000_000, 4], &mut file).unwrap();
        let mut expected = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        expected.extend(b"{'descr': '<f4', 'fortran_order': False, 'shape': (1000000, 4, ), }");
        expected.resize(127, b' ');
        expected.push(b'\n');
        assert_eq!(file, expected);
        for shape in [
            &[][..],
            &[0],
            &[u64::MAX, 4],
            &[u64::MAX; 3],
            &[u64::MAX; 100],
        ] {
            let mut file = Vec::new();
            NpyHeader::write("<f8", shape, &mut file).unwrap();
            assert_eq!(file.len() % ALIGNMENT, 0);
            assert_eq!(read(&file).unwrap().shape, shape);
        }
        let error = NpyHeader::write("<f8", &vec![u64::MAX; 4000], &mut Vec::new()).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidInput);
    }

    #[test]
    fn what_is_cut_off_or_no_array_is_refused() {
        let whole = file([1, 0], TEXT);
        for length in 0..whole.len() {
            let expected = if length < MAGIC.len() {
                "it does not begin as one"
            } else {
                "it ends within its header"
            };
            assert_eq!(read(&whole[..length]).unwrap_err(), expected, "{length}");
        }
        let mut other = whole.clone();
        other[5] = b'y';
        assert_eq!(read(&other).unwrap_err(), "it does not begin as one");
        for version in [[0, 0], [1, 1], [4, 0]] {
            let refused = read(&file(version, TEXT)).unwrap_err();
            let [major, minor] = version;
            assert_eq!(
                refused,
                format!("version {major}.{minor} of the format is not known")
            );
        }
        assert_eq!(
            read(&file([3, 0], b"{'\xe4': 1}")).unwrap_err(),
            "its header is not UTF-8 text"
        );
    }

    #[test]
    fn huge_header_is_refused_before_memory_is_taken() {
        let mut huge = file([2, 0], TEXT);
        huge[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        let refused = read(&huge).unwrap_err();
        assert!(refused.contains("4294967295 bytes"), "{refused}");
        let longest = usize::try_from(LONGEST).unwrap();
        let padded = [TEXT, &vec![b' '; longest - TEXT.len()]].concat();
        read(&file([2, 0], &padded)).unwrap();
        read(&file([2, 0], &[&padded[..], b" "].concat())).unwrap_err();
    }

    #[test]
    fn source_that_fails_is_not_taken_for_a_wrong_file() {
        struct Failing;
        impl Read for Failing {
            fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
                Err(io::Error::other("disk"))
            }
        }
        for length in [0, 6, 8, 12] {
            let start = file([1, 0], TEXT);
            let mut source = start[..length].chain(Failing);
            let error = NpyHeader::read(&mut source).unwrap_err();
            assert!(matches!(error, NpyHeaderError::Reading(_)), "{error}");
        }
    }
}
