//! Checks for columns whose numbers cannot have the stated unit.

use fmc_camera_file::{CameraFile, InputError};
use fmc_reference::lens::Lens;

use super::measurement::Measurement;

/// Fraction of half the format: points that are all nearer to the centre are not in millimetres.
const LEAST_FORMAT: f64 = 1.0 / 200.0;

/// Factor in the median: distortions that differ by more from the static calibration's are in
/// another unit.
const MOST_FACTOR: f64 = 100.0;

/// Static distortion, µm in the median, below which it cannot be compared with the observed one.
const LEAST_STATIC_UM: f64 = 0.5;

/// Distortion, µm, below which it cannot be observed.
const LEAST_UM: f64 = 0.01;

/// Fraction of the format radius: a lens does not have distortions of more than this, in the
/// median.
const MOST_OF_RADIUS: f64 = 0.1;

/// Checks coordinates and distortions by column.
///
/// # Errors
/// [`InputError`] that names file, line, column, value and allowed range.
pub(super) fn check(
    file: &str,
    measurements: &[Measurement],
    camera: &CameraFile,
) -> Result<(), InputError> {
    for (axis, column) in ["x_mm", "y_mm"].into_iter().enumerate() {
        let half_mm = component(camera.half_format_mm(), axis);
        check_coordinates(file, measurements, half_mm, axis, column)?;
    }
    let lens = Lens::of(camera);
    let [x0, y0] = camera.principal_point_mm;
    let [half_x, half_y] = camera.half_format_mm();
    let largest_um = 1000.0 * MOST_OF_RADIUS * half_x.hypot(half_y);
    for (axis, column) in ["dx_um", "dy_um"].into_iter().enumerate() {
        let observed = |measurement: &Measurement| {
            1000.0 * component(measurement.row.distortion_mm, axis).abs()
        };
        let known = |measurement: &Measurement| {
            let [x, y] = measurement.row.point_mm;
            1000.0 * component(lens.displacement([x - x0, y - y0]), axis).abs()
        };
        let observed_um = median(measurements.iter().map(observed).collect());
        let static_um = median(measurements.iter().map(known).collect());
        let (least, most) = if static_um >= LEAST_STATIC_UM {
            (
                static_um / MOST_FACTOR,
                (static_um * MOST_FACTOR).min(largest_um),
            )
        } else {
            (0.0, largest_um)
        };
        let largest_seen = measurements.iter().map(observed).fold(0.0, f64::max);
        let tiny = observed_um < least || largest_seen < LEAST_UM;
        if !tiny && observed_um <= most {
            continue;
        }
        let guess = if tiny { "is it in mm?" } else { "is it in nm?" };
        let example = measurements
            .iter()
            .min_by(|a, b| {
                let distance = |m: &Measurement| (observed(m) - observed_um).abs();
                distance(a).total_cmp(&distance(b))
            })
            .map_or((0, 0.0), |m| {
                (m.row.line, 1000.0 * component(m.row.distortion_mm, axis))
            });
        let (line, value) = example;
        return Err(InputError::invalid(format!(
            "{file}, line {line}: {column} = {value}: the median of the column, {observed_um:.3e} µm, is outside \
             {:.3e} to {most:.3e} µm (static calibration at these points: {static_um:.3e} µm); {guess}",
            least.max(if tiny { LEAST_UM } else { 0.0 })
        )));
    }
    Ok(())
}

/// Range of σ0 without `sigma_um`, µm, that shows numbers in millimetres if no distortion is larger
/// than [`LARGEST_OF_MM`]; a smaller σ0 is that of data without noise.
const SIGMA_OF_MM: std::ops::Range<f64> = 2e-5..0.02;

/// Largest distortion of a file in millimetres, read as µm.
const LARGEST_OF_MM: f64 = 2.0;

/// Largest factor by which σ0 differs from 1 with `sigma_um`.
const MOST_SIGMA: f64 = 50.0;

/// Correlation of observed and static distortion below which their signs are opposite.
const OPPOSITE: f64 = -0.5;

