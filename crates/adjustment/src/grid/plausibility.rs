//! Tables in a wrong unit, of the wrong sign or off the sensor, told by their numbers.

use fmc_camera_file::InputError;
use fmc_reference::lens::Lens;

use super::request::GridCalibrationRequest;
use super::table::TableObservation;
use crate::calibration::snooping::count;

/// Rows that a table has at least: more than a polynomial has coefficients.
const LEAST_ROWS: usize = 16;

/// Part of the half format that the places reach at least, along either axis.
const LEAST_REACH: f64 = 0.05;

/// Largest distortion, as a part of half the diagonal of the format.
const MOST_OF_RADIUS: f64 = 0.1;

/// Largest distortion below which a table holds none, µm: it is less than anybody measures.
const LEAST_UM: f64 = 1e-3;

/// Size of the camera file's distortion at the places, µm rms, from which on the two are compared.
const LEAST_KNOWN_UM: f64 = 1.0;

/// Correlation of the table with the camera file's distortion from which on its factor counts.
const LEAST_CORRELATION: f64 = 0.9;

/// Factors of the camera file's distortion that are no other unit.
const LIKELY: std::ops::Range<f64> = 0.2..5.0;

/// Checks rows, places and distortions of a table.
///
/// # Errors
/// [`InputError`] that names file, line, column, value and allowed range.
pub(super) fn check(request: &GridCalibrationRequest<'_>) -> Result<(), InputError> {
    let rows = request.observations.len();
    if rows < LEAST_ROWS {
        return Err(InputError::invalid(format!(
            "{}: {rows} rows; allowed: {LEAST_ROWS} and more",
            request.input.file
        )));
    }
    for row in request.observations {
        check_row(request, row)?;
    }
    check_reach(request)?;
    check_size(request)?;
    check_factor(request)
}

fn check_row(
    request: &GridCalibrationRequest<'_>,
    row: &TableObservation,
) -> Result<(), InputError> {
    let file = &request.input.file;
    let half_stroke = 0.5 * request.camera.fmc.stroke_mm;
    // A rounding of the last digit that is printed is no motion.
    if row.stage_offset_mm.abs() > half_stroke + 1e-6 {
        return Err(InputError::invalid(format!(
            "{file}, line {}: stage_offset_mm = {}; allowed: -{half_stroke} to {half_stroke}, half of fmc.stroke_mm",
            row.line, row.stage_offset_mm
        )));
    }
    let pixel_mm = request.camera.sensor.pixel_um / 1e3;
    let halves = request.camera.half_format_mm();
    for ((column, value), half) in ["x_mm", "y_mm"]
        .into_iter()
        .zip(row.measured_mm)
        .zip(halves)
    {
        if value.abs() > half + pixel_mm {
            return Err(InputError::invalid(format!(
                "{file}, line {}: {column} = {value} lies off the sensor; allowed: -{half} to {half}",
                row.line
            ))
            .with_help("mm from the centre of the sensor, x to the right, y upwards; pixels are col_px,row_px"));
        }
    }
    Ok(())
}

fn check_reach(request: &GridCalibrationRequest<'_>) -> Result<(), InputError> {
    let [half_x, half_y] = request.camera.half_format_mm();
    let reach = |component: fn([f64; 2]) -> f64| {
        let rows = request.observations.iter();
        let values = rows.map(|row| component(row.measured_mm).abs());
        values.fold(0.0, f64::max)
    };
    for (column, half, reach) in [
        ("x_mm", half_x, reach(|[x, _]| x)),
        ("y_mm", half_y, reach(|[_, y]| y)),
    ] {
        if reach < LEAST_REACH * half {
            return Err(InputError::invalid(format!(
                "{}: {column} reaches {reach} mm of a half format of {half} mm; allowed: {} and more; is it in m?",
                request.input.file,
                LEAST_REACH * half
            )));
        }
    }
    Ok(())
}

fn check_size(request: &GridCalibrationRequest<'_>) -> Result<(), InputError> {
    let [half_x, half_y] = request.camera.half_format_mm();
    let most_um = 1e3 * MOST_OF_RADIUS * half_x.hypot(half_y);
    let mut largest = (0, "dx_um", 0.0_f64);
    for row in request.observations {
        for (column, value) in ["dx_um", "dy_um"].into_iter().zip(row.distortion_mm) {
            let (_, _, before) = largest;
            if 1e3 * value.abs() > before.abs() {
                largest = (row.line, column, 1e3 * value);
            }
        }
    }
    let (line, column, value) = largest;
    let guess = if value.abs() < LEAST_UM {
        "is it in mm?"
    } else if value.abs() > most_um {
        "is it in nm?"
    } else {
        return Ok(());
    };
    Err(InputError::invalid(format!(
        "{}, line {line}: {column} = {value:.6} is the largest; allowed: {LEAST_UM} to {most_um:.0}, a tenth of half the diagonal; {guess}",
        request.input.file
    )))
}

/// Checks the factor between the table and the distortion of the camera file, which a table in
/// another unit or of the other sign shows.
fn check_factor(request: &GridCalibrationRequest<'_>) -> Result<(), InputError> {
    let lens = Lens::of(request.camera);
    let [x0, y0] = request.camera.principal_point_mm;
    let [ex, ey] = request.camera.fmc.axis.unit();
    let [mut both, mut observed, mut known] = [0.0_f64; 3];
    for row in request.observations {
        let [x, y] = row.measured_mm;
        let offset = row.stage_offset_mm;
        let of_camera = lens.displacement([x - x0 - offset * ex, y - y0 - offset * ey]);
        for (seen, of_camera) in row.distortion_mm.into_iter().zip(of_camera) {
            both += seen * of_camera;
            observed += seen * seen;
            known += of_camera * of_camera;
        }
    }
    let known_um = 1e3 * (known / count(2 * request.observations.len())).sqrt();
    let correlation = both / (observed * known).sqrt();
    let factor = both / known;
    let is_likely = LIKELY.contains(&factor);
    if known_um < LEAST_KNOWN_UM || correlation.abs() < LEAST_CORRELATION || is_likely {
        return Ok(());
    }
    let pixel_um = request.camera.sensor.pixel_um;
    let guess = if factor < 0.0 {
        "are they corrections? Distortion is measured - ideal".to_owned()
    } else {
        let units = [("mm", 1e-3), ("nm", 1e3), ("pixels", pixel_um.recip())];
        let near = |(_, unit): &(&str, f64)| LIKELY.contains(&(factor / unit));
        let unit = units.into_iter().find(near);
        unit.map_or_else(
            || "is the camera file that of this camera?".to_owned(),
            |(unit, _)| format!("are they in {unit}?"),
        )
    };
    Err(InputError::invalid(format!(
        "{}: dx_um and dy_um are {factor:.3e} times the distortion of the camera file (correlation {correlation:.3}); allowed: {} to {}; {guess}",
        request.input.file, LIKELY.start, LIKELY.end
    )))
}
