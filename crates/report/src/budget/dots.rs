//! The terms of a budget as dots on a logarithmic axis.

use fmc_simulation::budget::result::{Budget, Kind, Term};
use plotters::element::{Circle, PathElement, Text};
use plotters::prelude::{Color, RGBColor};
use plotters::style::text_anchor::HPos;

use super::results;
use crate::figure::{
    self, Area, Backend, FONT, FigureError, GRID, INK, SMALL, TITLE, WIDTH, pixels, text, text_at,
};
use crate::legend::{self, Entry, Mark};
#[cfg(feature = "full")]
use crate::picture;

const TOP: i32 = 150;
/// Height of a row: the name of the term, and below it the dot.
const ROW: i32 = 58;
const LEFT: i32 = 40;
const RIGHT: i32 = 710;
/// Right end of the numbers.
const NUMBERS: i32 = 826;
/// Radius of the dots.
const RADIUS: u32 = 8;
/// Decades of the axis, powers of ten of a micrometre; the axis is longer if a term needs it.
const DECADES: [i32; 2] = [-4, 3];
/// Last decade of any axis.
const LAST_DECADE: i32 = 9;
const REMOVED: RGBColor = RGBColor(0, 114, 178);
const REMAINS: RGBColor = RGBColor(213, 94, 0);
const SMEAR: RGBColor = RGBColor(150, 150, 150);

/// Draws a dot per term that the axis reaches, over the limits, in SVG.
///
/// # Errors
/// [`FigureError`] without terms or if the drawing fails.
pub fn svg(budget: &Budget) -> Result<String, FigureError> {
    figure::svg(size(budget)?, |canvas| draw(canvas, budget))
}

/// Draws the same as PNG.
///
/// # Errors
/// As [`svg`].
#[cfg(feature = "full")]
pub fn png(budget: &Budget) -> Result<Vec<u8>, FigureError> {
    picture::png(size(budget)?, |canvas| draw(canvas, budget))
}

/// Returns the lower end of the rows.
fn bottom(budget: &Budget) -> i32 {
    let rows = i32::try_from(budget.terms.len()).unwrap_or(0);
    TOP + rows * ROW
}

fn size(budget: &Budget) -> Result<(u32, u32), FigureError> {
    match bottom(budget) {
        TOP => Err(FigureError::NothingToDraw),
        bottom => Ok((WIDTH, bottom.unsigned_abs() + 70)),
    }
}

fn draw<B: Backend>(canvas: &Area<B>, budget: &Budget) -> Result<(), FigureError> {
    let bottom = bottom(budget);
    let title = format!("{}: largest effect over its limits, µm", budget.camera);
    canvas.draw(&Text::new(title, (20, 30), text(TITLE)))?;
    let entries = [
        (REMOVED, "position; fmc-camera removes it"),
        (REMAINS, "position; remains"),
        (SMEAR, "smear; remains"),
    ];
    let entries = entries.map(|(colour, words)| Entry {
        mark: Mark::Dot,
        colour,
        words,
    });
    legend::draw(canvas, [legend::LEFT, 74], &entries)?;
    let decades = decades(budget);
    let place = |um| place(um, decades);
    let [first, last] = decades;
    for decade in first..=last {
        let x = place(10.0_f64.powi(decade));
        canvas.draw(&PathElement::new(
            [(x, TOP - 10), (x, bottom)],
            GRID.stroke_width(1),
        ))?;
        let label = format!("{}", 10.0_f64.powi(decade));
        canvas.draw(&Text::new(
            label,
            (x, bottom + 20),
            text_at(SMALL, HPos::Center),
        ))?;
    }
    canvas.draw(&Text::new(
        "µm",
        (NUMBERS, bottom + 20),
        text_at(SMALL, HPos::Right),
    ))?;
    // The line marks one pixel.
    let x = place(1e3 * budget.pixel_mm);
    canvas.draw(&PathElement::new(
        [(x, TOP - 10), (x, bottom)],
        INK.stroke_width(2),
    ))?;
    canvas.draw(&Text::new(
        "1 px",
        (x, TOP - 24),
        text_at(SMALL, HPos::Center),
    ))?;
    let mut y = TOP;
    for term in &budget.terms {
        let label = results::assumed(budget, term.source);
        figure::draw_plate(canvas, &label, (LEFT, y + 16), &text(FONT))?;
        let middle = y + 42;
        // On a logarithmic axis a place has a meaning. A length has none, because it depends on the
        // beginning of the axis.
        canvas.draw(&PathElement::new(
            [(LEFT, middle), (RIGHT, middle)],
            GRID.stroke_width(1),
        ))?;
        let um = 1e3 * term.limits_mm;
        if um >= 10.0_f64.powi(first) {
            let dot = Circle::new((place(um), middle), RADIUS, colour(term).filled());
            canvas.draw(&dot)?;
        }
        canvas.draw(&Text::new(
            results::three_digits(1e3 * term.limits_mm),
            (NUMBERS, middle),
            text_at(FONT, HPos::Right),
        ))?;
        y += ROW;
    }
    Ok(())
}

fn colour(term: &Term) -> RGBColor {
    match (term.source.kind(), term.source.is_removed()) {
        (Kind::Smear, _) => SMEAR,
        (Kind::Position, true) => REMOVED,
        (Kind::Position, false) => REMAINS,
    }
}

/// Returns the decades that hold every term.
fn decades(budget: &Budget) -> [i32; 2] {
    let [first, last] = DECADES;
    let longest_um = budget
        .terms
        .iter()
        .fold(0.0, |most, term| f64::max(most, 1e3 * term.limits_mm));
    let holds = |decade: &i32| 10.0_f64.powi(*decade) >= longest_um;
    [
        first,
        (last..LAST_DECADE).find(holds).unwrap_or(LAST_DECADE),
    ]
}

/// Returns the place of a length in µm: the start of the axis, if the length does not reach it.
fn place(um: f64, decades: [i32; 2]) -> i32 {
    let [first, last] = decades.map(f64::from);
    let share = if um > 0.0 {
        ((um.log10() - first) / (last - first)).clamp(0.0, 1.0)
    } else {
        0.0
    };
    LEFT + pixels(share * f64::from(RIGHT - LEFT))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::fixture;

    #[test]
    fn every_term_has_its_dot_and_number_on_the_axis() {
        let budget = fixture::budget();
        let svg = svg(&budget).unwrap();
        let dots = svg.matches("<circle").count();
        let decades = decades(&budget);
        let least_um = 10.0_f64.powi(decades[0]);
        let reached = || {
            let terms = budget.terms.iter();
            terms.filter(|term| 1e3 * term.limits_mm >= least_um)
        };
        assert!(reached().count() > 5);
        assert_eq!(dots, reached().count() + 3, "three in the legend");
        for term in reached() {
            let x = place(1e3 * term.limits_mm, decades);
            assert!(svg.contains(&format!("<circle cx=\"{x}\"")), "{x}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        for um in [0.0, 1e-9, 1e9] {
            assert!((LEFT..=RIGHT).contains(&place(um, DECADES)));
        }
        assert_eq!(place(1.0, DECADES), 423);
    }
}
