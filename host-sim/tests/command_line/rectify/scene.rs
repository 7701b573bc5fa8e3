//! A small camera, its flight, and frames of a pattern that it recorded.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;

use fmc_camera::geometry::frame_correction::FrameCorrection;
use fmc_camera::geometry::sensor::SensorPoint;
use fmc_raster::{
    ChunkEncoder, Chunks, Compression, FramePlan, FrameReader, PlanOptions, TagOptions, TiffFile,
};

use crate::command_line::frames::flight::{Flight, flight_of};

/// Width and height of its frames, pixels.
pub(super) const SIZE_PX: [u32; 2] = [300, 220];

/// 12 x 8.8 mm with up to 1.4 px of distortion; the stage moves by a pixel and more.
pub(super) const CAMERA: &str = r#"name = "Small camera"
principal_distance_mm = 20.0
principal_point_mm = [0.02, -0.01]
[sensor]
width_px = 300
height_px = 220
pixel_um = 40.0
[distortion]
k1 = -1.0e-4
p1 = 2.0e-5
[fmc]
axis = "+y"
stroke_mm = 4.0
"#;

/// Sequence numbers of the frames that were exposed.
pub(super) const EXPOSED: [u32; 7] = [1, 2, 3, 4, 6, 7, 8];

/// Returns the flight with frames `f1.tif` to `f8.tif`, and `frames.csv`, which names them.
pub(super) fn scene() -> Flight {
    let flight = flight_of(CAMERA);
    let mut table = String::from("file,sequence\n");
    for (sequence, correction) in (1..).zip(&flight.corrections) {
        let name = format!("f{sequence}.tif");
        let frame = recorded(correction);
        write(&flight.bench.path(&name), &frame, &PlanOptions::default());
        writeln!(table, "{name},{sequence}").unwrap();
    }
    fs::write(flight.bench.path("frames.csv"), table).unwrap();
    flight
}

/// Grey value of the pattern at an ideal point, mm.
pub(super) fn pattern([x, y]: [f64; 2]) -> f64 {
    32_768.0 + 12_000.0 * (3.1 * x + 0.4).sin() * (2.7 * y - 0.2).cos() + 300.0 * (x - y)
}

/// Returns the place of a pixel's centre from that of the image, mm.
pub(super) fn place([col, row]: [u32; 2], [width, height]: [u32; 2]) -> [f64; 2] {
    let half = |side: u32| (f64::from(side) - 1.0) / 2.0;
    [
        (f64::from(col) - half(width)) * 0.04,
        (half(height) - f64::from(row)) * 0.04,
    ]
}

/// Returns the frame that a camera with this correction records of the pattern, which is fixed to
/// the sensor.
fn recorded(correction: &FrameCorrection) -> Vec<u16> {
    let [width, height] = SIZE_PX;
    let pixels = (0..height).flat_map(|row| (0..width).map(move |col| [col, row]));
    pixels
        .map(|pixel| {
            let [x, y] = place(pixel, SIZE_PX).map(fmc_camera_file::number::single);
            let ideal = correction.correct(SensorPoint::new(x, y)).point;
            grey(pattern([ideal.x_mm, ideal.y_mm].map(f64::from)))
        })
        .collect()
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the pattern lies between 0 and 65535"
)]
fn grey(value: f64) -> u16 {
    value.round() as u16
}

/// Writes a grey frame.
pub(super) fn write(path: &Path, samples: &[u16], options: &PlanOptions) {
    let file = File::create(path).unwrap();
    // The crate `tiff` writes a first version, whose header and tags the frame is laid out from.
    let mut plain = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut plain).unwrap();
    let [width, height] = SIZE_PX;
    encoder
        .write_image::<tiff::encoder::colortype::Gray16>(width, height, samples)
        .unwrap();
    let reader = FrameReader::new(Arc::new(plain.into_inner())).unwrap();
    let tags = reader.metadata().output(&TagOptions::default());
    let plan = FramePlan::new(reader.header(), SIZE_PX, options).unwrap();
    let mut tiff = TiffFile::new(BufWriter::new(file), &plan).unwrap();
    let mut frame = tiff.frame(&plan, &tags).unwrap();
    let mut chunks = ChunkEncoder::new(&plan).unwrap();
    chunks
        .encode(samples, &mut |piece| frame.write(piece))
        .unwrap();
    frame.finish().unwrap();
}

/// Tiles of 64 px with Deflate.
pub(super) const TILED: PlanOptions = PlanOptions {
    compression: Some(Compression::Deflate),
    chunks: Some(Chunks::Tiles {
        width_px: 64,
        height_px: 64,
    }),
    big: false,
};

/// Reads a grey image.
pub(super) fn read(path: &Path) -> (Vec<u16>, [u32; 2]) {
    let mut reader = FrameReader::open(path).unwrap();
    let size = [reader.header().width_px, reader.header().height_px];
    let mut samples = vec![0; (size[0] * size[1]) as usize];
    assert_eq!(reader.read_rows(&mut samples).unwrap(), size[1]);
    (samples, size)
}
