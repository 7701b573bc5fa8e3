//! Reader of the camera's `records.csv` for a network of its images.

use std::path::Path;

use fmc_adjustment::bundle::records::{FlightRecords, RecordRow};
use fmc_adjustment::bundle::tables::Table;
use fmc_adjustment::calibration::result::InputFile;
use fmc_camera::geometry::range::MAX_FOCUS_FRACTION;
use fmc_camera_file::CameraFile;
use fmc_reference::residual_splines::ResidualSplines;

use super::named_columns::{NamedColumns, Row};
use crate::failure::Failure;

/// Columns without which a record says too little.
const REQUIRED: [&str; 7] = [
    "sequence",
    "outcome",
    "principal_point_x_mm",
    "principal_point_y_mm",
    "principal_point_sigma_mm",
    "centroid_offset_mm",
    "focus_shift_mm",
];

/// Largest difference of a principal point from that of c̄ and the camera file, mm: rounding of a
/// table to 10 nm.
const PRINCIPAL_POINT_TOLERANCE_MM: f64 = 1e-5;

/// Reads the records of a flight of a camera with these residual grids; columns other than those
/// needed may be missing.
///
/// # Errors
/// [`Failure`] naming file, line, column, value and allowed range.
pub fn read(
    path: &Path,
    camera: &CameraFile,
    grids: &ResidualSplines,
) -> Result<(FlightRecords, InputFile), Failure> {
    let columns = NamedColumns::read(path, &REQUIRED)?;
    let rows: Vec<RecordRow> = columns
        .rows()
        .map(|row| record(row, camera))
        .collect::<Result<_, _>>()?;
    let file = columns.input.file.clone();
    if rows.is_empty() {
        return Err(Failure::bad_input(format!("{file}: the file has no rows")));
    }
    let records = FlightRecords {
        table: Table { file, rows },
        direction: camera.fmc.axis.unit(),
        principal_point_mm: camera.principal_point_mm,
        lever_mm: camera.exit_pupil_mm(),
        grids: grids.clone(),
    };
    Ok((records, columns.input))
}

fn record(row: Row<'_>, camera: &CameraFile) -> Result<RecordRow, Failure> {
    let text = row.optional("sequence").unwrap_or_default();
    let sequence: u32 = text.parse().map_err(|_| {
        row.failure(format!(
            "sequence = \"{}\" is outside 0 to {}",
            text.escape_debug(),
            u32::MAX
        ))
    })?;
    let refused = RecordRow {
        line: row.line,
        sequence,
        is_exposed: false,
        offset_mm: 0.0,
        sigma_mm: 0.0,
        enlargement: 0.0,
        centroid_after_trigger_s: None,
    };
    match row.optional("outcome").unwrap_or_default() {
        "refused" => return Ok(refused),
        "exposed" => {}
        other => {
            return Err(row.failure(format!(
                "outcome = \"{}\" is none of exposed, refused",
                other.escape_debug()
            )));
        }
    }
    let half_stroke = 0.5 * camera.fmc.stroke_mm;
    let offset_mm = within(row, "centroid_offset_mm", [-half_stroke, half_stroke])?;
    let axes = camera.principal_point_mm.into_iter();
    let axes = axes.zip(camera.fmc.axis.unit());
    for ((static_mm, e), column) in axes.zip(["principal_point_x_mm", "principal_point_y_mm"]) {
        let expected = static_mm + offset_mm * e;
        let value = row.number(column)?;
        if (value - expected).abs() > PRINCIPAL_POINT_TOLERANCE_MM {
            return Err(row.failure(format!(
                "{column} = {value} contradicts the camera file; allowed by its principal_point_mm, its axis {} and \
                 centroid_offset_mm = {offset_mm}: {expected:.6} ± {PRINCIPAL_POINT_TOLERANCE_MM}",
                camera.fmc.axis.name()
            )));
        }
    }
    let lever_mm = camera.exit_pupil_mm();
    let most = f64::from(MAX_FOCUS_FRACTION) * lever_mm.min(camera.principal_distance_mm);
    let centroid_after_trigger_s = match (
        row.optional_number("trigger_us")?,
        row.optional_number("centroid_us")?,
    ) {
        (Some(trigger), Some(centroid)) => Some(1e-6 * (centroid - trigger)),
        _ => None,
    };
    Ok(RecordRow {
        is_exposed: true,
        offset_mm,
        sigma_mm: within(row, "principal_point_sigma_mm", [0.0, camera.fmc.stroke_mm])?,
        enlargement: within(row, "focus_shift_mm", [-most, most])? / lever_mm,
        centroid_after_trigger_s,
        ..refused
    })
}

fn within(row: Row<'_>, column: &str, [least, most]: [f64; 2]) -> Result<f64, Failure> {
    let value = row.number(column)?;
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    Err(row.failure(format!(
        "{column} = {value} is outside {least:.3} to {most:.3} mm, the range of this camera"
    )))
}
