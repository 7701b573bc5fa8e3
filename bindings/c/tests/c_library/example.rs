//! The output of `examples/main.c`, computed with the library in Rust: what C prints on a PC and in
//! QEMU are its bits.

use std::path::Path;

use fmc::flight::calibration_id::SerialNumber;
use fmc::flight::exposure::{FlightDirection, Limits};
use fmc::geometry::brown::Brown;
use fmc::geometry::evaluation_form::Displacement;
use fmc::geometry::mesh::displacement_rows::DisplacementRows;
use fmc::io::link::loading::Upload;
use fmc::{CalibrationParameters, Camera, CameraParameters, Exposure, SensorPoint};

/// FNV-1a over bytes.
#[derive(Clone, Copy)]
struct Digest(u32);

impl Digest {
    const BEGIN: Self = Self(2_166_136_261);

    fn add(&mut self, value: f32) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(16_777_619);
        }
    }
}

fn parameters() -> CameraParameters {
    let mut calibration = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
    calibration.principal_point = SensorPoint::new(0.0125, -0.03);
    calibration.distortion = Brown {
        k1: -1.6056e-5,
        k2: 6.18966e-9,
        k3: -1.31329e-12,
        p1: 2e-6,
        p2: -4.5e-6,
        ..Brown::NONE
    };
    CameraParameters {
        limits: Limits {
            vh_per_s: [0.02, 0.2],
            ..Limits::DEFAULT
        },
        serial: SerialNumber::new("C1").unwrap(),
        version: 3,
        ..CameraParameters::new(calibration)
    }
}

fn grid() -> Vec<SensorPoint> {
    let point = |line: i8, column: i8| {
        SensorPoint::new(
            2.625 * (f32::from(column) - 10.0),
            2.0 * (f32::from(line) - 10.0),
        )
    };
    let line = |line| (0..21).map(move |column| point(line, column));
    (0..21).flat_map(line).collect()
}

#[test]
fn example_prints_the_bits_of_the_library() {
    let parameters = parameters();
    let upload = Upload::of(&parameters).unwrap();
    let bytes: usize = upload.parts(64).map(|part| part.bytes.len()).sum();
    let camera = Camera::new(parameters).unwrap();
    let [mut interiors, mut corrected, mut distorted, mut rows] = [Digest::BEGIN; 4];
    for speed in 0..6_u8 {
        for time in 0..10_u8 {
            let mut exposure = Exposure::new(
                0.02 + 0.03 * f32::from(speed),
                0.0005 + 0.0005 * f32::from(time),
            );
            if time % 2 == 1 {
                exposure.direction = FlightDirection::Reverse;
            }
            let frame = camera.frame(&exposure).unwrap();
            interiors.add(frame.interior.motion.centroid_mm);
            interiors.add(frame.interior.left_out_nm);
            let mut points = grid();
            frame.correction.correct_slice(&mut points);
            for point in &points {
                corrected.add(point.x_mm);
                corrected.add(point.y_mm);
            }
            frame.correction.distort_slice(&mut points).unwrap();
            for point in &points {
                distorted.add(point.x_mm);
                distorted.add(point.y_mm);
            }
            let mut row = [Displacement::default(); 21];
            let mesh = DisplacementRows::new(&frame.correction, 2.625);
            mesh.row(SensorPoint::new(-26.25, 7.0)).write(&mut row);
            for displacement in row {
                rows.add(displacement.dx_mm);
                rows.add(displacement.dy_mm);
            }
        }
    }
    let expected = format!(
        "blob {bytes} bits {:08x}\ninterior 60 bits {:08x}\ncorrected 26460 bits {:08x}\n\
         distorted 26460 bits {:08x}\nmesh 1260 bits {:08x}\n",
        upload.crc(),
        interiors.0,
        corrected.0,
        distorted.0,
        rows.0
    );
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/main.txt");
    assert_eq!(std::fs::read_to_string(kept).unwrap(), expected);
}
