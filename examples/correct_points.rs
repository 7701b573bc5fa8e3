//! Measured points of a file, corrected for the exposure in which they were recorded.
//!
//! `cargo run --example correct_points -- POINTS.csv` reads columns `id,x_mm,y_mm`; without a file
//! it takes `examples/data/points.csv`. `host-sim correct` does the same for files of any size and
//! for every camera file.

use std::{env, error::Error, fmt::Write as _, fs};

use fmc_camera::{Brown, CalibrationParameters, Camera, CameraParameters, Exposure, SensorPoint};

/// A point as it stands in the file.
#[derive(Debug, serde::Deserialize)]
struct Point {
    id: String,
    x_mm: f32,
    y_mm: f32,
}

/// A Phase One iXM-RS150F with 50 mm, as published: principal distance and coefficients in mm.
fn camera() -> Result<Camera, Box<dyn Error>> {
    let mut lens = CalibrationParameters::new(51.3712, [14204, 10652], 3.76);
    lens.distortion = Brown {
        k1: -1.6056e-5,
        k2: 6.18966e-9,
        k3: -1.31329e-12,
        ..Brown::default()
    };
    Ok(Camera::new(CameraParameters::new(lens))?)
}

/// Returns the corrected points of a table, with the distortion that was subtracted.
///
/// # Errors
/// An error with the line of the first row that is not a point, or whose point lies off the sensor.
pub(crate) fn corrected(table: &str) -> Result<String, Box<dyn Error>> {
    // V/H in 1/s, exposure in s: 200 m/s at 1176 m above the ground, 1/200 s.
    let frame = camera()?.frame(&Exposure::new(0.17, 1.0 / 200.0))?;
    let mut answer = "id,x_mm,y_mm,dx_um,dy_um\n".to_owned();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    for (row, point) in reader.deserialize().enumerate() {
        let Point { id, x_mm, y_mm } = point?;
        let measured = SensorPoint::new(x_mm, y_mm);
        if !frame.correction.contains(measured) {
            return Err(
                format!("line {}: ({x_mm}, {y_mm}) mm is not on the sensor", row + 2).into(),
            );
        }
        let corrected = frame.correction.correct(measured);
        let (point, distortion) = (corrected.point, corrected.distortion);
        writeln!(
            answer,
            "{id},{:.6},{:.6},{:.4},{:.4}",
            point.x_mm,
            point.y_mm,
            1e3 * distortion.dx_mm,
            1e3 * distortion.dy_mm,
        )?;
    }
    Ok(answer)
}

fn main() -> Result<(), Box<dyn Error>> {
    let table = match env::args_os().nth(1) {
        Some(file) => {
            fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?
        }
        None => include_str!("data/points.csv").to_owned(),
    };
    print!("{}", corrected(&table)?);
    Ok(())
}
