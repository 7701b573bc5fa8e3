//! Figure of the part of the format that image points cover.

use fmc_adjustment::calibration::result::CalibrationResult;
use fmc_adjustment::calibration::result::coverage::LEAST_RADIUS_SHARE;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::{Color, RGBColor};

use crate::figure::{self, FONT, FigureError, OUTLINE, TITLE, WIDTH, pixels, text};

const EDGE: f64 = 30.0;
/// Height of the title.
const HEAD: f64 = 108.0;
const POINT: RGBColor = RGBColor(0, 90, 160);
const REJECTED: RGBColor = RGBColor(194, 47, 47);
const CORNERS: u32 = 180;

/// Draws all image points on the format, rejected ones in red, and the circle that they should
/// reach, in SVG.
///
/// # Errors
/// [`FigureError`] without image points or if the drawing fails.
pub fn svg(result: &CalibrationResult) -> Result<String, FigureError> {
    if result.image_residuals.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    let coverage = result.coverage();
    let [half_x, half_y] = result.camera.half_format_mm();
    let scale = (f64::from(WIDTH) - 2.0 * EDGE) / (2.0 * half_x);
    let size = (
        WIDTH,
        pixels(HEAD + 2.0 * EDGE + 2.0 * half_y * scale).unsigned_abs(),
    );
    let place = |[x, y]: [f64; 2]| {
        (
            pixels(EDGE + (x + half_x) * scale),
            pixels(HEAD + EDGE + (half_y - y) * scale),
        )
    };
    figure::svg(size, |canvas| {
        let title = format!("{}: image points of all images", result.camera.name);
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let reach = format!(
            "they reach {:.1} mm, {:.0} % of the format radius",
            coverage.radius_mm,
            100.0 * coverage.radius_share(),
        );
        let cells = format!(
            "and lie in {:.0} % of the cells of the format; rejected: red",
            100.0 * coverage.cells
        );
        for (words, y) in [(reach, 62), (cells, 92)] {
            canvas.draw(&Text::new(words, (20, y), text(FONT)))?;
        }
        let corners = [place([-half_x, -half_y]), place([half_x, half_y])];
        canvas.draw(&Rectangle::new(corners, OUTLINE.stroke_width(3)))?;
        let [x0, y0] = result.calibrated.principal_point_mm;
        let radius = LEAST_RADIUS_SHARE * coverage.format_radius_mm;
        let circle: Vec<(i32, i32)> = (0..=CORNERS)
            .map(|corner| {
                let angle = f64::from(corner) / f64::from(CORNERS) * std::f64::consts::TAU;
                let [x, y] = [x0 + radius * angle.cos(), y0 + radius * angle.sin()];
                place([x.clamp(-half_x, half_x), y.clamp(-half_y, half_y)])
            })
            .collect();
        canvas.draw(&PathElement::new(circle, OUTLINE.stroke_width(1)))?;
        for one in &result.image_residuals {
            let colour = if one.is_rejected { REJECTED } else { POINT };
            let dot = Circle::new(place(one.measured_mm), 3, colour.filled());
            canvas.draw(&dot)?;
        }
        Ok(())
    })
}
