//! Text of a picture, letter by letter in its own font.

use ab_glyph::{Font, Glyph, OutlinedGlyph, PxScale, ScaleFont, point};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendTextStyle, DrawingBackend, FontTransform,
};

use super::{Drawn, Picture, signed};
use crate::figure::ems;

impl Picture<'_> {
    /// Draws a line of text at its anchor.
    pub(super) fn letter<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        anchor: BackendCoord,
    ) -> Drawn {
        let em = ems(style.size());
        let (glyphs, length) = self.line(text, em);
        let right = match style.anchor().h_pos {
            HPos::Left => 0.0,
            HPos::Center => -length / 2.0,
            HPos::Right => -length,
        };
        // The offsets put the baseline where plotters puts it in SVG; half an em is the height of
        // an x there.
        let down = match style.anchor().v_pos {
            VPos::Top => 0.76 * em,
            VPos::Center => 0.25 * em,
            VPos::Bottom => -0.25 * em,
        };
        let place = Place {
            anchor,
            turn: style.transform(),
        };
        for mut glyph in glyphs {
            glyph.position += point(right, down);
            // A blank has no outline.
            if let Some(outline) = self.font.outline_glyph(glyph) {
                self.draw_glyph(&outline, &place, style.color())?;
            }
        }
        Ok(())
    }

    /// Returns the glyphs of a line of text that starts at the origin, on the axis x, and its
    /// length.
    fn line(&self, text: &str, em: f32) -> (Vec<Glyph>, f32) {
        let units = self.font.units_per_em().unwrap_or(1.0);
        let scale = PxScale::from(em * self.font.height_unscaled() / units);
        let font = self.font.as_scaled(scale);
        let mut glyphs: Vec<Glyph> = Vec::new();
        let mut length = 0.0;
        for character in text.chars() {
            let id = font.glyph_id(character);
            if let Some(before) = glyphs.last() {
                length += font.kern(before.id, id);
            }
            glyphs.push(id.with_scale_and_position(scale, point(length, 0.0)));
            length += font.h_advance(id);
        }
        (glyphs, length)
    }

    fn draw_glyph(&mut self, glyph: &OutlinedGlyph, place: &Place, color: BackendColor) -> Drawn {
        let corner = glyph.px_bounds().min;
        let mut drawn = Ok(());
        glyph.draw(|x, y, coverage| {
            let pixel = place.pixel([whole(corner.x) + signed(x), whole(corner.y) + signed(y)]);
            let alpha = color.alpha * f64::from(coverage.clamp(0.0, 1.0));
            if drawn.is_ok() && alpha > 0.0 {
                drawn = self.draw_pixel(pixel, BackendColor { alpha, ..color });
            }
        });
        drawn
    }
}

/// Place of a text, and its rotation about that point.
struct Place {
    anchor: BackendCoord,
    turn: FontTransform,
}

impl Place {
    /// Returns the pixel of the figure for a pixel of a text that starts at the origin and runs to
    /// the right.
    fn pixel(&self, [right, down]: [i32; 2]) -> BackendCoord {
        let (x, y) = self.anchor;
        match self.turn {
            FontTransform::Rotate90 => (x - down - 1, y + right),
            FontTransform::Rotate180 => (x - right - 1, y - down - 1),
            FontTransform::Rotate270 => (x + down, y - right - 1),
            FontTransform::None => (x + right, y + down),
        }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "pixels of a glyph's edge, whole numbers; the cast saturates"
)]
fn whole(pixels: f32) -> i32 {
    pixels as i32
}

#[cfg(test)]
mod tests {
    use ab_glyph::FontRef;
    use plotters::element::Text;
    use plotters::style::text_anchor::Pos;

    use super::super::tests::darkness;
    use super::*;
    use crate::figure::text_at;

