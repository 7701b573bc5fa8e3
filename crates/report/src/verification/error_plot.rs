//! Error against the travel of the principal point, on a logarithmic axis.

use std::ops::Range;

use fmc_reference::verification::result::{CameraResult, MAX_ERROR_NM, Treatment};
use plotters::coord::combinators::IntoLogRange;
use plotters::element::{EmptyElement, PathElement, Polygon, Text};
use plotters::prelude::Color;

use super::marker;
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, Canvas, FONT, FigureError, INK, SMALL, TITLE, WIDTH, text};
use crate::wording;

const SIZE: (u32, u32) = (WIDTH, 830);
const TITLE_HEIGHT: u32 = 60;
const LEGEND_TOP: u32 = 650;
const AXIS_WIDTH: u32 = 110;
const AXIS_HEIGHT: u32 = 76;
/// Width for the name of the limit, right of the plot.
const EDGE: u32 = 76;
/// Left margin, on whose edge the vertical text is centred.
const EDGE_LEFT: u32 = 20;
/// Value at which smaller errors are drawn, as a logarithmic axis has no zero.
const LEAST_NM: f64 = 1e-3;

/// Draws the largest error of every exposure against δ, for all treatments, in SVG.
///
/// # Errors
/// [`FigureError`] without exposures or if the drawing fails.
pub fn error_against_travel(camera: &CameraResult) -> Result<String, FigureError> {
    if camera.frames.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    let errors_nm = range_nm(camera);
    let [_, longest_mm] = camera.travel_mm();
    let travel_um = 0.0..(1e3 * longest_mm * 1.03).max(1e-3);
    figure::svg(SIZE, |canvas| {
        let title = format!("{}: largest error of each exposure", camera.name);
        canvas.draw(&Text::new(title, (20, 30), text(TITLE)))?;
        let (upper, legend) = canvas.split_vertically(LEGEND_TOP);
        let axes = Axes {
            margins: Margins {
                top: TITLE_HEIGHT,
                right: EDGE,
                left: EDGE_LEFT,
                ..Margins::default()
            },
            font: FONT,
            x: Axis {
                room: AXIS_HEIGHT,
                labels: None,
                write: &|um| wording::decimals(*um, 1),
                name: "δ, µm: travel of the principal point while the shutter is open",
            },
            y: Axis {
                room: AXIS_WIDTH,
                labels: None,
                write: &|nm| decade_text(*nm),
                name: "largest error of dx or dy",
            },
        };
        let mut chart = axes.draw(&upper, travel_um.clone(), errors_nm.clone().log_scale())?;

        let limit = [
            (travel_um.start, MAX_ERROR_NM),
            (travel_um.end, MAX_ERROR_NM),
        ];
        chart.draw_series([PathElement::new(limit, INK.stroke_width(3))])?;
        let (right, y) = chart.backend_coord(&(travel_um.end, MAX_ERROR_NM));
        for (words, y) in [
            ("limit".to_owned(), y - 12),
            (format!("{MAX_ERROR_NM} nm"), y + 12),
        ] {
            canvas.draw(&Text::new(words, (right + 8, y), text(SMALL)))?;
        }

        for (index, treatment) in Treatment::ALL.into_iter().enumerate() {
            let places = |is_hollow: bool| {
                let errors_nm = errors_nm.clone();
                camera
                    .frames
                    .iter()
                    .filter(move |frame| marker::is_hollow(frame.strategy) == is_hollow)
                    .filter_map(move |frame| {
                        let error_nm = 1e6 * frame.errors.get(index)?.max_mm();
                        Some((1e3 * frame.travel_mm, drawn_nm(error_nm, &errors_nm)))
                    })
            };
            chart.draw_series(places(true).map(|place| {
                EmptyElement::at(place)
                    + PathElement::new(marker::outline(treatment), marker::hollow(treatment))
            }))?;
            chart.draw_series(places(false).map(|place| {
                EmptyElement::at(place)
                    + Polygon::new(marker::corners(treatment), marker::filled(treatment))
            }))?;
        }
        draw_legend(&legend, camera)?;
        Ok(())
    })
}

