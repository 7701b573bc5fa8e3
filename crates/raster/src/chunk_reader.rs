//! Bytes of one strip or tile, decoded.

use std::io::{self, BufRead, BufReader, Cursor, Read};

use weezl::{BitOrder, LzwStatus};
use zlib_rs::{Inflate, InflateFlush, Status};
use zstd::bulk::Decompressor;
use zstd::zstd_safe::get_frame_content_size;

use crate::header::Compression;
use crate::source::Segment;

/// Bytes that are read at once.
const BUFFER_BYTES: usize = 128 << 10;
/// The same for uncompressed rows that are longer, which are read past the buffer.
const SHORT_BUFFER_BYTES: usize = 8 << 10;
/// Chunks of zstd up to this size are decoded at once, which needs no window.
pub(crate) const AT_ONCE_BYTES: u64 = 16 << 20;
/// Largest window of a longer chunk of zstd, as a power of 2: 64 MiB, more than level 20 takes.
const WINDOW_LOG: u32 = 26;

/// Message of zlib for another checksum than that of the bytes.
const WRONG_CHECKSUM: &str = "incorrect data check";

/// Lengths of a strip or tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChunkBytes {
    /// In the file.
    pub(crate) compressed: u64,
    /// Decoded.
    pub(crate) decoded: u64,
    /// Of a decoded row.
    pub(crate) row: usize,
    /// The chunk is decoded row by row, however short it is.
    pub(crate) streams: bool,
}

/// Decoder of one strip or tile. Every codec streams, so that a strip may be longer than memory.
pub(crate) enum ChunkReader {
    Stored(BufReader<Segment>),
    PackBits(PackBits),
    Lzw(Lzw),
    Deflate(Inflated),
    Zstd(zstd::stream::read::Decoder<'static, BufReader<Segment>>),
    Decoded(Cursor<Vec<u8>>),
}

impl ChunkReader {
    /// Opens a chunk of a frame.
    pub(crate) fn open(
        compression: Compression,
        mut segment: Segment,
        lengths: ChunkBytes,
        at_once: &mut AtOnce,
    ) -> io::Result<Self> {
        let ChunkBytes {
            compressed: compressed_bytes,
            decoded: decoded_bytes,
            row,
            streams,
        } = lengths;
        let is_short = !streams && decoded_bytes.max(compressed_bytes) <= AT_ONCE_BYTES;
        if compression == Compression::Zstd && is_short {
            let decoded = at_once.decode(&mut segment, compressed_bytes, decoded_bytes)?;
            return Ok(Self::Decoded(Cursor::new(decoded)));
        }
        let length = usize::try_from(compressed_bytes).unwrap_or(usize::MAX);
        let capacity = if compression == Compression::None && row > SHORT_BUFFER_BYTES {
            SHORT_BUFFER_BYTES
        } else {
            BUFFER_BYTES
        };
        let reader = BufReader::with_capacity(capacity.min(length), segment);
        Ok(match compression {
            Compression::None => Self::Stored(reader),
            Compression::PackBits => Self::PackBits(PackBits::new(reader)),
            Compression::Lzw => Self::Lzw(Lzw::new(reader)),
            Compression::Deflate => Self::Deflate(Inflated::new(reader)),
            Compression::Zstd => {
                let mut decoder = zstd::stream::read::Decoder::with_buffer(reader)?;
                decoder.window_log_max(WINDOW_LOG)?;
                Self::Zstd(decoder)
            }
        })
    }

    /// Gives the memory of a chunk that was decoded at once to the next one.
    pub(crate) fn recycle(self, at_once: &mut AtOnce) {
        if let Self::Decoded(cursor) = self {
            at_once.spare.push(cursor.into_inner());
        }
    }

    /// Reads the end of the chunk, where the codec compares a checksum.
    pub(crate) fn finish(&mut self) -> io::Result<()> {
        if let Self::Deflate(_) | Self::Zstd(_) = self {
            self.read(&mut [0]).map_err(|error| match error.kind() {
                io::ErrorKind::UnexpectedEof => {
                    invalid("the checksum behind its rows is cut off or missing")
                }
                _ => error,
            })?;
        }
        Ok(())
    }
}

fn invalid(fault: &'static str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, fault)
}

impl Read for ChunkReader {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Stored(reader) => reader.read(bytes),
            Self::PackBits(reader) => reader.read(bytes),
            Self::Lzw(reader) => reader.read(bytes),
            Self::Deflate(reader) => reader.read(bytes),
            Self::Zstd(reader) => reader.read(bytes),
            Self::Decoded(reader) => reader.read(bytes),
        }
    }
}

/// Memory of the chunks that are decoded at once. Fresh memory for each would cost as much as the
/// decoding.
#[derive(Default)]
pub(crate) struct AtOnce {
    decompressor: Option<Decompressor<'static>>,
    compressed: Vec<u8>,
    spare: Vec<Vec<u8>>,
}