    /// Returns middle and number of the dark pixels of a text in the middle of a white square.
    fn drawn(text: &str, horizontal: HPos, turn: FontTransform) -> ([f64; 2], usize) {
        let pixels = darkness(|canvas| {
            let style = text_at(25, horizontal).transform(turn);
            canvas.draw(&Text::new(text, (100, 100), style))?;
            Ok(())
        });
        let dark: Vec<[f64; 2]> = pixels
            .into_iter()
            .filter_map(|(place, darkness)| (darkness > 0.6).then_some(place))
            .collect();
        let middle = [0, 1].map(|axis| {
            let places = || dark.iter().map(|place| place[axis]);
            0.5 * (places().fold(f64::INFINITY, f64::min) + places().fold(0.0, f64::max))
        });
        (middle, dark.len())
    }

    #[test]
    fn text_is_drawn_without_an_installed_font() {
        assert_eq!(drawn("", HPos::Left, FontTransform::None).1, 0);
        assert_eq!(drawn(" ", HPos::Left, FontTransform::None).1, 0);
        let font = FontRef::try_from_slice(dejavu::sans::regular()).unwrap();
        for text in ["K_d1", "δ, µm", "10⁻⁹ mm⁻²"] {
            let (_, count) = drawn(text, HPos::Left, FontTransform::None);
            assert!(count > 100, "{text}: {count}");
            for character in text.chars() {
                assert_ne!(font.glyph_id(character).0, 0, "{character}");
            }
        }
    }

    #[test]
    fn text_hangs_from_its_point_or_stands_on_it() {
        let middle = |vertical, turn| {
            let pixels = darkness(|canvas| {
                let anchor = Pos::new(HPos::Left, vertical);
                let style = text_at(25, HPos::Left).pos(anchor).transform(turn);
                canvas.draw(&Text::new("HHHH", (100, 100), style))?;
                Ok(())
            });
            let dark = pixels.into_iter().filter(|(_, darkness)| *darkness > 0.6);
            let places: Vec<[f64; 2]> = dark.map(|(place, _)| place).collect();
            [0, 1].map(|axis| {
                let along = || places.iter().map(|place| place[axis]);
                let ends = [
                    along().fold(f64::INFINITY, f64::min),
                    along().fold(0.0, f64::max),
                ];
                0.5 * (ends[0] + ends[1]) - 100.0
            })
        };
        // The baseline is 0.76 em below the point, or 0.25 em above it; the middle of capitals of
        // 20 pixels per em is 7.3 pixels above the baseline.
        for (vertical, expected) in [(VPos::Top, 15.2 - 7.3), (VPos::Bottom, -5.0 - 7.3)] {
            let [_, down] = middle(vertical, FontTransform::None);
            assert!((down - expected).abs() < 1.1, "{down} {expected}");
            let [across, _] = middle(vertical, FontTransform::Rotate270);
            assert!((across - expected).abs() < 1.1, "{across} {expected}");
        }
    }

    #[test]
    fn text_stands_at_its_point_and_is_turned_about_it() {
        let middle = |horizontal, turn| drawn("HHHH", horizontal, turn).0;
        let [right, down] = middle(HPos::Left, FontTransform::None).map(|place| place - 100.0);
        // Capitals of 20 pixels per em, 0.75 em wide and 0.73 high, stand on a line 0.25 em lower.
        assert!((right - 30.0).abs() < 2.0, "{right}");
        assert!((down + 2.3).abs() < 1.0, "{down}");
        for (horizontal, turn, expected) in [
            (HPos::Center, FontTransform::None, [0.0, down]),
            (HPos::Right, FontTransform::None, [-right, down]),
            (HPos::Left, FontTransform::Rotate90, [-down, right]),
            (HPos::Left, FontTransform::Rotate180, [-right, -down]),
            (HPos::Left, FontTransform::Rotate270, [down, -right]),
        ] {
            let found = middle(horizontal, turn).map(|place| place - 100.0);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1.1, "{found} {expected}");
            }
        }
    }
}
