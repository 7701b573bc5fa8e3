//! Copies a frame: `cargo run --release -p fmc-raster --example copy_frame -- IN.tif OUT.tif
//! [none|lzw|deflate|zstd] [strip ROWS | tile PX] [big]`. It prints the CRC-32 of the pixels and
//! what was dropped.

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;

use fmc_raster::{
    ChunkEncoder, Chunks, Compression, FramePlan, FrameReader, PixelCrc, PlanOptions, Sample,
    TagOptions, TiffFile,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let input = PathBuf::from(arguments.next().ok_or("IN.tif is missing")?);
    let output = PathBuf::from(arguments.next().ok_or("OUT.tif is missing")?);
    let mut options = PlanOptions::default();
    while let Some(word) = arguments.next() {
        match word.as_str() {
            "none" => options.compression = Some(Compression::None),
            "lzw" => options.compression = Some(Compression::Lzw),
            "deflate" => options.compression = Some(Compression::Deflate),
            "zstd" => options.compression = Some(Compression::Zstd),
            "big" => options.big = true,
            "strip" | "tile" => {
                let px = arguments.next().ok_or("a number is missing")?.parse()?;
                options.chunks = Some(match word.as_str() {
                    "strip" => Chunks::Strips { rows: px },
                    _ => Chunks::Tiles {
                        width_px: px,
                        height_px: px,
                    },
                });
            }
            other => return Err(format!("{other}: not an option").into()),
        }
    }
    let mut reader = FrameReader::open(&input)?;
    println!("{:?}", reader.header());
    let out = BufWriter::with_capacity(1 << 20, File::create(output)?);
    if reader.header().bits == 8 {
        copy::<u8>(&mut reader, out, &options)
    } else {
        copy::<u16>(&mut reader, out, &options)
    }
}

fn copy<S: Sample>(
    reader: &mut FrameReader,
    mut out: BufWriter<File>,
    options: &PlanOptions,
) -> Result<(), Box<dyn Error>> {
    let header = reader.header().clone();
    let tags = reader.metadata().output(&TagOptions {
        keep_georeference: true,
        camera: None,
    });
    for dropped in tags.dropped() {
        println!("dropped: {}: {}", dropped.name, dropped.why);
    }
    let plan = FramePlan::new(&header, [header.width_px, header.height_px], options)?
        .with_bytes_beside(tags.bound_bytes());
    let mut file = TiffFile::new(&mut out, &plan)?;
    let mut frame = file.frame(&plan, &tags)?;
    let mut encoder = ChunkEncoder::new(&plan)?;
    let mut crc = PixelCrc::default();
    let row_samples = header.row_samples();
    let mut rows = vec![S::zeroed(); 16 * row_samples];
    loop {
        let count = reader.read_rows(&mut rows)?;
        if count == 0 {
            break;
        }
        let rows = rows
            .get(..usize::try_from(count)? * row_samples)
            .unwrap_or_default();
        crc.update(rows);
        encoder.encode(rows, &mut |piece| frame.write(piece))?;
    }
    frame.finish()?;
    out.flush()?;
    println!("CRC-32 of the pixels: {:08x}", crc.value());
    Ok(())
}
