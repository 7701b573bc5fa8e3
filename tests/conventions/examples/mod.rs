//! The worked examples, computed by the library.
//!
//! A row is `name | given | result`, both sides `symbol = number unit; …`. Results are computed
//! from the given numbers as printed and must agree to half a unit of the last printed digit (and
//! two units of single precision).

mod distortion;
mod fitting;
mod focus;
mod frames;
mod image_motion;
mod models;
mod motion;
mod software;
mod time;

use crate::conventions::camera;
use crate::conventions::document::rows;
use fmc_camera::flight::camera::{CameraParameters, Mechanism};
use fmc_camera::flight::exposure::Exposure;
use fmc_camera::flight::stage::RunUp;
use fmc_camera::geometry::sensor::{PixelPoint, Sensor, SensorPoint};
use std::fmt::Debug;
use std::str::FromStr;

/// Name of an example, and the function that computes it.
type Example = (&'static str, fn(&Given) -> Results);

/// Symbol, unit and value.
type Results = Vec<(&'static str, &'static str, f64)>;

/// `symbol = number unit`.
struct Entry {
    symbol: &'static str,
    number: &'static str,
    unit: &'static str,
}

fn entries(cell: &'static str) -> Vec<Entry> {
    cell.split(';')
        .map(|entry| {
            let (symbol, value) = entry.split_once('=').expect(entry);
            let (number, unit) = value.trim().split_once(' ').unwrap_or((value.trim(), ""));
            Entry {
                symbol: symbol.trim(),
                number,
                unit,
            }
        })
        .collect()
}

/// The given side of an example.
struct Given(Vec<Entry>);

impl Given {
    fn number<T: FromStr<Err: Debug>>(&self, symbol: &str, unit: &str) -> T {
        let entry = self.0.iter().find(|entry| entry.symbol == symbol);
        let entry = entry.unwrap_or_else(|| panic!("{symbol} is not given"));
        assert_eq!(entry.unit, unit, "unit of {symbol}");
        entry.number.parse().unwrap()
    }

    fn optional(&self, symbol: &str, unit: &str) -> Option<f32> {
        let given = self.0.iter().any(|entry| entry.symbol == symbol);
        given.then(|| self.number(symbol, unit))
    }

    fn point(&self, x: &str, y: &str) -> SensorPoint {
        SensorPoint::new(self.number(x, "mm"), self.number(y, "mm"))
    }

    fn pixel(&self, col: &str, row: &str) -> PixelPoint {
        PixelPoint {
            col_px: self.number(col, "px"),
            row_px: self.number(row, "px"),
        }
    }

    fn sensor(&self) -> Sensor {
        let [width_px, height_px] = ["W", "H"].map(|side| self.number(side, "px"));
        Sensor::new(width_px, height_px, self.number("p", "µm")).unwrap()
    }

    fn exposure(&self) -> Exposure {
        Exposure::new(self.number("V/H", "1/s"), self.number("t", "s"))
    }

    /// Returns the camera of the tests with the given principal distance and stage.
    fn stage_camera(&self, run_up: RunUp) -> CameraParameters {
        let mut record = camera::record();
        record.calibration.principal_distance_mm = self.number("f", "mm");
        record.mechanism = Mechanism::Stage {
            acceleration_mm_s2: self.number("a", "mm/s²"),
            settling_ms: self.number("t_settle", "ms"),
            run_up,
            jerk_mm_s3: self.optional("J", "mm/s³"),
            max_speed_mm_s: None,
        };
        record
    }
}

fn point_results(x: &'static str, y: &'static str, point: SensorPoint) -> Results {
    vec![(x, "mm", point.x_mm.into()), (y, "mm", point.y_mm.into())]
}

/// Returns half a unit of the last printed digit.
fn half_last_digit(number: &str) -> f64 {
    let decimals = number.split_once('.').map_or(0, |(_, digits)| digits.len());
    0.5 * 10_f64.powi(-i32::try_from(decimals).unwrap())
}

#[test]
fn worked_examples_are_what_the_library_computes() {
    let examples = [
        frames::EXAMPLES,
        distortion::EXAMPLES,
        motion::EXAMPLES,
        time::EXAMPLES,
        focus::EXAMPLES,
        models::EXAMPLES,
        image_motion::EXAMPLES,
        software::EXAMPLES,
        fitting::EXAMPLES,
    ]
    .concat();
    let documented = rows("example");
    let names: Vec<_> = documented.iter().map(|row| row[0]).collect();
    let computed: Vec<_> = examples.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, computed);
    for (row, (name, compute)) in documented.iter().zip(examples) {
        let printed = entries(row[2]);
        let results = compute(&Given(entries(row[1])));
        assert_eq!(printed.len(), results.len(), "{name}");
        for (entry, (symbol, unit, value)) in printed.iter().zip(results) {
            assert_eq!((entry.symbol, entry.unit), (symbol, unit), "{name}");
            let number: f64 = entry.number.parse().unwrap();
            let tolerance =
                half_last_digit(entry.number) + 2.0 * f64::from(f32::EPSILON) * number.abs();
            assert!(
                (value - number).abs() <= tolerance,
                "{name}: {symbol} = {value}, printed {number}"
            );
        }
    }
}
