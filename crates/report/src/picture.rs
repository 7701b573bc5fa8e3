//! Figures as PNG, drawn by the code that draws them as SVG. Text, discs, and vertical and
//! horizontal strokes wider than a pixel look as in a viewer of the SVG, other shapes as plotters
//! draws them.

mod lettering;

use std::error::Error;
use std::io;

use ab_glyph::FontRef;
use plotters::prelude::{BitMapBackend, IntoDrawingArea};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};

use crate::figure::{Area, FigureError};

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
        self.letter(text, style, anchor)
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
    use plotters::style::text_anchor::HPos;

    use super::*;
    use crate::figure::text_at;

    const SIZE: (u32, u32) = (200, 200);

    /// Draws on a white square and returns how dark each pixel is, from 0 to 1.
    pub(super) fn darkness(
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
