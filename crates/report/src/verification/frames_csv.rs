//! The verification exposure by exposure: `frames.csv`.

use std::io::Write;

use fmc_reference::verification::result::{ErrorStatistics, FrameResult, Verification};

/// Columns of the file.
const HEADER: [&str; 16] = [
    "camera",
    "strategy",
    "vh_per_s",
    "exposure_s",
    "delta_um",
    "centroid_um",
    "uncorrected_max_um",
    "uncorrected_rms_um",
    "static_max_um",
    "static_rms_um",
    "printed_max_um",
    "printed_rms_um",
    "camera_max_nm",
    "camera_rms_nm",
    "coordinate_max_nm",
    "solver_error_nm",
];

/// Writes a header and a row per exposure.
///
/// # Errors
/// Those of the sink.
pub fn write(verification: &Verification, sink: impl Write) -> csv::Result<()> {
    let mut file = csv::Writer::from_writer(sink);
    file.write_record(HEADER)?;
    for camera in &verification.cameras {
        for frame in &camera.frames {
            file.write_record(row(&camera.name, frame))?;
        }
    }
    file.flush()?;
    Ok(())
}

fn row(camera: &str, frame: &FrameResult) -> [String; 16] {
    let um = |length_mm: f64| format!("{:.6}", 1e3 * length_mm);
    let nm = |length_mm: f64| format!("{:.6}", 1e6 * length_mm);
    let in_um = |errors: ErrorStatistics| [um(errors.max_mm()), um(errors.rms_mm())];
    let [uncorrected, fixed, printed, corrected] = frame.errors;
    let [uncorrected_max, uncorrected_rms] = in_um(uncorrected);
    let [static_max, static_rms] = in_um(fixed);
    let [printed_max, printed_rms] = in_um(printed);
    [
        camera.to_owned(),
        frame.strategy.to_owned(),
        frame.vh_per_s.to_string(),
        frame.exposure_s.to_string(),
        um(frame.travel_mm),
        um(frame.centroid_mm),
        uncorrected_max,
        uncorrected_rms,
        static_max,
        static_rms,
        printed_max,
        printed_rms,
        nm(corrected.max_mm()),
        nm(corrected.rms_mm()),
        nm(frame.coordinate_error.max_mm()),
        format!("{:.3e}", 1e6 * frame.solver_error_mm),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::fixture;

    #[test]
    fn a_header_and_a_row_per_exposure() {
        let verification = fixture::passing();
        let mut bytes = Vec::new();
        write(&verification, &mut bytes).unwrap();
        let mut file = csv::Reader::from_reader(bytes.as_slice());
        assert_eq!(file.headers().unwrap(), HEADER.as_slice());
        let rows: Vec<csv::StringRecord> = file.records().map(Result::unwrap).collect();
        let frames: usize = verification.cameras.iter().map(|c| c.frames.len()).sum();
        assert_eq!(rows.len(), frames);
        assert_eq!(&rows[0][0], "Alpha");
        assert_eq!(&rows[0][1], "centred");
        assert_eq!(&rows[0][4], "20.000000");
        assert_eq!(&rows[0][12], "0.100000");
    }
}
