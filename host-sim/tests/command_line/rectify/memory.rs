//! Memory of a run: that of a few rows, whatever the height of the frame.

use std::fs::{self, File};
use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::thread;
use std::time::Duration;

use fmc_raster::{
    ByteOrder, ChunkEncoder, Chunks, Compression, FramePlan, Header, Metadata, PlanOptions,
    TagOptions, TiffFile,
};

use crate::command_line::support::Bench;

/// As wide as a frame of 150 megapixels, and as low as bands of rows allow.
const CAMERA: &str = r#"name = "Wide camera"
principal_distance_mm = 50.0
[sensor]
width_px = 14204
height_px = 1536
pixel_um = 3.76
[distortion]
k1 = -1.0e-5
[fmc]
axis = "+y"
stroke_mm = 4.0
"#;

const SIZE_PX: [u32; 2] = [14_204, 1536];

/// Writes a frame of three bands of 16 bits.
fn write(path: &Path, chunks: Chunks) {
    let header = Header {
        width_px: SIZE_PX[0],
        height_px: SIZE_PX[1],
        samples: 3,
        bits: 16,
        photometric: 2,
        extra_samples: Vec::new(),
        compression: Compression::None,
        predictor: false,
        chunks,
        planar: false,
        byte_order: ByteOrder::native(),
        big: false,
    };
    let plan = FramePlan::new(&header, SIZE_PX, &PlanOptions::default()).unwrap();
    let mut file = BufWriter::new(File::create(path).unwrap());
    let mut tiff = TiffFile::new(&mut file, &plan).unwrap();
    let tags = Metadata::default().output(&TagOptions::default());
    let mut frame = tiff.frame(&plan, &tags).unwrap();
    let mut encoder = ChunkEncoder::new(&plan).unwrap();
    let row: Vec<u16> = (0..=u16::MAX).cycle().take(3 * 14_204).collect();
    for _ in 0..SIZE_PX[1] {
        encoder
            .encode(&row, &mut |piece| frame.write(piece))
            .unwrap();
    }
    frame.finish().unwrap();
    file.flush().unwrap();
}

/// Largest resident memory of a run, MB.
fn peak_mb(bench: &Bench, arguments: &[&str]) -> f64 {
    let mut child = bench.command(arguments).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak_kb = 0.0_f64;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let number = line.and_then(|line| line.split_whitespace().next());
        let kb = number.map_or(0.0, |number| number.parse().unwrap());
        peak_kb = peak_kb.max(kb);
        thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    peak_kb * 1024.0 / 1e6
}

#[test]
fn rows_of_strips_take_100_mb_and_rows_of_tiles_250() {
    let tile = |px| Chunks::Tiles {
        width_px: px,
        height_px: px,
    };
    for (chunks, most_mb) in [(Chunks::Strips { rows: 64 }, 100.0), (tile(512), 250.0)] {
        let bench = Bench::with(CAMERA, b"");
        write(&bench.path("one.tif"), chunks);
        let exposure = ["rectify", "--camera", "camera.toml", "--vh", "0.1"];
        let more = ["--exposure", "1/200", "--out", "out", "one.tif"];
        let peak = peak_mb(&bench, &[&exposure[..], &more].concat());
        assert!(peak > 10.0 && peak < most_mb, "{chunks:?}: {peak} MB");
    }
}
