//! Reasons why a TIFF is not read.

use std::io;

use crate::tag::Tag;

/// The reason why a TIFF is not read: the field, its value and what is allowed.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system did not deliver bytes.
    #[error("{doing}: {source}")]
    Io {
        /// The action.
        doing: &'static str,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The path names a folder.
    #[error("a folder, not a TIFF file")]
    Folder,
    /// The file has no bytes.
    #[error("the file is empty; a TIFF has at least 8 bytes")]
    Empty,
    /// The first bytes are not those of a TIFF.
    #[error(
        "not a TIFF: it begins with the bytes {start:02x?}, a TIFF with II 42, MM 42, II 43 or MM 43"
    )]
    NotTiff {
        /// The first bytes.
        start: Vec<u8>,
    },
    /// A directory begins behind the end of the file.
    #[error("directory of {name} begins at byte {offset}, the file has {file_bytes} bytes")]
    DirectoryBeyondFile {
        /// The page, or the tag that points to it.
        name: String,
        /// Offset of the directory.
        offset: u64,
        /// Length of the file.
        file_bytes: u64,
    },
    /// A directory ends behind the end of the file.
    #[error(
        "directory at byte {offset} is cut off: it has {entries} entries, the file {file_bytes} bytes"
    )]
    DirectoryTruncated {
        /// Offset of the directory.
        offset: u64,
        /// Number of entries.
        entries: u64,
        /// Length of the file.
        file_bytes: u64,
    },
    /// The directories form a circle, or there are too many.
    #[error("directory at byte {offset} comes twice, or is behind {limit} others")]
    DirectoryCycle {
        /// Offset of the directory.
        offset: u64,
        /// Largest number of directories.
        limit: usize,
    },
    /// The directories have too many entries.
    #[error("the directories have more than {limit} entries; allowed: {limit}")]
    TooManyEntries {
        /// Largest number of all of them.
        limit: usize,
    },
    /// Too many strips or tiles.
    #[error("{chunks} strips or tiles; allowed: {limit}")]
    TooManyChunks {
        /// Their number.
        chunks: u64,
        /// Largest number.
        limit: u64,
    },
    /// A value lies behind the end of the file.
    #[error("{tag}: {bytes} bytes at byte {offset}, the file has {file_bytes} bytes")]
    ValueBeyondFile {
        /// The tag.
        tag: Tag,
        /// Offset of the value.
        offset: u64,
        /// Length of the value.
        bytes: u64,
        /// Length of the file.
        file_bytes: u64,
    },
    /// A value, or all values together, are longer than is read.
    #[error("{tag}: with {bytes} bytes the tags are longer than {limit} bytes together")]
    TagsTooLong {
        /// The tag.
        tag: Tag,
        /// Length of its value.
        bytes: u64,
        /// Largest length of all values.
        limit: u64,
    },
    /// No page of full resolution.
    #[error("none of {pages} pages is an image of full resolution (NewSubfileType 0)")]
    NoFullPage {
        /// Number of pages.
        pages: usize,
    },
    /// A tag that a frame must have is missing.
    #[error("{tag} is missing")]
    Missing {
        /// The tag.
        tag: Tag,
    },
    /// A tag has another number of values, or values of another type.
    #[error("{tag} has {count} values of type {value_type}; allowed: {allowed}")]
    Shape {
        /// The tag.
        tag: Tag,
        /// Number of values.
        count: u64,
        /// Number of the type.
        value_type: u16,
        /// The values that are allowed.
        allowed: String,
    },
    /// A tag has a value that is not read.
    #[error("{tag} = {value}; allowed: {allowed}")]
    Value {
        /// The tag.
        tag: Tag,
        /// The value.
        value: u64,
        /// The values that are allowed.
        allowed: &'static str,
    },
    /// Two tags contradict each other.
    #[error("{tag} = {value} does not fit {other} = {other_value}; allowed: {allowed}")]
    Pair {
        /// A tag.
        tag: Tag,
        /// Its value.
        value: u64,
        /// The other tag.
        other: Tag,
        /// Its value.
        other_value: u64,
        /// The values that are allowed.
        allowed: &'static str,
    },
    /// A row of tiles has more bytes than is decoded at once.
    #[error("a row of tiles has {bytes} bytes decoded; allowed: {limit} bytes")]
    TilesTooLarge {
        /// Bytes of a row of tiles.
        bytes: u64,
        /// Largest number.
        limit: u64,
    },
    /// A strip or tile is absent.
    #[error("{tag}: chunk {index} is absent (offset {offset}, {bytes} bytes)")]
    ChunkAbsent {
        /// The tag of its length.
        tag: Tag,
        /// Number of the strip or tile, from 0 on.
        index: usize,
        /// Its offset.
        offset: u64,
        /// Its length.
        bytes: u64,
    },
    /// A strip or tile lies behind the end of the file.
    #[error(
        "{tag}: chunk {index} has {bytes} bytes at byte {offset}, the file has {file_bytes} bytes"
    )]
    ChunkBeyondFile {
        /// The tag of its length.
        tag: Tag,
        /// Number of the strip or tile, from 0 on.
        index: usize,
        /// Its offset.
        offset: u64,
        /// Its length.
        bytes: u64,
        /// Length of the file.
        file_bytes: u64,
    },
    /// A strip or tile has fewer bytes than its pixels need.
    #[error("{tag}: chunk {index} has {bytes} bytes; its pixels need at least {needed}")]
    ChunkTooShort {
        /// The tag of its length.
        tag: Tag,
        /// Number of the strip or tile, from 0 on.
        index: usize,
        /// Its length.
        bytes: u64,
        /// Bytes that its pixels need at least.
        needed: u64,
    },
    /// A strip or tile cannot be decoded.
    #[error("chunk {index}, from row {row} on: {reason}")]
    Chunk {
        /// Number of the strip or tile, from 0 on.
        index: usize,
        /// First row that was being decoded.
        row: u32,
        /// The codec's error.
        reason: String,
    },
    /// The buffer of rows is of other samples than the file.
    #[error("BitsPerSample (258) = {bits}, read as {asked} bits")]
    SampleType {
        /// Bits of the file.
        bits: u16,
        /// Bits of the buffer.
        asked: u16,
    },
}
