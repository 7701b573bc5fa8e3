//! The residual vectors of a calibration: `residuals.csv`.

use std::io::Write;

use fmc_adjustment::calibration::five::FiveCalibration;

/// Columns of the file.
const HEADER: [&str; 16] = [
    "line",
    "id",
    "x_mm",
    "y_mm",
    "vh_per_s",
    "exposure_s",
    "opening_offset_mm",
    "travel_mm",
    "centroid_mm",
    "dx_um",
    "dy_um",
    "sigma_um",
    "residual_x_um",
    "residual_y_um",
    "test_value",
    "rejected",
];

/// Writes a header and a row per observation, in the order of the observations.
///
/// # Errors
/// Those of the sink.
pub fn write(calibration: &FiveCalibration, sink: impl Write) -> csv::Result<()> {
    let mut file = csv::Writer::from_writer(sink);
    file.write_record(HEADER)?;
    for (measurement, tested) in calibration.rows() {
        let row = &measurement.row;
        let [x_mm, y_mm] = row.point_mm;
        let [dx_mm, dy_mm] = row.distortion_mm;
        let [residual_x, residual_y] = tested.residual_mm;
        let um = |length_mm: f64| format!("{:.6}", 1e3 * length_mm + 0.0);
        file.write_record([
            row.line.to_string(),
            row.id.as_deref().unwrap_or_default().to_owned(),
            x_mm.to_string(),
            y_mm.to_string(),
            row.vh_per_s.to_string(),
            row.exposure_s.to_string(),
            row.opening_offset_mm.to_string(),
            format!("{:.9}", measurement.travel_mm),
            format!("{:.9}", measurement.centroid_mm),
            um(dx_mm),
            um(dy_mm),
            if calibration.has_sigma {
                um(row.sigma_mm)
            } else {
                String::new()
            },
            um(residual_x),
            um(residual_y),
            format!("{:.4}", tested.test_value),
            (!tested.passes).to_string(),
        ])?;
    }
    file.flush()?;
    Ok(())
}
