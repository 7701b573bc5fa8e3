//! What the page has to show of cameras, computed with the library in Rust: the CRC-32 of their
//! calibration, a digest of their coordinates' bits, and the largest terms of their budget.
//!
//! The argument is a file of JSON with the camera files by their names; the answer is JSON.

use std::collections::BTreeMap;
use std::error::Error;

use fmc::SensorPoint;
use fmc::flight::camera::Camera;
use fmc::flight::exposure::{Exposure, FlightDirection};
use fmc::io::link::digest;
use fmc_camera_file::CameraFile;
use fmc_camera_file::number::single;
use fmc_simulation::budget::assumptions::Assumptions;
use fmc_simulation::budget::run::budget;
use serde_json::{Value, json};

/// Assumptions of `host-sim budget` where none are given.
const ASSUMPTIONS: Assumptions = Assumptions {
    height_m: 1000.0,
    focus_mm: 0.005,
    vh_error: 0.01,
    relief: 0.1,
    drift_deg: 1.0,
    rate_deg_s: 1.0,
    encoder_mm: 0.001,
    timing_s: 1e-4,
};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("no file")?;
    let cameras: BTreeMap<String, String> = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let mut answers = BTreeMap::new();
    for (name, text) in &cameras {
        answers.insert(name, expected(name, text)?);
    }
    println!("{}", serde_json::to_string(&answers)?);
    Ok(())
}

fn expected(name: &str, text: &str) -> Result<Value, Box<dyn Error>> {
    let (file, _) = CameraFile::parse(name, text)?;
    let parameters = file.parameters();
    let crc = digest::of_camera(&parameters);
    let camera = Camera::new(parameters)?;
    let sensor = *camera.calibration().sensor();
    let points: Vec<SensorPoint> = places()
        .flat_map(|y| {
            places().map(move |x| {
                SensorPoint::new(x * sensor.half_width_mm(), y * sensor.half_height_mm())
            })
        })
        .collect();
    let mut digest = Digest::BEGIN;
    let mut accepted = 0;
    for vh_per_s in spread(parameters.limits.vh_per_s, 10) {
        let times = spread(parameters.limits.exposure_s, 6);
        for (time, exposure_s) in (0_u8..).zip(times) {
            let mut exposure = Exposure::new(vh_per_s, exposure_s);
            exposure.focus_shift_um = 5.0 * f32::from(time);
            if time % 2 == 1 {
                exposure.direction = FlightDirection::Reverse;
            }
            let Ok(frame) = camera.frame(&exposure) else {
                continue;
            };
            accepted += 1;
            let principal_point = frame.interior.principal_point;
            digest.add(frame.interior.motion.centroid_mm);
            digest.add(principal_point.x_mm);
            digest.add(principal_point.y_mm);
            let mut points = points.clone();
            frame.correction.correct_slice(&mut points);
            for point in points {
                digest.add(point.x_mm);
                digest.add(point.y_mm);
            }
        }
    }
    let budget = budget(&file, ASSUMPTIONS)?;
    let terms: Vec<_> = budget
        .terms
        .iter()
        .take(3)
        .map(|term| {
            let mark = if term.source.is_removed() { "*" } else { "" };
            json!([
                term.source.key(),
                1e3 * term.limits_mm,
                term.source.label(),
                format!("{}{mark}", term.source.kind().name()),
            ])
        })
        .collect();
    Ok(json!({
        "crc": crc,
        "points": points.len(),
        "accepted": accepted,
        "corrected": digest.0,
        "budget": terms,
    }))
}

/// FNV-1a over the bits of numbers.
struct Digest(u32);

impl Digest {
    const BEGIN: Self = Self(2_166_136_261);

    fn add(&mut self, value: f32) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(16_777_619);
        }
    }
}

fn places() -> impl Iterator<Item = f32> {
    (0..21_u8).map(|index| 2.0 * f32::from(index) / 20.0 - 1.0)
}

fn spread([from, to]: [f32; 2], count: u8) -> impl Iterator<Item = f32> {
    let [from, to] = [f64::from(from), f64::from(to)];
    (0..count)
        .map(move |index| f64::from(index) / f64::from(count - 1))
        .map(move |share| single(from * (1.0 - share) + to * share))
}
