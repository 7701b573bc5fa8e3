//! The coefficients exposure by exposure: `coefficients.csv`.

use std::io::Write;

use fmc_simulation::sweep::result::{FrameFit, Sweep};

use super::results::COEFFICIENTS;

/// Columns of the file. A coefficient that does not exist is an empty field.
const HEADER: [&str; 17] = [
    "strategy",
    "vh_per_s",
    "exposure_s",
    "delta_um",
    "centroid_um",
    "km0",
    "km0_sigma",
    "km1_per_mm2",
    "km1_sigma_per_mm2",
    "km2_per_mm4",
    "km2_sigma_per_mm4",
    "kd1_per_mm2",
    "kd1_sigma_per_mm2",
    "pm1_per_mm2",
    "pm1_sigma_per_mm2",
    "sigma0_um",
    "sigma0_n_minus_5_um",
];

/// Writes a header and a row per exposure.
///
/// # Errors
/// Those of the sink.
pub fn write(sweep: &Sweep, sink: impl Write) -> csv::Result<()> {
    let mut file = csv::Writer::from_writer(sink);
    file.write_record(HEADER)?;
    for frame in &sweep.both().frames {
        file.write_record(row(frame))?;
    }
    file.flush()?;
    Ok(())
}

fn row(frame: &FrameFit) -> Vec<String> {
    let um = |length_mm: f64| format!("{:.6}", 1e3 * length_mm);
    let mut row = vec![
        frame.exposure.strategy_name().to_owned(),
        frame.exposure.vh_per_s.to_string(),
        frame.exposure.exposure_s.to_string(),
        um(frame.travel_mm),
        um(frame.centroid_mm),
    ];
    if let Ok(fit) = &frame.fit {
        for (parameter, _) in COEFFICIENTS {
            row.push(format!("{:.9e}", fit.value(parameter)));
            row.push(format!("{:.3e}", fit.standard_deviation(parameter)));
        }
        row.push(format!("{:.6}", fit.sigma0));
        row.push(
            fit.sigma0_as_printed
                .map_or_else(String::new, |sigma| format!("{sigma:.6}")),
        );
    }
    row.resize(HEADER.len(), String::new());
    row
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::fixture;

    #[test]
    fn a_header_and_a_row_per_exposure() {
        for strategy in ["from-rest", "centred"] {
            let mut bytes = Vec::new();
            write(&fixture::sweep(strategy), &mut bytes).unwrap();
            let mut file = csv::Reader::from_reader(bytes.as_slice());
            assert_eq!(file.headers().unwrap(), HEADER.as_slice());
            let rows: Vec<csv::StringRecord> = file.records().map(Result::unwrap).collect();
            assert_eq!(rows.len(), 60);
            assert_eq!(&rows[0][0], strategy);
            assert_eq!(&rows[0][3], "50.000000");
            assert_eq!(rows[0][11].is_empty(), strategy == "centred");
        }
    }
}
