//! Residual vectors over the sensor.

use fmc_adjustment::calibration::five::FiveCalibration;

use crate::arrow::Arrow;
use crate::arrow_field::ArrowField;
use crate::figure::FigureError;
use crate::wording;

/// Number of residuals above which means over cells are drawn.
const MOST_ARROWS: usize = 600;

/// Number of cells along the longer side.
const CELLS: u32 = 20;

/// Draws the residuals of the accepted observations, in SVG. Many residuals are drawn as means over
/// the cells of a grid, in which the errors of the model show above the noise.
///
/// # Errors
/// [`FigureError`] without observations or if the drawing fails.
pub fn residual_vectors(calibration: &FiveCalibration) -> Result<String, FigureError> {
    let arrows: Vec<Arrow> = calibration
        .rows()
        .filter(|(_, tested)| tested.passes)
        .map(|(measurement, tested)| Arrow {
            from_mm: measurement.row.point_mm,
            displacement_mm: tested.residual_mm,
        })
        .collect();
    let format_mm = calibration.camera.half_format_mm().map(|half| 2.0 * half);
    let count = wording::counted(arrows.len(), "residual");
    let (what, arrows) = field_of(count, arrows, format_mm);
    let titles = [
        "Residuals, observed − fitted".to_owned(),
        format!("{}: {what}", calibration.camera.name),
    ];
    ArrowField {
        titles,
        format_mm,
        axis: calibration.camera.fmc.axis.name(),
        arrows: &arrows,
    }
    .svg()
}

/// Returns the arrows to be drawn with the words for them: means over cells if there are many.
pub(super) fn field_of(
    count: String,
    arrows: Vec<Arrow>,
    format_mm: [f64; 2],
) -> (String, Vec<Arrow>) {
    if arrows.len() > MOST_ARROWS {
        let means = cell_means(&arrows, format_mm);
        (format!("means of {count} over cells"), means)
    } else {
        (count, arrows)
    }
}

/// Returns a mean arrow at the mean place of every cell that is not empty.
fn cell_means(arrows: &[Arrow], [width, height]: [f64; 2]) -> Vec<Arrow> {
    let size = width.max(height) / f64::from(CELLS);
    let mut cells: std::collections::BTreeMap<[i64; 2], (f64, [f64; 4])> =
        std::collections::BTreeMap::new();
    for arrow in arrows {
        let [x, y] = arrow.from_mm;
        let [dx, dy] = arrow.displacement_mm;
        // Cells are counted from the centre, so that they lie symmetrically.
        let cell = arrow.from_mm.map(|place| whole(place / size));
        let (count, sums) = cells.entry(cell).or_default();
        *count += 1.0;
        for (sum, term) in sums.iter_mut().zip([x, y, dx, dy]) {
            *sum += term;
        }
    }
    cells
        .into_values()
        .map(|(count, sums)| {
            let [x, y, dx, dy] = sums.map(|sum| sum / count);
            Arrow {
                from_mm: [x, y],
                displacement_mm: [dx, dy],
            }
        })
        .collect()
}

#[expect(clippy::cast_possible_truncation, reason = "a few cells")]
fn whole(number: f64) -> i64 {
    number.round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_keep_what_is_systematic() {
        let arrows: Vec<Arrow> = (0..2000)
            .map(|index| {
                let index = f64::from(index);
                Arrow {
                    from_mm: [(index % 50.0) - 25.0, (index / 50.0).floor() - 20.0],
                    displacement_mm: [1e-3, if index % 2.0 < 1.0 { 1e-3 } else { -1e-3 }],
                }
            })
            .collect();
        let means = cell_means(&arrows, [50.0, 40.0]);
        assert!(means.len() > 200 && means.len() < 500, "{}", means.len());
        assert!(
            means
                .iter()
                .all(|mean| (mean.displacement_mm[0] - 1e-3).abs() < 1e-12)
        );
    }
}
