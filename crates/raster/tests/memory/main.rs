//! Memory of reading and writing: a program of its own because it counts all memory.

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::BufWriter;
    use std::path::Path;

    use fmc_raster::{
        ChunkEncoder, Chunks, Compression, FramePlan, FrameReader, PlanOptions, TagOptions,
        TiffFile,
    };
    use peak_alloc::PeakAlloc;

    #[global_allocator]
    static MEMORY: PeakAlloc = PeakAlloc;

    /// Columns of the widest frame, RGB of 16 bits.
    const WIDTH_PX: u32 = 14_204;
    const TILES: Chunks = Chunks::Tiles {
        width_px: 512,
        height_px: 512,
    };

    /// Copies a frame to another layout, and returns the peak of the memory that this took.
    fn copy(input: &Path, output: &Path, compression: Compression, chunks: Chunks) -> usize {
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        let mut reader = FrameReader::open(input).unwrap();
        let header = reader.header().clone();
        let options = PlanOptions {
            compression: Some(compression),
            chunks: Some(chunks),
            big: false,
        };
        let size_px = [header.width_px, header.height_px];
        let plan = FramePlan::new(&header, size_px, &options).unwrap();
        let tags = reader.metadata().output(&TagOptions::default());
        let mut file = TiffFile::new(BufWriter::new(File::create(output).unwrap()), &plan).unwrap();
        let mut frame = file.frame(&plan, &tags).unwrap();
        let mut encoder = ChunkEncoder::new(&plan).unwrap();
        let mut row = vec![0_u16; header.row_samples()];
        while reader.read_rows(&mut row).unwrap() > 0 {
            encoder
                .encode(&row, &mut |piece| frame.write(piece))
                .unwrap();
        }
        frame.finish().unwrap();
        MEMORY.peak_usage() - before
    }

    /// Writes a frame of noise in one strip.
    fn one_strip(path: &Path, height_px: u32) {
        let mut encoder =
            tiff::encoder::TiffEncoder::new(BufWriter::new(File::create(path).unwrap())).unwrap();
        let mut image = encoder
            .new_image::<tiff::encoder::colortype::RGB16>(WIDTH_PX, height_px)
            .unwrap();
        image.rows_per_strip(height_px).unwrap();
        let mut random = fastrand::Rng::with_seed(1);
        let samples: Vec<u16> = (0..WIDTH_PX * height_px * 3)
            .map(|place| (place >> 9 & 0xfff) as u16 + random.u16(..64))
            .collect();
        image.write_strip(&samples).unwrap();
        image.finish().unwrap();
    }

    #[test]
    fn memory_holds_a_strip_or_two_rows_of_tiles_whatever_the_frame() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let height_px = 320;
        one_strip(&path("whole.tif"), height_px);
        let one = Chunks::Strips { rows: height_px };
        let (a, b) = (path("a.tif"), path("b.tif"));
        // An uncompressed strip passes through in both directions, whatever its length.
        let peak = copy(&path("whole.tif"), &a, Compression::None, one);
        assert!(peak < 1 << 20, "{peak} bytes");
        for (compression, limit) in [
            (Compression::Lzw, 1 << 20),
            (Compression::Deflate, 1 << 20),
            // The C library's window is not counted.
            (Compression::Zstd, 1 << 20),
        ] {
            // One compressed strip of 27 MB is written from memory, and read row by row.
            copy(&a, &b, compression, one);
            let peak = copy(&b, &path("c.tif"), Compression::None, one);
            assert!(peak < limit, "{compression}: {peak} bytes");
            // A strip of 64 rows is held by the encoder, decoded and encoded.
            let strips = Chunks::Strips { rows: 64 };
            let peak = copy(&a, &b, compression, strips);
            assert!(peak < 20 << 20, "{compression}: {peak} bytes");
            let peak = copy(&b, &path("c.tif"), compression, strips);
            assert!(peak < 32 << 20, "{compression}: {peak} bytes");
        }
        // A row of tiles of 512 is 44 MB in the reader and in the encoder, here of 320 rows.
        copy(&a, &b, Compression::Deflate, TILES);
        let peak = copy(&b, &path("c.tif"), Compression::Deflate, TILES);
        assert!(peak < 70 << 20, "{peak} bytes");
    }
}
