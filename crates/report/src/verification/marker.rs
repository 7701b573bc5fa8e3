//! Markers and colours of the treatments and the run-up strategies in figures.

use fmc_reference::verification::result::Treatment;
use plotters::prelude::{Color, RGBColor, ShapeStyle};

/// Corners of a marker, pixels from its point.
pub(super) type Corners = Vec<(i32, i32)>;

/// Colour of a treatment (Okabe and Ito's palette, safe for the colour-blind).
pub(super) const fn colour(treatment: Treatment) -> RGBColor {
    match treatment {
        Treatment::None => RGBColor(95, 95, 95),
        Treatment::Static => RGBColor(0, 114, 178),
        Treatment::Printed => RGBColor(213, 94, 0),
        Treatment::Camera => RGBColor(0, 140, 100),
    }
}

/// Returns the filled shape of a treatment: octagon, square, triangle, diamond.
pub(super) fn corners(treatment: Treatment) -> Corners {
    match treatment {
        Treatment::None => vec![
            (-2, -6),
            (2, -6),
            (6, -2),
            (6, 2),
            (2, 6),
            (-2, 6),
            (-6, 2),
            (-6, -2),
        ],
        Treatment::Static => vec![(-6, -6), (6, -6), (6, 6), (-6, 6)],
        Treatment::Printed => vec![(0, -8), (8, 6), (-8, 6)],
        Treatment::Camera => vec![(0, -8), (8, 0), (0, 8), (-8, 0)],
    }
}

/// Returns the outline of the hollow marker, closed and wider, so that it shows around a filled
/// one.
pub(super) fn outline(treatment: Treatment) -> Corners {
    let mut outline: Corners = corners(treatment)
        .into_iter()
        .map(|(x, y)| (x * 3 / 2, y * 3 / 2))
        .collect();
    outline.extend(outline.first().copied());
    outline
}

/// Returns true if the marker is hollow: a centred run-up is, every other is filled.
pub(super) fn is_hollow(strategy: &str) -> bool {
    strategy == "centred"
}

pub(super) fn filled(treatment: Treatment) -> ShapeStyle {
    colour(treatment).filled()
}

pub(super) fn hollow(treatment: Treatment) -> ShapeStyle {
    colour(treatment).stroke_width(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn treatments_differ_in_colour_and_in_shape() {
        for (index, one) in Treatment::ALL.iter().enumerate() {
            for other in &Treatment::ALL[index + 1..] {
                assert_ne!(colour(*one), colour(*other));
                assert_ne!(corners(*one), corners(*other));
            }
        }
    }
}
