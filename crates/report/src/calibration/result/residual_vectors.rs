//! Residual vectors of image points: over the sensor, and image by image.

use std::collections::BTreeMap;

use fmc_adjustment::calibration::result::CalibrationResult;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{Color, RGBColor};

use crate::arrow::{Arrow, length_of};
use crate::arrow_field::ArrowField;
use crate::calibration::residual_field::field_of;
use crate::figure::{self, FONT, FigureError, OUTLINE, TITLE, pixels, text};
use crate::{length, wording};

/// Largest number of images that are drawn one by one; `residuals.csv` has all.
pub const MOST_IMAGES: usize = 36;

const COLUMNS: usize = 3;
const PANEL: f64 = 280.0;
const EDGE: f64 = 14.0;
/// Height of the title.
const HEAD: f64 = 100.0;
const COLOUR: RGBColor = RGBColor(0, 90, 160);

/// Draws the residual vectors of all images over the sensor, in SVG.
///
/// # Errors
/// [`FigureError`] without residuals or if the drawing fails.
pub fn stacked(result: &CalibrationResult) -> Result<String, FigureError> {
    let arrows: Vec<Arrow> = accepted(result).map(|(_, arrow)| arrow).collect();
    let format_mm = format_mm(result);
    let count = wording::counted(arrows.len(), "residual");
    let (what, arrows) = field_of(count, arrows, format_mm);
    ArrowField {
        titles: [
            "Residuals, corrected point − adjusted".to_owned(),
            format!("{}: {what}", result.camera.name),
        ],
        format_mm,
        axis: result.camera.fmc.axis.name(),
        arrows: &arrows,
    }
    .svg()
}

/// Draws the residual vectors of each image in a panel of its own, all of one scale, in SVG.
///
/// # Errors
/// [`FigureError`] without residuals or if the drawing fails.
pub fn by_image(result: &CalibrationResult) -> Result<String, FigureError> {
    let mut images: BTreeMap<&str, Vec<Arrow>> = BTreeMap::new();
    for (image, arrow) in accepted(result) {
        images.entry(image).or_default().push(arrow);
    }
    let largest = images
        .values()
        .flatten()
        .map(|arrow| length_of(arrow.displacement_mm))
        .fold(0.0, f64::max);
    if images.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    let [width_mm, height_mm] = format_mm(result);
    let scale = (PANEL - 2.0 * EDGE) / width_mm.max(height_mm);
    let [panel_width, panel_height] = [width_mm, height_mm].map(|mm| mm * scale + 2.0 * EDGE);
    // The longest vector takes a sixth of the shorter side.
    let exaggeration = if largest > 0.0 {
        width_mm.min(height_mm) / 6.0 / largest
    } else {
        0.0
    };
    let shown = images.len().min(MOST_IMAGES);
    let rows = shown.div_ceil(COLUMNS);
    let count = |number: usize| f64::from(u32::try_from(number).unwrap_or(u32::MAX));
    let columns = count(shown.min(COLUMNS)).max(2.0);
    let size = (
        pixels(columns * panel_width).unsigned_abs(),
        pixels(HEAD + count(rows) * (panel_height + 30.0)).unsigned_abs(),
    );
    figure::svg(size, |canvas| {
        let title = format!("Residuals image by image, {} of {}", shown, images.len());
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let words = format!("longest vector {}", length::text(largest));
        canvas.draw(&Text::new(words, (20, 60), text(FONT)))?;
        for (index, (image, arrows)) in images.iter().take(MOST_IMAGES).enumerate() {
            let left = count(index % COLUMNS) * panel_width;
            let top = HEAD + count(index / COLUMNS) * (panel_height + 30.0);
            let place = |[x, y]: [f64; 2]| {
                (
                    pixels(left + EDGE + (x + width_mm / 2.0) * scale),
                    pixels(top + EDGE + (height_mm / 2.0 - y) * scale),
                )
            };
            let corner = [width_mm / 2.0, height_mm / 2.0];
            let corners = [place(corner.map(|half| -half)), place(corner)];
            canvas.draw(&Rectangle::new(corners, OUTLINE.stroke_width(2)))?;
            canvas.draw(&Text::new(
                (*image).to_owned(),
                (pixels(left + EDGE), pixels(top)),
                text(FONT),
            ))?;
            for arrow in arrows {
                let [x, y] = arrow.from_mm;
                let [dx, dy] = arrow.displacement_mm.map(|mm| mm * exaggeration);
                canvas.draw(&Circle::new(place([x, y]), 1, COLOUR.filled()))?;
                let shaft = [place([x, y]), place([x + dx, y + dy])];
                canvas.draw(&PathElement::new(shaft, COLOUR.stroke_width(2)))?;
            }
        }
        Ok(())
    })
}

fn accepted(result: &CalibrationResult) -> impl Iterator<Item = (&str, Arrow)> {
    let residuals = result.image_residuals.iter().filter(|one| !one.is_rejected);
    residuals.map(|one| {
        let arrow = Arrow {
            from_mm: one.measured_mm,
            displacement_mm: one.vector_mm(),
        };
        (&*one.image, arrow)
    })
}

fn format_mm(result: &CalibrationResult) -> [f64; 2] {
    result.camera.half_format_mm().map(|half| 2.0 * half)
}