/// Checks the noise that the fit finds: a scale that no camera and no measurement has is refused.
///
/// # Errors
/// [`InputError`] that names file, value and allowed range.
pub(super) fn check_sigma(
    file: &str,
    has_sigma: bool,
    sigma0: f64,
    measurements: &[Measurement],
) -> Result<(), InputError> {
    let components = measurements.iter().flat_map(|m| m.row.distortion_mm);
    let largest_um = 1000.0 * components.fold(0.0, |most: f64, d| most.max(d.abs()));
    if !has_sigma && SIGMA_OF_MM.contains(&sigma0) && largest_um < LARGEST_OF_MM {
        let most = SIGMA_OF_MM.end;
        return Err(InputError::invalid(format!(
            "{file}: dx_um and dy_um, at most {largest_um:.3} µm, leave residuals of {sigma0:.3e} µm, less than the {most} µm that anybody measures; \
             are they in mm?"
        )));
    }
    let range = 1.0 / MOST_SIGMA..=MOST_SIGMA;
    // Data without noise leave no residuals, whatever their σ.
    if has_sigma && sigma0 > 1e-6 && !range.contains(&sigma0) {
        return Err(InputError::invalid(format!(
            "{file}: the residuals are {sigma0:.3e} times sigma_um, outside {} to {MOST_SIGMA}; are sigma_um, dx_um and \
             dy_um all in µm, and measured - ideal in the sensor frame?",
            range.start()
        )));
    }
    Ok(())
}

/// Checks that the observed distortion is not the negative of the calibrated one.
///
/// # Errors
/// [`InputError`] that names file and correlation.
pub(super) fn check_sign(
    file: &str,
    measurements: &[Measurement],
    camera: &CameraFile,
) -> Result<(), InputError> {
    let lens = Lens::of(camera);
    let [x0, y0] = camera.principal_point_mm;
    let [mut both, mut observed, mut known] = [0.0_f64; 3];
    for measurement in measurements {
        let [x, y] = measurement.row.point_mm;
        let of_lens = lens.displacement([x - x0, y - y0]);
        for (seen, static_mm) in measurement.row.distortion_mm.into_iter().zip(of_lens) {
            both += seen * static_mm;
            observed += seen * seen;
            known += static_mm * static_mm;
        }
    }
    let correlation = both / (observed * known).sqrt();
    let count = f64::from(u32::try_from(2 * measurements.len()).unwrap_or(u32::MAX));
    let static_um = 1000.0 * (known / count).sqrt();
    if static_um >= LEAST_STATIC_UM && correlation < OPPOSITE {
        return Err(InputError::invalid(format!(
            "{file}: dx_um and dy_um run against the static calibration (correlation {correlation:.2}, at least {OPPOSITE} is \
             allowed); are they corrections? Distortion is measured - ideal"
        )));
    }
    Ok(())
}

fn check_coordinates(
    file: &str,
    measurements: &[Measurement],
    half_mm: f64,
    axis: usize,
    column: &str,
) -> Result<(), InputError> {
    let farthest = measurements.iter().max_by(|a, b| {
        let distance = |m: &Measurement| component(m.row.point_mm, axis).abs();
        distance(a).total_cmp(&distance(b))
    });
    let Some(farthest) = farthest else {
        return Ok(());
    };
    let value = component(farthest.row.point_mm, axis);
    // A column of zeros means points on a line, which the adjustment reports.
    if value.abs() <= 0.0 || value.abs() >= LEAST_FORMAT * half_mm {
        return Ok(());
    }
    Err(InputError::invalid(format!(
        "{file}, line {}: {column} = {value} is the farthest of the column from the centre of a sensor of \
         -{half_mm} to {half_mm} mm, nearer by a factor of {:.0}; is it in m, or are all points on one line?",
        farthest.row.line,
        half_mm / value.abs()
    )))
}

fn component([x, y]: [f64; 2], axis: usize) -> f64 {
    if axis == 0 { x } else { y }
}

/// Returns the median, or the upper of the two middle numbers.
pub(super) fn median(mut numbers: Vec<f64>) -> f64 {
    let middle = numbers.len() / 2;
    if middle >= numbers.len() {
        return 0.0;
    }
    let (_, median, _) = numbers.select_nth_unstable_by(middle, f64::total_cmp);
    *median
}
