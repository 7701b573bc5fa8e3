//! The five coefficients against δ: Fig. 3 of Yuan et al. 2012, with error bars.

use std::ops::Range;

use fmc_camera::geometry::estimation::parameter::Parameter;
use fmc_simulation::sweep::result::{FrameFit, Sweep};
use plotters::chart::ChartContext;
use plotters::coord::cartesian::Cartesian2d;
use plotters::coord::ranged1d::Ranged;
use plotters::element::{Circle, EmptyElement, PathElement, Rectangle, Text};
use plotters::prelude::{Color, RGBColor};

use super::power;
use super::results::{COEFFICIENTS, per};
use crate::chart::{Axes, Axis, Margins};
use crate::figure::{self, Area, Backend, FONT, FigureError, INK, SMALL, TITLE, WIDTH, text};
use crate::{picture, wording};

const SIZE: (u32, u32) = (WIDTH, 1130);
const TITLE_HEIGHT: u32 = 80;
/// Colour of an estimate from one exposure.
const FRAME: RGBColor = RGBColor(0, 114, 178);
/// Colour of the estimate from all exposures together.
const WHOLE: RGBColor = RGBColor(213, 94, 0);

/// Draws five panels and a legend, in SVG.
///
/// # Errors
/// [`FigureError`] without exposures or if the drawing fails.
pub fn svg(sweep: &Sweep) -> Result<String, FigureError> {
    figure::svg(SIZE, |canvas| draw(canvas, sweep))
}

/// Draws the same as PNG.
///
/// # Errors
/// As [`svg`].
pub fn png(sweep: &Sweep) -> Result<Vec<u8>, FigureError> {
    picture::png(SIZE, |canvas| draw(canvas, sweep))
}

fn draw<B: Backend>(canvas: &Area<B>, sweep: &Sweep) -> Result<(), FigureError> {
    let frames = &sweep.both().frames;
    if frames.is_empty() {
        return Err(FigureError::NothingToDraw);
    }
    let longest_mm = frames.iter().map(|f| f.travel_mm).fold(0.0, f64::max);
    let travel_um = 0.0..(1e3 * longest_mm * 1.03).max(1e-3);
    canvas.draw(&Text::new(sweep.camera.clone(), (20, 24), text(TITLE)))?;
    let words = "coefficients of each exposure against δ";
    canvas.draw(&Text::new(words, (20, 56), text(FONT)))?;
    let (_, panels) = canvas.split_vertically(TITLE_HEIGHT);
    let panels = panels.split_evenly((3, 2));
    for (panel, (parameter, unit)) in panels.iter().zip(COEFFICIENTS) {
        draw_panel(panel, sweep, parameter, unit, travel_um.clone())?;
    }
    if let Some(legend) = panels.last() {
        draw_legend(legend, sweep)?;
    }
    Ok(())
}

/// Returns δ, value and standard deviation of one exposure.
fn estimate(frame: &FrameFit, parameter: Parameter) -> Option<(f64, f64, f64)> {
    let fit = frame.fit.as_ref().ok()?;
    Some((
        1e3 * frame.travel_mm,
        fit.value(parameter),
        fit.standard_deviation(parameter),
    ))
}

fn draw_panel<B: Backend>(
    panel: &Area<B>,
    sweep: &Sweep,
    parameter: Parameter,
    unit: &str,
    travel_um: Range<f64>,
) -> Result<(), FigureError> {
    let estimates: Vec<(f64, f64, f64)> = sweep
        .both()
        .frames
        .iter()
        .filter_map(|frame| estimate(frame, parameter))
        .collect();
    let truths: Vec<(f64, f64)> = sweep
        .both()
        .frames
        .iter()
        .filter_map(|frame| Some((1e3 * frame.travel_mm, sweep.truth(frame, parameter)?)))
        .collect();
    let symbol = parameter.symbol();
    if estimates.is_empty() {
        for (line, words) in [
            format!("{symbol}: no number"),
            "the adjustment has no solution".to_owned(),
        ]
        .into_iter()
        .enumerate()
        {
            let y = if line == 0 { 60 } else { 96 };
            panel.draw(&Text::new(words, (30, y), text(FONT)))?;
        }
        return Ok(());
    }
    let whole = sweep.both().whole.as_ref().ok();
    let whole = whole.map(|fit| (fit.value(parameter), fit.standard_deviation(parameter)));
    let band = whole.map(|(value, sigma)| (travel_um.start, value, sigma));
    let true_values: Vec<(f64, f64, f64)> = truths
        .iter()
        .map(|(um, value)| (*um, *value, 0.0))
        .collect();
    let (least, most) = estimates.iter().chain(&band).chain(&true_values).fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), (_, value, sigma)| (least.min(value - sigma), most.max(value + sigma)),
    );
    let exponent = power::exponent(least.abs().max(most.abs()));
    let scale = 10.0_f64.powi(-exponent);
    let room = (0.06 * (most - least)).max(1e-6 / scale);
    let values = scale * (least - room)..scale * (most + room);
    let quantity = [power::power_of_ten(exponent), unit.to_owned()];
    let quantity = if exponent == 0 {
        unit.to_owned()
    } else {
        quantity.join(" ").trim_end().to_owned()
    };
    let label = if quantity.is_empty() {
        symbol.to_owned()
    } else {
        format!("{symbol}, {quantity}")
    };
    let axes = Axes {
        margins: Margins {
            top: 14,
            right: 20,
            bottom: 6,
            left: 12,
        },
        font: FONT,
        x: Axis {
            room: 64,
            labels: Some(5),
            write: &|um| wording::decimals(*um, 1),
            name: "δ, µm",
        },
        y: Axis {
            room: 84,
            labels: Some(6),
            write: &|value| wording::decimals(*value, 4),
            name: &label,
        },
    };
    let mut chart = axes.draw(panel, travel_um.clone(), values)?;
    if let Some((value, sigma)) = whole {
        let corners = [
            (travel_um.start, scale * (value - sigma)),
            (travel_um.end, scale * (value + sigma)),
        ];
        chart.draw_series([Rectangle::new(corners, WHOLE.mix(0.25).filled())])?;
        let line = [travel_um.start, travel_um.end].map(|um| (um, scale * value));
        chart.draw_series([PathElement::new(line, WHOLE.stroke_width(2))])?;
    }
    chart.draw_series(estimates.iter().map(|(um, value, sigma)| {
        let bar = [value - sigma, value + sigma].map(|end| (*um, scale * end));
        PathElement::new(bar, FRAME.stroke_width(2))
    }))?;
    draw_truth(&mut chart, &truths, travel_um, scale)?;
    chart.draw_series(estimates.iter().map(|(um, value, _)| {
        EmptyElement::at((*um, scale * value)) + Circle::new((0, 0), 4, FRAME.filled())
    }))?;
    Ok(())
}

