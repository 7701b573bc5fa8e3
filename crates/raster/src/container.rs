//! Directories and values of classic and big TIFF.
//!
//! The crate `tiff` skips entries of unknown type and hides where a value lies; both are named here
//! before anything is allocated. TIFF 6.0 section 2; BigTIFF as libtiff documents it.

use std::collections::BTreeMap;
use std::sync::Arc;

use tiff::tags::ByteOrder;

use crate::read_error::ReadError;
use crate::source::Source;
use crate::tag::Tag;

/// Tags of a directory, with their values.
pub(crate) type Entries = BTreeMap<Tag, Value>;

/// Largest length of the values of all tags that are kept in memory.
pub(crate) const TAGS_LIMIT_BYTES: u64 = 64 << 20;
/// Largest number of directories in a chain.
const DIRECTORY_LIMIT: usize = 1024;
/// Largest number of entries of all directories in a chain.
const ENTRY_LIMIT: usize = 1 << 18;

/// A TIFF file: its byte order, the size of its offsets and its first directory.
#[derive(Clone)]
pub(crate) struct Container {
    pub(crate) source: Arc<dyn Source>,
    pub(crate) byte_order: ByteOrder,
    pub(crate) big: bool,
    pub(crate) file_bytes: u64,
    first: u64,
}

/// A directory: its entries in the file's order, and the offset of the next one (0: none).
#[derive(Clone, Debug)]
pub(crate) struct Directory {
    pub(crate) entries: Vec<Entry>,
    next: u64,
}

/// An entry of a directory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub(crate) tag: Tag,
    pub(crate) value_type: u16,
    pub(crate) count: u64,
    /// The value where it is short, or its offset.
    field: [u8; 8],
}

/// A tag's value: its type, and its bytes in the machine's order.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Value {
    /// Number of the type (TIFF 6.0, page 15).
    pub value_type: u16,
    /// Bytes of all values, numbers in the machine's order.
    pub bytes: Vec<u8>,
}

impl Directory {
    /// Returns the entry of a tag; of two, the first.
    pub(crate) fn find(&self, tag: Tag) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.tag == tag)
    }
}

impl Value {
    /// Returns the unsigned numbers of the value, unless its type is another.
    #[must_use]
    pub fn unsigned(&self) -> Option<Vec<u64>> {
        let numbers = match self.value_type {
            1 => self.bytes.iter().map(|byte| u64::from(*byte)).collect(),
            3 => numbers(&self.bytes, |bytes| u64::from(u16::from_ne_bytes(bytes))),
            4 | 13 => numbers(&self.bytes, |bytes| u64::from(u32::from_ne_bytes(bytes))),
            16 | 18 => numbers(&self.bytes, u64::from_ne_bytes),
            _ => return None,
        };
        Some(numbers)
    }
}

fn numbers<const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> u64) -> Vec<u64> {
    let chunks = bytes.as_chunks::<N>().0;
    chunks.iter().map(|bytes| number(*bytes)).collect()
}

/// Returns the bytes of one value of a type, and of each number in it.
fn type_bytes(value_type: u16) -> Option<(u64, usize)> {
    match value_type {
        1 | 2 | 6 | 7 => Some((1, 1)),
        3 | 8 => Some((2, 2)),
        4 | 9 | 11 | 13 => Some((4, 4)),
        5 | 10 => Some((8, 4)),
        12 | 16 | 17 | 18 => Some((8, 8)),
        _ => None,
    }
}

