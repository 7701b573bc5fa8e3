//! Damaged files are errors: no panic, and no more memory than a frame of their size may take. It
//! is a program of its own because it counts all memory.

#[cfg(test)]
#[path = "../../../../fuzz/raster.rs"]
mod raster;
#[cfg(test)]
#[path = "../raster/tiff_bytes.rs"]
mod tiff_bytes;

#[cfg(test)]
mod tests {
    use std::path::Path;

    use fmc_raster::{ByteOrder, Chunks, Compression};
    use peak_alloc::PeakAlloc;

    use crate::raster::raster;
    use crate::tiff_bytes::{TestFrame, longs, text};

    #[global_allocator]
    static MEMORY: PeakAlloc = PeakAlloc;

    /// Largest memory that a file of a few kB may take, besides the file.
    const LARGEST_BYTES: usize = 64 << 20;

    const XMP: &str = "<x:xmpmeta xmlns:x='adobe:ns:meta/'><r:RDF \
        xmlns:r='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><r:Description r:about='a' \
        xmlns:d='http://www.dji.com/drone-dji/1.0/' d:DewarpFlag='1' d:Yaw='&lt;2'><d:DewarpData>1\
        </d:DewarpData><!-- c --></r:Description></r:RDF></x:xmpmeta>";

    /// Small files of all codecs, containers and layouts.
    fn files() -> Vec<Vec<u8>> {
        let mut files = Vec::new();
        for (case, compression) in [
            Compression::None,
            Compression::PackBits,
            Compression::Lzw,
            Compression::Deflate,
            Compression::Zstd,
        ]
        .into_iter()
        .enumerate()
        {
            for chunks in [
                Chunks::Strips { rows: 8 },
                Chunks::Tiles {
                    width_px: 16,
                    height_px: 16,
                },
            ] {
                let frame = TestFrame {
                    order: [ByteOrder::LittleEndian, ByteOrder::BigEndian][case % 2],
                    big: case % 3 == 1,
                    size_px: [19, 17],
                    samples: [1, 3, 4][case % 3],
                    bits: [8, 16][case % 2],
                    planar: case == 3,
                    predictor: case > 2,
                    compression,
                    chunks,
                    padded: case > 0,
                    entries: vec![text(270, "a description"), text(700, XMP)],
                };
                assert!(raster(&frame.bytes()), "{frame:?}");
                files.push(frame.bytes());
                // The pixels, read as a directory.
                let mut pointing = frame;
                pointing.entries = vec![longs(34_665, &[64])];
                files.push(pointing.bytes());
            }
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/raster");
        for entry in std::fs::read_dir(folder).unwrap() {
            files.push(std::fs::read(entry.unwrap().path()).unwrap());
        }
        assert_eq!(files.len(), 25);
        files
    }

    fn within_memory(bytes: &[u8]) -> bool {
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        let is_read = raster(bytes);
        let taken = MEMORY.peak_usage() - before;
        assert!(taken < LARGEST_BYTES, "{taken} bytes of memory");
        is_read
    }

    /// One test, because memory of others would be counted.
    #[test]
    fn truncated_and_changed_files_are_errors_without_panic_or_much_memory() {
        let files = files();
        let (mut truncated, mut changed, mut read) = (0, 0, 0);
        for file in &files {
            for length in 0..file.len() {
                within_memory(&file[..length]);
                truncated += 1;
            }
        }
        let mut random = fastrand::Rng::with_seed(19);
        for _ in 0..10_000 {
            let mut file = files[random.usize(..files.len())].clone();
            for _ in 0..random.usize(1..4) {
                let place = random.usize(..file.len());
                // The directory is at the end, the header at the beginning.
                let place = match random.u8(..3) {
                    0 => place,
                    1 => file.len() - 1 - place % 300.min(file.len()),
                    _ => place % 16,
                };
                file[place] = random.u8(..);
            }
            read += usize::from(within_memory(&file));
            changed += 1;
        }
        println!("{truncated} truncated files; {changed} changed ones, {read} of them read");
        assert!(truncated > 10_000 && read > 500 && read < changed);
    }
}
