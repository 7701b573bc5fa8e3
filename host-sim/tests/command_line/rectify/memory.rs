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

/// Writes a frame whose pixels are one uncompressed tile, as the crates of this project do not.
fn write_one_tile(path: &Path) {
    let [width, height] = [14_208_u32, SIZE_PX[1]];
    let pixels = u64::from(width) * u64::from(height) * 6;
    let shorts = |tag: u16, value: u32| (tag, 3_u16, 1_u32, value);
    let longs = |tag: u16, value: u32| (tag, 4_u16, 1_u32, value);
    let entries = [
        longs(256, SIZE_PX[0]),
        longs(257, SIZE_PX[1]),
        (258, 3, 3, 8),
        shorts(259, 1),
        shorts(262, 2),
        shorts(277, 3),
        longs(322, width),
        longs(323, height),
        longs(324, 512),
        longs(325, u32::try_from(pixels).unwrap()),
    ];
    let mut file = BufWriter::new(File::create(path).unwrap());
    let mut head = b"II*\0".to_vec();
    head.extend(16_u32.to_le_bytes());
    // Bits of the samples, then the directory.
    head.extend([16_u16; 4].map(u16::to_le_bytes).concat());
    head.extend(u16::try_from(entries.len()).unwrap().to_le_bytes());
    for (tag, value_type, count, value) in entries {
        head.extend(tag.to_le_bytes());
        head.extend(value_type.to_le_bytes());
        head.extend(count.to_le_bytes());
        head.extend(value.to_le_bytes());
    }
    head.resize(512, 0);
    file.write_all(&head).unwrap();
    let row: Vec<u8> = (0..=u8::MAX).cycle().take(6 * width as usize).collect();
    for _ in 0..height {
        file.write_all(&row).unwrap();
    }
    file.flush().unwrap();
}

#[test]
fn a_frame_in_one_tile_takes_no_more_memory_than_strips() {
    let bench = Bench::with(CAMERA, b"");
    write_one_tile(&bench.path("one.tif"));
    let exposure = ["rectify", "--camera", "camera.toml", "--vh", "0.1"];
    let more = ["--exposure", "1/200", "--out", "out", "one.tif"];
    let arguments = [&exposure[..], &more].concat();
    let peak = peak_mb(&bench, &arguments);
    assert!(peak > 10.0 && peak < 100.0, "{peak} MB");
    let answer = bench.run(&arguments);
    let said = "one.tif: its tiles are too large to be held; strips of 64 rows are written";
    assert!(answer.stderr.contains(said), "{}", answer.stderr);
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