impl AtOnce {
    fn decode(
        &mut self,
        segment: &mut Segment,
        compressed_bytes: u64,
        decoded_bytes: u64,
    ) -> io::Result<Vec<u8>> {
        let length = |bytes| usize::try_from(bytes).unwrap_or(usize::MAX);
        self.compressed.resize(length(compressed_bytes), 0);
        segment.read_exact(&mut self.compressed)?;
        // A last strip may have been filled up to the rows of the others.
        let stated = get_frame_content_size(&self.compressed).ok().flatten();
        let stated = stated.filter(|bytes| *bytes <= AT_ONCE_BYTES);
        let mut decoded = self.spare.pop().unwrap_or_default();
        decoded.resize(
            length(stated.map_or(decoded_bytes, |bytes| bytes.max(decoded_bytes))),
            0,
        );
        let decompressor = match &mut self.decompressor {
            Some(decompressor) => decompressor,
            none => none.insert(Decompressor::new()?),
        };
        let count = decompressor.decompress_to_buffer(&self.compressed, &mut *decoded)?;
        decoded.truncate(count);
        Ok(decoded)
    }
}

/// Deflate with the header and the checksum of zlib.
pub(crate) struct Inflated {
    reader: BufReader<Segment>,
    inflate: Inflate,
    done: bool,
}

impl Inflated {
    fn new(reader: BufReader<Segment>) -> Self {
        Self {
            reader,
            inflate: Inflate::new(true, 15),
            done: false,
        }
    }
}

impl Read for Inflated {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while !self.done && !bytes.is_empty() {
            let input = self.reader.fill_buf()?;
            let is_end = input.is_empty();
            let (before_in, before_out) = (self.inflate.total_in(), self.inflate.total_out());
            let status = self.inflate.decompress(input, bytes, InflateFlush::NoFlush);
            let since = |before, now| usize::try_from(now - before).unwrap_or(usize::MAX);
            let consumed = since(before_in, self.inflate.total_in());
            let produced = since(before_out, self.inflate.total_out());
            self.reader.consume(consumed);
            let status = status.map_err(|error| {
                let fault = self.inflate.error_message().unwrap_or(error.as_str());
                invalid(if fault == WRONG_CHECKSUM {
                    "the checksum behind its rows is not that of its bytes"
                } else {
                    fault
                })
            })?;
            self.done = status == Status::StreamEnd;
            if produced > 0 {
                return Ok(produced);
            }
            if is_end && !self.done {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
        }
        Ok(0)
    }
}

/// LZW of TIFF (most significant bit first, codes lengthen one early).
pub(crate) struct Lzw {
    reader: BufReader<Segment>,
    decoder: weezl::decode::Decoder,
    done: bool,
}

impl Lzw {
    fn new(reader: BufReader<Segment>) -> Self {
        let settings = weezl::decode::Configuration::with_tiff_size_switch(BitOrder::Msb, 8)
            .with_yield_on_full_buffer(true);
        Self {
            reader,
            decoder: settings.build(),
            done: false,
        }
    }
}

impl Read for Lzw {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while !self.done && !bytes.is_empty() {
            let result = self.decoder.decode_bytes(self.reader.fill_buf()?, bytes);
            self.reader.consume(result.consumed_in);
            match result.status {
                // Codes that were buffered decode into bytes with NoProgress, too.
                Ok(LzwStatus::Ok | LzwStatus::NoProgress) if result.consumed_out > 0 => {
                    return Ok(result.consumed_out);
                }
                Ok(LzwStatus::Ok) => {}
                Ok(LzwStatus::Done | LzwStatus::NoProgress) => {
                    self.done = true;
                    return Ok(result.consumed_out);
                }
                Err(error) => return Err(io::Error::new(io::ErrorKind::InvalidData, error)),
            }
        }
        Ok(0)
    }
}

/// Runs of bytes (TIFF 6.0, section 9).
pub(crate) struct PackBits {
    reader: BufReader<Segment>,
    /// Bytes of the run that are left: copies of one byte, or bytes of the file.
    left: usize,
    repeated: Option<u8>,
}

impl PackBits {
    fn new(reader: BufReader<Segment>) -> Self {
        Self {
            reader,
            left: 0,
            repeated: None,
        }
    }

    fn byte(&mut self) -> io::Result<u8> {
        let mut byte = [0];
        self.reader.read_exact(&mut byte)?;
        let [byte] = byte;
        Ok(byte)
    }
}

impl Read for PackBits {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while self.left == 0 {
            if self.reader.fill_buf()?.is_empty() {
                return Ok(0);
            }
            match self.byte()? {
                literal @ 0..=127 => {
                    (self.left, self.repeated) = (usize::from(literal) + 1, None);
                }
                128 => {}
                repeat => {
                    self.left = 257 - usize::from(repeat);
                    self.repeated = Some(self.byte()?);
                }
            }
        }
        let count = self.left.min(bytes.len());
        let bytes = bytes.get_mut(..count).unwrap_or_default();
        let read = if let Some(byte) = self.repeated {
            bytes.fill(byte);
            count
        } else {
            self.reader.read(bytes)?
        };
        self.left -= read;
        Ok(read)
    }
}
