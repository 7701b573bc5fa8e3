//! Residuals against quantities on which they should not depend.

use fmc_adjustment::calibration::five::FiveCalibration;
use fmc_adjustment::calibration::measurement::Measurement;
use fmc_camera_file::CameraFile;
use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::{Color, RGBColor};

use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, FONT, FigureError, INK, TITLE, WIDTH, text};
use crate::legend::{self, Entry, Mark};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 620);
const TITLE_HEIGHT: u32 = 92;
const AXIS_WIDTH: u32 = 110;
const AXIS_HEIGHT: u32 = 76;
const EDGE: u32 = 30;
/// Colours of dx and dy (Okabe and Ito's palette, safe for the colour-blind).
const COLOURS: [RGBColor; 2] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0)];
/// Largest number of dots; more are thinned out, but the means are over all.
const MOST_DOTS: usize = 3000;
/// Largest number of means along the axis.
const MEANS: usize = 24;

/// Quantity against which residuals are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Against {
    /// V/H.
    Vh,
    /// Exposure time.
    Exposure,
    /// Angle between the ray and the optical axis.
    FieldAngle,
    /// Order of the rows, that is, time.
    Order,
}

impl Against {
    /// All quantities.
    pub const ALL: [Self; 4] = [Self::Vh, Self::Exposure, Self::FieldAngle, Self::Order];

    /// Returns the name of the figure's file.
    #[must_use]
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::Vh => "residuals-vh.svg",
            Self::Exposure => "residuals-exposure.svg",
            Self::FieldAngle => "residuals-field-angle.svg",
            Self::Order => "residuals-order.svg",
        }
    }

    const fn title(self) -> &'static str {
        match self {
            Self::Vh => "Residuals against V/H",
            Self::Exposure => "Residuals against exposure time",
            Self::FieldAngle => "Residuals against field angle",
            Self::Order => "Residuals in the order of the observations",
        }
    }

    const fn axis(self) -> &'static str {
        match self {
            Self::Vh => "V/H, s⁻¹",
            Self::Exposure => "exposure time, ms",
            Self::FieldAngle => "field angle, degrees",
            Self::Order => "line of the file",
        }
    }

    fn value(self, measurement: &Measurement, camera: &CameraFile) -> f64 {
        let row = &measurement.row;
        match self {
            Self::Vh => row.vh_per_s,
            Self::Exposure => 1e3 * row.exposure_s,
            Self::FieldAngle => {
                let [x, y] = row.point_mm;
                let [x0, y0] = camera.principal_point_mm;
                (x - x0)
                    .hypot(y - y0)
                    .atan2(camera.principal_distance_mm)
                    .to_degrees()
            }
            Self::Order => u32::try_from(row.line).map_or(f64::from(u32::MAX), f64::from),
        }
    }
}

/// Draws residuals of dx and dy of the accepted observations, and their means, in SVG.
///
/// # Errors
/// [`FigureError`] without observations or if the drawing fails.
pub fn residuals_against(
    calibration: &FiveCalibration,
    against: Against,
) -> Result<String, FigureError> {
    let mut places: Vec<(f64, [f64; 2])> = calibration
        .rows()
        .filter(|(_, tested)| tested.passes)
        .map(|(measurement, tested)| {
            (
                against.value(measurement, &calibration.camera),
                tested.residual_mm.map(|mm| 1e3 * mm),
            )
        })
        .collect();
    places.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let (Some((first, _)), Some((last, _))) = (places.first(), places.last()) else {
        return Err(FigureError::NothingToDraw);
    };
    let margin = (0.03 * (last - first)).max(1e-3 * last.abs()).max(1e-9);
    let largest = places
        .iter()
        .flat_map(|(_, residuals)| residuals.map(f64::abs))
        .fold(1e-6, f64::max);
    let step = places.len().div_ceil(MOST_DOTS);
    figure::svg(SIZE, |canvas| {
        let title = format!("{}: {}", calibration.camera.name, against.title());
        canvas.draw(&Text::new(title, (20, 28), text(TITLE)))?;
        let [dx, dy] = COLOURS;
        let entries = [(dx, "dx; line: means"), (dy, "dy; line: means")];
        let entries = entries.map(|(colour, words)| Entry {
            mark: Mark::Dot,
            colour,
            words,
        });
        legend::draw(canvas, [legend::LEFT, 66], &entries)?;
        let axes = Axes {
            margins: Margins {
                top: TITLE_HEIGHT,
                right: EDGE,
                left: 20,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: AXIS_HEIGHT,
                labels: None,
                write: &|value| wording::decimals(*value, 3),
                name: against.axis(),
            },
            y: Axis {
                room: AXIS_WIDTH,
                labels: None,
                write: &|um| wording::decimals(*um, 6),
                name: "residual, µm",
            },
        };
        let mut chart = axes.draw(
            canvas,
            first - margin..last + margin,
            -1.1 * largest..1.1 * largest,
        )?;
        let zero = [(first - margin, 0.0), (last + margin, 0.0)];
        chart.draw_series([PathElement::new(zero, INK.stroke_width(1))])?;
        for (component, colour) in COLOURS.into_iter().enumerate() {
            let residual = |residuals: &[f64; 2]| residuals.get(component).copied().unwrap_or(0.0);
            chart.draw_series(places.iter().step_by(step).map(|(place, residuals)| {
                Circle::new((*place, residual(residuals)), 3, colour.mix(0.35).filled())
            }))?;
            let means = means(&places, residual);
            chart.draw_series([PathElement::new(means, colour.stroke_width(4))])?;
        }
        Ok(())
    })
}

/// Returns the means of groups of equal numbers, at the mean place; equal places stay in one group.
fn means(places: &[(f64, [f64; 2])], residual: impl Fn(&[f64; 2]) -> f64) -> Vec<(f64, f64)> {
    let least = places.len().div_ceil(MEANS).max(1);
    let mut means = Vec::new();
    let mut sums = (0.0, 0.0, 0.0);
    let mut count = 0;
    let mut places = places.iter().peekable();
    while let Some((place, residuals)) = places.next() {
        count += 1;
        sums = (sums.0 + 1.0, sums.1 + place, sums.2 + residual(residuals));
        let goes_on = places
            .peek()
            .is_some_and(|(next, _)| count < least || next <= place);
        if !goes_on {
            means.push((sums.1 / sums.0, sums.2 / sums.0));
            sums = (0.0, 0.0, 0.0);
            count = 0;
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_one_place_share_a_mean() {
        let places: Vec<(f64, [f64; 2])> = (0..100)
            .map(|index| (f64::from(index / 50), [f64::from(index % 2), 0.0]))
            .collect();
        let means = means(&places, |[x, _]| *x);
        assert_eq!(means.len(), 2);
        assert!(means.iter().all(|(_, mean)| (mean - 0.5).abs() < 1e-12));
    }
}