impl Container {
    /// Reads the first bytes of a file.
    pub(crate) fn open(source: Arc<dyn Source>) -> Result<Self, ReadError> {
        let doing = "read";
        let file_bytes = source
            .length()
            .map_err(|source| ReadError::Io { doing, source })?;
        if file_bytes == 0 {
            return Err(ReadError::Empty);
        }
        let mut start = [0; 16];
        let length = start.len().min(usize::try_from(file_bytes).unwrap_or(16));
        let mut container = Self {
            source,
            byte_order: ByteOrder::LittleEndian,
            big: false,
            file_bytes,
            first: 0,
        };
        container.bytes_at(0, start.get_mut(..length).unwrap_or_default())?;
        let not_tiff = || ReadError::NotTiff {
            start: start.iter().take(length.min(4)).copied().collect(),
        };
        container.byte_order = match &start {
            [b'I', b'I', ..] => ByteOrder::LittleEndian,
            [b'M', b'M', ..] => ByteOrder::BigEndian,
            _ => return Err(not_tiff()),
        };
        let [_, _, v0, v1, rest @ ..] = start;
        container.big = match container.u16([v0, v1]) {
            42 => false,
            43 => true,
            _ => return Err(not_tiff()),
        };
        container.first = if container.big {
            let [s0, s1, z0, z1, offset @ ..] = rest;
            if length < 16 || container.u16([s0, s1]) != 8 || container.u16([z0, z1]) != 0 {
                return Err(not_tiff());
            }
            container.u64(offset)
        } else {
            let [o0, o1, o2, o3, ..] = rest;
            if length < 8 {
                return Err(not_tiff());
            }
            u64::from(container.u32([o0, o1, o2, o3]))
        };
        Ok(container)
    }

    /// Reads all directories of the chain.
    pub(crate) fn directories(&self) -> Result<Vec<Directory>, ReadError> {
        let (mut offset, mut offsets) = (self.first, Vec::new());
        let mut directories = Vec::new();
        let mut entries = 0;
        loop {
            if offsets.contains(&offset) || offsets.len() >= DIRECTORY_LIMIT {
                let limit = DIRECTORY_LIMIT;
                return Err(ReadError::DirectoryCycle { offset, limit });
            }
            offsets.push(offset);
            let directory = self.directory(offset, format!("page {}", offsets.len()))?;
            entries += directory.entries.len();
            if entries > ENTRY_LIMIT {
                return Err(ReadError::TooManyEntries { limit: ENTRY_LIMIT });
            }
            offset = directory.next;
            directories.push(directory);
            if offset == 0 {
                return Ok(directories);
            }
        }
    }

    /// Reads a directory at an offset; `name` is for the error.
    pub(crate) fn directory(&self, offset: u64, name: String) -> Result<Directory, ReadError> {
        let file_bytes = self.file_bytes;
        let (count_bytes, entry_bytes, next_bytes): (u64, u64, u64) =
            if self.big { (8, 20, 8) } else { (2, 12, 4) };
        if offset < 8 || offset.saturating_add(count_bytes) > file_bytes {
            return Err(ReadError::DirectoryBeyondFile {
                name,
                offset,
                file_bytes,
            });
        }
        let start = self.array::<8>(offset, count_bytes)?;
        let [c0, c1, ..] = start;
        let entries = if self.big {
            self.u64(start)
        } else {
            u64::from(self.u16([c0, c1]))
        };
        let length = entries
            .saturating_mul(entry_bytes)
            .saturating_add(next_bytes);
        let first = offset + count_bytes;
        if entries > 65_535 || first.saturating_add(length) > file_bytes {
            return Err(ReadError::DirectoryTruncated {
                offset,
                entries,
                file_bytes,
            });
        }
        let mut directory = Directory {
            entries: Vec::new(),
            next: 0,
        };
        for entry in 0..entries {
            let bytes = self.array::<20>(first + entry * entry_bytes, entry_bytes)?;
            directory.entries.push(self.entry(bytes));
        }
        let next = self.array::<8>(first + entries * entry_bytes, next_bytes)?;
        directory.next = self.offset(next);
        Ok(directory)
    }

    fn entry(&self, bytes: [u8; 20]) -> Entry {
        let [t0, t1, y0, y1, c0, c1, c2, c3, rest @ ..] = bytes;
        let (count, field) = if self.big {
            let [c4, c5, c6, c7, field @ ..] = rest;
            (self.u64([c0, c1, c2, c3, c4, c5, c6, c7]), field)
        } else {
            let [f0, f1, f2, f3, ..] = rest;
            let count = u64::from(self.u32([c0, c1, c2, c3]));
            (count, [f0, f1, f2, f3, 0, 0, 0, 0])
        };
        Entry {
            tag: Tag(self.u16([t0, t1])),
            value_type: self.u16([y0, y1]),
            count,
            field,
        }
    }