/// Returns whole decades around all errors and the limit.
fn range_nm(camera: &CameraResult) -> Range<f64> {
    let frames = camera.frames.iter();
    let (least, most) = frames
        .flat_map(|frame| frame.errors)
        .map(|errors| 1e6 * errors.max_mm())
        .filter(|error_nm| error_nm.is_finite() && *error_nm >= LEAST_NM)
        .fold((MAX_ERROR_NM, MAX_ERROR_NM), |(least, most), error_nm| {
            (least.min(error_nm), most.max(error_nm))
        });
    let decade = |exponent: f64| 10.0_f64.powf(exponent);
    // The range is slightly larger, so that the outermost decades get their lines.
    0.999 * decade(least.log10().floor())..1.001 * decade(most.log10().ceil())
}

/// Returns the value at which an error is drawn: the edge, if the axis does not reach it.
fn drawn_nm(error_nm: f64, range: &Range<f64>) -> f64 {
    if error_nm.is_finite() {
        error_nm.clamp(range.start, range.end)
    } else {
        range.end
    }
}

/// Writes a decade, `10 nm`, `1 µm`.
fn decade_text(nm: f64) -> String {
    if nm < 999.0 {
        format!("{} nm", wording::decimals(nm, 3))
    } else if nm < 999e3 {
        format!("{} µm", wording::decimals(nm / 1e3, 0))
    } else {
        format!("{} mm", wording::decimals(nm / 1e6, 0))
    }
}

/// Draws treatments by colour and shape, strategies by filling, below the axes.
fn draw_legend(legend: &Canvas<'_>, camera: &CameraResult) -> Result<(), FigureError> {
    let words = |x: i32, y: i32, words: String| Text::new(words, (x, y), text(FONT));
    let places = [(30, 20), (440, 20), (30, 54), (440, 54)];
    for (treatment, (x, y)) in Treatment::ALL.into_iter().zip(places) {
        legend.draw(
            &(EmptyElement::at((x, y))
                + PathElement::new(marker::outline(treatment), marker::hollow(treatment))),
        )?;
        legend.draw(
            &(EmptyElement::at((x + 28, y))
                + Polygon::new(marker::corners(treatment), marker::filled(treatment))),
        )?;
        legend.draw(&words(x + 50, y, treatment.label().to_owned()))?;
    }
    let mut strategies: Vec<&str> = camera.frames.iter().map(|frame| frame.strategy).collect();
    strategies.dedup();
    let fillings: Vec<String> = strategies
        .iter()
        .map(|strategy| {
            let filling = if marker::is_hollow(strategy) {
                "hollow"
            } else {
                "filled"
            };
            format!("{filling}: {}", wording::strategy(strategy))
        })
        .collect();
    legend.draw(&words(20, 96, fillings.join("; ")))?;
    let note = format!("under {LEAST_NM} nm: drawn on the lower edge");
    legend.draw(&Text::new(note, (20, 130), text(SMALL)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verification::fixture;

    #[test]
    fn every_exposure_has_a_marker_for_every_treatment() {
        let svg = error_against_travel(&fixture::camera("Alpha", 0.1)).unwrap();
        // Each colour has a centred exposure, one from rest, and a legend entry for each.
        for colour in ["#5F5F5F", "#0072B2", "#D55E00", "#008C64"] {
            assert_eq!(svg.matches(&format!("fill=\"{colour}\"")).count(), 2);
            assert_eq!(svg.matches(&format!("stroke=\"{colour}\"")).count(), 2);
        }
        assert!(svg.contains("limit\n") && svg.contains("1.5 nm"));
    }

    #[test]
    fn zero_and_infinite_errors_stay_on_the_axis() {
        let mut camera = fixture::camera("Alpha", 0.0);
        camera.frames[0].errors[0].add([f64::INFINITY, 0.0]);
        let svg = error_against_travel(&camera).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let range = range_nm(&camera);
        assert!((drawn_nm(0.0, &range) - range.start).abs() < 1e-12);
        assert!((drawn_nm(f64::NAN, &range) - range.end).abs() < 1e-12);
    }

    #[test]
    fn axis_is_labelled_in_readable_units() {
        let labels = [0.1, 1.0, 100.0, 1e3, 1e5, 1e6].map(decade_text);
        assert_eq!(
            labels,
            ["0.1 nm", "1 nm", "100 nm", "1 µm", "100 µm", "1 mm"]
        );
    }
}
