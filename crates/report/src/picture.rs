//! Figures as PNG, drawn by the code that draws them as SVG. Text, discs, and vertical and
//! horizontal strokes wider than a pixel look as in a viewer of the SVG, other shapes as plotters
//! draws them.

use std::error::Error;
use std::io;

use ab_glyph::{Font, FontRef, Glyph, OutlinedGlyph, PxScale, ScaleFont, point};
use plotters::prelude::{BitMapBackend, IntoDrawingArea};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use crate::figure::{Area, FigureError, ems};

/// Number of bytes of a pixel: red, green, blue.
const PIXEL: usize = 3;

/// A figure of pixels with the font of its text, so that no font need be installed.
pub(crate) struct Picture<'a> {
    pixels: BitMapBackend<'a>,
    font: FontRef<'static>,
}

type Drawn = Result<(), DrawingErrorKind<io::Error>>;

/// Draws a figure of that many pixels as PNG, on white.
///
/// # Errors
/// [`FigureError`] if the drawing fails.
pub(crate) fn png(
    (width, height): (u32, u32),
    draw: impl FnOnce(&Area<Picture<'_>>) -> Result<(), FigureError>,
) -> Result<Vec<u8>, FigureError> {
    let failed = |error: &dyn Error| FigureError::Picture(error.to_string());
    let bytes = u64::from(width) * u64::from(height) * PIXEL as u64;
    let mut pixels = vec![0; usize::try_from(bytes).map_err(|error| failed(&error))?];
    {
        let font = FontRef::try_from_slice(dejavu::sans::regular());
        let picture = Picture {
            pixels: BitMapBackend::with_buffer(&mut pixels, (width, height)),
            font: font.map_err(|error| failed(&error))?,
        };
        let canvas = picture.into_drawing_area();
        canvas.fill(&plotters::style::WHITE)?;
        draw(&canvas)?;
        canvas.present()?;
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder
        .write_header()
        .and_then(|mut writer| {
            writer.write_image_data(&pixels)?;
            writer.finish()
        })
        .map_err(|error| failed(&error))?;
    Ok(file)
}

impl Picture<'_> {
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

    fn draw_disc(&mut self, (x, y): BackendCoord, radius: u32, color: BackendColor) -> Drawn {
        let reach = signed(radius) + 1;
        for down in -reach..reach {
            for right in -reach..reach {
                let alpha = color.alpha * disc_coverage(radius, [right, down]);
                self.draw_pixel((x + right, y + down), BackendColor { alpha, ..color })?;
            }
        }
        Ok(())
    }
}

/// Approximates the share of a pixel that a disc about the origin covers.
fn disc_coverage(radius: u32, [right, down]: [i32; 2]) -> f64 {
    let [x, y] = [right, down].map(|pixels| f64::from(pixels) + 0.5);
    (f64::from(radius) + 0.5 - x.hypot(y)).clamp(0.0, 1.0)
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

fn signed(pixels: u32) -> i32 {
    i32::try_from(pixels).unwrap_or(i32::MAX)
}

/// Backend that draws text, discs, and vertical and horizontal strokes wider than a pixel, and
/// leaves the rest to plotters.
impl DrawingBackend for Picture<'_> {
    type ErrorType = io::Error;

    fn get_size(&self) -> (u32, u32) {
        self.pixels.get_size()
    }

    fn ensure_prepared(&mut self) -> Drawn {
        self.pixels.ensure_prepared().map_err(plainly)
    }

    fn present(&mut self) -> Drawn {
        self.pixels.present().map_err(plainly)
    }

    fn draw_pixel(&mut self, point: BackendCoord, color: BackendColor) -> Drawn {
        self.pixels.draw_pixel(point, color).map_err(plainly)
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        let width = signed(style.stroke_width());
        let [left, right] = [from.0.min(to.0), from.0.max(to.0)];
        let [top, bottom] = [from.1.min(to.1), from.1.max(to.1)];
        // Plotters would draw two pixels as three.
        if width > 1 && left == right {
            let left = left - width / 2;
            self.draw_rect((left, top), (left + width, bottom), style, true)
        } else if width > 1 && top == bottom {
            let top = top - width / 2;
            self.draw_rect((left, top), (right, top + width), style, true)
        } else {
            self.pixels.draw_line(from, to, style).map_err(plainly)
        }
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        bottom_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        self.pixels
            .draw_rect(upper_left, bottom_right, style, fill)
            .map_err(plainly)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let path: Vec<BackendCoord> = path.into_iter().collect();
        match *path {
            [from, to] => self.draw_line(from, to, style),
            _ => self.pixels.draw_path(path, style).map_err(plainly),
        }
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        if fill {
            self.draw_disc(center, radius, style.color())
        } else {
            self.pixels
                .draw_circle(center, radius, style, fill)
                .map_err(plainly)
        }
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        self.pixels.fill_polygon(corners, style).map_err(plainly)
    }

    fn draw_text<S: BackendTextStyle>(
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
}

fn plainly<E: Error + Send + Sync + 'static>(
    error: DrawingErrorKind<E>,
) -> DrawingErrorKind<io::Error> {
    match error {
        DrawingErrorKind::DrawingError(error) => {
            DrawingErrorKind::DrawingError(io::Error::other(error))
        }
        DrawingErrorKind::FontError(error) => DrawingErrorKind::FontError(error),
    }
}

#[cfg(test)]
mod tests {
    use plotters::element::{Circle, PathElement, Rectangle, Text};
    use plotters::prelude::Color;
    use plotters::style::BLACK;
    use plotters::style::text_anchor::Pos;

    use super::*;
    use crate::figure::text_at;

    const SIZE: (u32, u32) = (200, 200);

    /// Draws on a white square and returns how dark each pixel is, from 0 to 1.
    fn darkness(
        draw: impl FnOnce(&Area<Picture<'_>>) -> Result<(), FigureError>,
    ) -> Vec<([f64; 2], f64)> {
        let file = png(SIZE, draw).unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(file))
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), SIZE);
        let place = |index| [index % SIZE.0, index / SIZE.0].map(|i| f64::from(i) + 0.5);
        (0_u32..)
            .zip(pixels.as_chunks::<PIXEL>().0)
            .map(|(index, [red, _, _])| (place(index), 1.0 - f64::from(*red) / 255.0))
            .collect()
    }

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
        // The baseline is 0.76 em below the point, or 0.25 em above it; the middle of capitals of 20 pixels per em is
        // 7.3 pixels above the baseline.
        for (vertical, expected) in [(VPos::Top, 15.2 - 7.3), (VPos::Bottom, -5.0 - 7.3)] {
            let [_, down] = middle(vertical, FontTransform::None);
            assert!((down - expected).abs() < 1.1, "{down} {expected}");
            let [across, _] = middle(vertical, FontTransform::Rotate270);
            assert!((across - expected).abs() < 1.1, "{across} {expected}");
        }
    }

    #[test]
    fn mixed_colour_covers_in_part_and_edges_cut_off() {
        let pixels = darkness(|canvas| {
            let pale = BLACK.mix(0.25).filled();
            canvas.draw(&Circle::new((100, 100), 4, pale))?;
            canvas.draw(&Rectangle::new([(20, 20), (29, 29)], pale))?;
            for corner in [(0, 0), (199, 199)] {
                canvas.draw(&Circle::new(corner, 4, BLACK.filled()))?;
                canvas.draw(&Text::new("HHHH", corner, text_at(25, HPos::Center)))?;
            }
            Ok(())
        });
        let at = |x: f64, y: f64| {
            let is_it = |([at_x, at_y], _): &&([f64; 2], f64)| {
                (at_x - x - 0.5).abs() < 0.1 && (at_y - y - 0.5).abs() < 0.1
            };
            pixels.iter().find(is_it).unwrap().1
        };
        for (x, y) in [(100.0, 100.0), (25.0, 25.0)] {
            assert!((at(x, y) - 0.25).abs() < 0.01, "{}", at(x, y));
        }
        assert!(at(0.0, 0.0) > 0.99 && at(199.0, 199.0) > 0.99);
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

    #[test]
    fn disc_and_strokes_cover_what_they_are() {
        let pixels = darkness(|canvas| {
            canvas.draw(&Circle::new((50, 60), 4, BLACK.filled()))?;
            for line in [[(100, 20), (100, 50)], [(150, 100), (120, 100)]] {
                canvas.draw(&PathElement::new(line, Color::stroke_width(&BLACK, 2)))?;
            }
            Ok(())
        });
        let covered = |[left, top]: [f64; 2], [right, bottom]: [f64; 2]| -> f64 {
            let within = |[x, y]: [f64; 2]| x > left && x < right && y > top && y < bottom;
            let within = pixels.iter().filter(|(place, _)| within(*place));
            within.map(|(_, darkness)| darkness).sum()
        };
        let all = covered([0.0; 2], [200.0; 2]);
        let disc = covered([45.0, 55.0], [55.0, 65.0]);
        assert!((disc - 16.0 * std::f64::consts::PI).abs() < 1.0, "{disc}");
        let left = covered([45.0, 55.0], [50.0, 65.0]);
        assert!((left - disc / 2.0).abs() < 1e-9, "{left} {disc}");
        let strokes = [
            covered([99.0, 20.0], [101.0, 50.0]),
            covered([120.0, 99.0], [150.0, 101.0]),
        ];
        for stroke in strokes {
            assert!((stroke - 60.0).abs() < 1e-9, "{stroke}");
        }
        assert!((all - disc - 120.0).abs() < 1e-9, "{all}");
    }
}