    /// Returns the offset of a value and its length, or nothing where its type is unknown; a value
    /// of a few bytes stands in its entry, and has no offset.
    pub(crate) fn place(&self, entry: &Entry) -> Result<Option<(Option<u64>, u64)>, ReadError> {
        let Some((bytes_each, _)) = type_bytes(entry.value_type) else {
            return Ok(None);
        };
        let bytes = entry.count.saturating_mul(bytes_each);
        let inline = if self.big { 8 } else { 4 };
        if bytes <= inline {
            return Ok(Some((None, bytes)));
        }
        let offset = self.offset(entry.field);
        if offset.saturating_add(bytes) > self.file_bytes {
            return Err(ReadError::ValueBeyondFile {
                tag: entry.tag,
                offset,
                bytes,
                file_bytes: self.file_bytes,
            });
        }
        Ok(Some((Some(offset), bytes)))
    }

    /// Reads the value of an entry, or nothing where its type is unknown.
    pub(crate) fn value(&self, entry: &Entry) -> Result<Option<Value>, ReadError> {
        let Some((offset, bytes)) = self.place(entry)? else {
            return Ok(None);
        };
        let tag = entry.tag;
        let limit = TAGS_LIMIT_BYTES;
        let length = usize::try_from(bytes).ok().filter(|_| bytes <= limit);
        let length = length.ok_or(ReadError::TagsTooLong { tag, bytes, limit })?;
        let mut value = if let Some(offset) = offset {
            let mut value = vec![0; length];
            self.bytes_at(offset, &mut value)?;
            value
        } else {
            entry.field.iter().take(length).copied().collect()
        };
        let number_bytes = type_bytes(entry.value_type).map_or(1, |(_, bytes)| bytes);
        if self.byte_order != ByteOrder::native() && number_bytes > 1 {
            for number in value.chunks_exact_mut(number_bytes) {
                number.reverse();
            }
        }
        Ok(Some(Value {
            value_type: entry.value_type,
            bytes: value,
        }))
    }

    /// Returns up to `N` bytes of the file; those above `length` are 0.
    fn array<const N: usize>(&self, offset: u64, length: u64) -> Result<[u8; N], ReadError> {
        let mut bytes = [0; N];
        let length = usize::try_from(length).unwrap_or(N).min(N);
        self.bytes_at(offset, bytes.get_mut(..length).unwrap_or_default())?;
        Ok(bytes)
    }

    /// Fills a buffer with the bytes at an offset.
    fn bytes_at(&self, mut offset: u64, mut bytes: &mut [u8]) -> Result<(), ReadError> {
        while !bytes.is_empty() {
            let read = self.source.read_at(offset, bytes);
            let read = match read {
                Ok(0) => Err(std::io::ErrorKind::UnexpectedEof.into()),
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                other => other,
            };
            let doing = "read";
            let read = read.map_err(|source| ReadError::Io { doing, source })?;
            offset += read as u64;
            bytes = bytes.get_mut(read..).unwrap_or_default();
        }
        Ok(())
    }

    fn offset(&self, field: [u8; 8]) -> u64 {
        let [o0, o1, o2, o3, ..] = field;
        if self.big {
            self.u64(field)
        } else {
            u64::from(self.u32([o0, o1, o2, o3]))
        }
    }

    fn u16(&self, bytes: [u8; 2]) -> u16 {
        match self.byte_order {
            ByteOrder::LittleEndian => u16::from_le_bytes(bytes),
            ByteOrder::BigEndian => u16::from_be_bytes(bytes),
        }
    }

    fn u32(&self, bytes: [u8; 4]) -> u32 {
        match self.byte_order {
            ByteOrder::LittleEndian => u32::from_le_bytes(bytes),
            ByteOrder::BigEndian => u32::from_be_bytes(bytes),
        }
    }

    fn u64(&self, bytes: [u8; 8]) -> u64 {
        match self.byte_order {
            ByteOrder::LittleEndian => u64::from_le_bytes(bytes),
            ByteOrder::BigEndian => u64::from_be_bytes(bytes),
        }
    }
}
