//! Frame records, as `host-sim records` and `host-sim mission` write them, read for a block
//! adjustment: for every image its principal point with σ and the instant to which it belongs, and
//! for every trigger without an image the reason.
//!
//! `cargo run --example read_records -- records.csv`; without a file it takes
//! `examples/data/records.csv`.

use std::{env, error::Error, fmt::Write as _, fs};

/// The columns that an adjustment needs; `records.csv` has more.
#[derive(Debug, serde::Deserialize)]
struct Record {
    sequence: u32,
    outcome: String,
    reason: String,
    /// Time of the camera's own clock, µs; `centroid_unix_us` is UTC if a time pulse has set it.
    centroid_us: Option<u64>,
    principal_point_x_mm: Option<f64>,
    principal_point_y_mm: Option<f64>,
    principal_point_sigma_mm: Option<f64>,
    principal_distance_mm: Option<f64>,
    flags: String,
}

/// Returns a line for every record.
///
/// # Errors
/// An error with the line of the first row that is not a record.
pub(crate) fn orientations(table: &str) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let (mut images, mut triggers) = (0, 0);
    for record in csv::Reader::from_reader(table.as_bytes()).deserialize() {
        let record: Record = record?;
        triggers += 1;
        let image = (
            record.centroid_us,
            record.principal_point_x_mm,
            record.principal_point_y_mm,
            record.principal_point_sigma_mm,
            record.principal_distance_mm,
        );
        let (Some(time_us), Some(x0_mm), Some(y0_mm), Some(sigma_mm), Some(distance_mm)) = image
        else {
            writeln!(
                text,
                "{:3} {}: {}",
                record.sequence, record.outcome, record.reason
            )?;
            continue;
        };
        images += 1;
        // The principal point of an image without compensation is off its calibrated place; its σ
        // is valid all the same.
        let note = if record.flags.contains("no compensation") {
            ", not compensated"
        } else {
            ""
        };
        writeln!(
            text,
            "{:3} at {time_us} us: x0 {:.3} um, y0 {:.3} um, sigma {:.3} um, f {distance_mm} mm{note}",
            record.sequence,
            1e3 * x0_mm,
            1e3 * y0_mm,
            1e3 * sigma_mm,
        )?;
    }
    writeln!(text, "{images} images of {triggers} triggers")?;
    Ok(text)
}

fn main() -> Result<(), Box<dyn Error>> {
    let table = match env::args_os().nth(1) {
        Some(file) => {
            fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?
        }
        None => include_str!("data/records.csv").to_owned(),
    };
    print!("{}", orientations(&table)?);
    Ok(())
}
