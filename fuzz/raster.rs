//! Fuzz target of frames in TIFF files, and its property. A test of the crate runs the same
//! function.

use std::io::Cursor;
use std::sync::Arc;

use fmc_raster::{
    ChunkEncoder, Chunks, Compression, FramePlan, FrameReader, PixelCrc, PlanOptions, ReadError,
    RectifiedCamera, Sample, TagOptions, TiffFile,
};

/// Frames of more samples are not read: time is better spent on others.
const LARGEST_SAMPLES: usize = 1 << 22;

/// Reads any bytes as a frame: whatever is read without an error is written in another layout and
/// read again, with the same pixels and no tag dropped a second time.
///
/// Returns whether all rows were read.
pub(crate) fn raster(bytes: &[u8]) -> bool {
    let Ok(mut reader) = FrameReader::new(Arc::new(bytes.to_vec())) else {
        return false;
    };
    let header = reader.header().clone();
    let rows = usize::try_from(header.height_px).unwrap();
    if header.row_samples().saturating_mul(rows) > LARGEST_SAMPLES {
        return false;
    }
    if header.bits == 8 {
        copied::<u8>(&mut reader)
    } else {
        copied::<u16>(&mut reader)
    }
}

fn copied<S: Sample>(reader: &mut FrameReader) -> bool {
    let header = reader.header().clone();
    let Ok(pixels) = all_rows::<S>(reader) else {
        return false;
    };
    let options = PlanOptions {
        compression: Some(Compression::Zstd),
        chunks: Some(Chunks::Tiles {
            width_px: 32,
            height_px: 16,
        }),
        big: false,
    };
    let plan = FramePlan::new(&header, [header.width_px, header.height_px], &options).unwrap();
    let tags = reader.metadata().output(&TagOptions {
        keep_georeference: false,
        camera: Some(RectifiedCamera {
            focal_length_mm: 70.0,
            principal_point_mm: [26.5, 20.0],
        }),
    });
    let plan = plan.with_bytes_beside(tags.bound_bytes());
    let mut out = Cursor::new(Vec::new());
    let mut file = TiffFile::new(&mut out, &plan).unwrap();
    let mut frame = file.frame(&plan, &tags).unwrap();
    let mut encoder = ChunkEncoder::new(&plan).unwrap();
    for rows in pixels.chunks(7 * header.row_samples()) {
        encoder
            .encode(rows, &mut |piece| frame.write(piece))
            .unwrap();
    }
    frame.finish().unwrap();
    let bytes = out.into_inner();
    assert!(bytes.len() as u64 <= plan.bound_bytes(tags.bound_bytes()));

    let mut again = FrameReader::new(Arc::new(bytes)).unwrap();
    let crc = |pixels: &[S]| {
        let mut crc = PixelCrc::default();
        crc.update(pixels);
        crc.value()
    };
    assert_eq!(crc(&all_rows::<S>(&mut again).unwrap()), crc(&pixels));
    assert!(again.metadata().dropped().is_empty());
    true
}

fn all_rows<S: Sample>(reader: &mut FrameReader) -> Result<Vec<S>, ReadError> {
    let row_samples = reader.header().row_samples();
    let mut band = vec![S::zeroed(); 5 * row_samples];
    let mut pixels = Vec::new();
    loop {
        let count = usize::try_from(reader.read_rows(&mut band)?).unwrap();
        if count == 0 {
            return Ok(pixels);
        }
        pixels.extend_from_slice(&band[..count * row_samples]);
    }
}