/// Draws the true values: one line if all exposures have the same, else a dash for each.
fn draw_truth<B: Backend, X, Y>(
    chart: &mut ChartContext<'_, B, Cartesian2d<X, Y>>,
    truths: &[(f64, f64)],
    travel_um: Range<f64>,
    scale: f64,
) -> Result<(), FigureError>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let Some((_, first)) = truths.first() else {
        return Ok(());
    };
    let stroke = INK.stroke_width(2);
    if truths
        .iter()
        .all(|(_, value)| (value - first).abs() <= 1e-9 * first.abs())
    {
        let line = [travel_um.start, travel_um.end].map(|um| (um, scale * first));
        chart.draw_series([PathElement::new(line, stroke)])?;
    } else {
        let half = 0.012 * (travel_um.end - travel_um.start);
        chart.draw_series(truths.iter().map(|(um, value)| {
            let dash = [um - half, um + half].map(|um| (um, scale * value));
            PathElement::new(dash, stroke)
        }))?;
    }
    Ok(())
}

fn draw_legend<B: Backend>(legend: &Area<B>, sweep: &Sweep) -> Result<(), FigureError> {
    let (left, column) = (24, 66);
    let words = |y: i32, words: &str| Text::new(words.to_owned(), (column, y), text(SMALL));
    let centre = left + 15;
    let error_bar = [(centre, 8), (centre, 40)];
    legend.draw(&PathElement::new(error_bar, FRAME.stroke_width(2)))?;
    legend.draw(&Circle::new((centre, 24), 4, FRAME.filled()))?;
    legend.draw(&words(24, "one exposure, ± 1 σ"))?;
    let band = [(left, 50), (left + 30, 70)];
    legend.draw(&Rectangle::new(band, WHOLE.mix(0.25).filled()))?;
    let line = |y: i32| [(left, y), (left + 30, y)];
    legend.draw(&PathElement::new(line(60), WHOLE.stroke_width(2)))?;
    legend.draw(&words(60, "all exposures together, ± 1 σ"))?;
    legend.draw(&PathElement::new(line(96), INK.stroke_width(2)))?;
    legend.draw(&words(96, "truth; K_d1, P_m1: of K1 alone"))?;
    let options = &sweep.options;
    let lines = [
        "δ: travel of the principal point".to_owned(),
        "while the shutter is open".to_owned(),
        format!("K_d1, P_m1: per mm of {}", per(options.regressor)),
        format!("K1 of the lens: {:.3e} mm⁻²", sweep.k1),
        wording::strategy(sweep.strategy).to_owned(),
        format!("noise {} µm", wording::decimals(1e3 * options.noise_mm, 4)),
        format!(
            "focus shift {} µm, seed {}",
            wording::decimals(1e3 * options.focus_shift_mm, 4),
            options.seed
        ),
    ];
    let mut y = 138;
    for line in lines {
        legend.draw(&Text::new(line, (left, y), text(SMALL)))?;
        y += 29;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::fixture;

    #[test]
    fn every_exposure_has_a_mark_in_every_panel() {
        let svg = svg(&fixture::sweep("from-rest")).unwrap();
        // The legend has one more circle.
        assert_eq!(svg.matches("<circle").count(), 5 * 60 + 1);
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        for label in ["K_m0", "K_m1", "K_m2", "K_d1", "P_m1", "δ, µm", "mm⁻⁴"] {
            assert!(svg.contains(label), "{label}");
        }
    }

    #[test]
    fn fitted_coefficients_lie_about_the_truth() {
        let sweep = fixture::sweep("from-rest");
        let frames = &sweep.both().frames;
        for (parameter, _) in COEFFICIENTS {
            let off: Vec<f64> = frames
                .iter()
                .map(|frame| {
                    let (_, value, sigma) = estimate(frame, parameter).unwrap();
                    (value - sweep.truth(frame, parameter).unwrap()) / sigma
                })
                .collect();
            let within = off.iter().filter(|off| off.abs() < 3.0).count();
            assert!(within >= 57, "{}: {off:?}", parameter.symbol());
        }
        let k1 = 1e-7;
        let first = &frames[0];
        let ratio = sweep.truth(first, Parameter::Kd1).unwrap() / k1;
        assert!(
            (ratio + 2.0).abs() < 1e-9,
            "per mm of the centroid: {ratio}"
        );
        assert!((sweep.true_km0.unwrap() - 6e-5).abs() < 1e-12);
    }

    #[test]
    fn coefficients_that_do_not_exist_are_not_drawn() {
        let svg = svg(&fixture::sweep("centred")).unwrap();
        assert_eq!(svg.matches("<circle").count(), 1);
        assert!(svg.contains("K_d1: no number"));
    }
}
