//! Frames as TIFF files: read and written by rows with bounded memory, with all their metadata.
//!
//! A [`FrameReader`] delivers the rows of a frame in order, whatever its container, byte order,
//! strips or tiles, planes and compression. A [`FramePlan`] lays out the output as the input, but
//! for what is asked; a [`ChunkEncoder`] turns rows into strips or tiles, and a [`TiffFile`] takes
//! them with the tags. Reader and encoder are `Send`: decoding, what happens to the rows, and
//! encoding may run on threads of their own.
//!
//! Directories, tags and offsets are written by the crate `tiff`. They are read here, because it
//! skips entries of unknown type and hides where a value lies, which is to be named. Pixels are
//! decoded by zlib-rs, weezl and zstd, row by row: the decoder of `tiff` wants a whole strip in
//! memory, leaves out the fourth sample of RGB that is not named as alpha, inverts white-is-zero,
//! and fails on LZW whose strings are longer than a row.
//!
//! # Examples
//! A frame is copied to tiles with Deflate:
//! ```
//! use std::io::Cursor;
//! use std::sync::Arc;
//!
//! use fmc_raster::{
//!     ChunkEncoder, Chunks, Compression, FramePlan, FrameReader, Header, PixelCrc, PlanOptions,
//!     TagOptions, TiffFile,
//! };
//!
//! # fn input() -> Vec<u8> {
//! #     let mut bytes = Cursor::new(Vec::new());
//! #     let mut encoder = tiff::encoder::TiffEncoder::new(&mut bytes).unwrap();
//! #     let samples: Vec<u16> = (0..40 * 30 * 3).collect();
//! #     encoder.write_image::<tiff::encoder::colortype::RGB16>(40, 30, &samples).unwrap();
//! #     bytes.into_inner()
//! # }
//! let mut reader = FrameReader::new(Arc::new(input()))?;
//! let header: Header = reader.header().clone();
//! let options = PlanOptions {
//!     compression: Some(Compression::Deflate),
//!     chunks: Some(Chunks::Tiles { width_px: 16, height_px: 16 }),
//!     big: false,
//! };
//! let plan = FramePlan::new(&header, [header.width_px, header.height_px], &options)?;
//! let tags = reader.metadata().output(&TagOptions { keep_georeference: true, camera: None });
//! let plan = plan.with_bytes_beside(tags.bound_bytes());
//! let mut out = Cursor::new(Vec::new());
//! let mut file = TiffFile::new(&mut out, &plan)?;
//! let mut frame = file.frame(&plan, &tags)?;
//! let mut encoder = ChunkEncoder::new(&plan)?;
//! let mut crc = PixelCrc::default();
//! let mut rows = vec![0_u16; 8 * header.row_samples()];
//! loop {
//!     let count = reader.read_rows(&mut rows)?;
//!     if count == 0 {
//!         break;
//!     }
//!     let rows = &rows[..count as usize * header.row_samples()];
//!     crc.update(rows);
//!     encoder.encode(rows, &mut |piece| frame.write(piece))?;
//! }
//! frame.finish()?;
//! # drop(file);
//!
//! let mut copy = FrameReader::new(Arc::new(out.into_inner()))?;
//! let mut rows = vec![0_u16; 30 * header.row_samples()];
//! assert_eq!(copy.read_rows(&mut rows)?, 30);
//! let mut copied = PixelCrc::default();
//! copied.update(&rows);
//! assert_eq!(copied.value(), crc.value());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod chunk_encoder;
mod chunk_reader;
mod chunk_table;
mod container;
mod description_crc;
mod frame_plan;
mod frame_reader;
mod header;
mod mask;
mod metadata;
mod output_tags;
mod pixel_crc;
mod read_error;
mod sample;
mod source;
mod tag;
mod tag_rule;
mod tiff_file;
mod write_error;
mod xmp;

pub use chunk_encoder::{ChunkEncoder, Piece};
pub use container::Value;
pub use frame_plan::{
    CHUNK_LIMIT_BYTES, CLASSIC_LIMIT_BYTES, FramePlan, PlanError, PlanOptions, SHORT_STRIP_ROWS,
    TILE_ROW_LIMIT_BYTES,
};
pub use frame_reader::{FrameReader, TILES_HELD_BYTES};
pub use header::{ByteOrder, Chunks, Compression, Header};
pub use mask::Mask;
pub use metadata::{Dropped, Metadata};
pub use output_tags::{OutputTags, TagOptions};
pub use pixel_crc::PixelCrc;
pub use read_error::ReadError;
pub use sample::Sample;
pub use source::Source;
pub use tag::Tag;
pub use tiff_file::{FrameWriter, TiffFile};
pub use write_error::WriteError;
pub use xmp::RectifiedCamera;
