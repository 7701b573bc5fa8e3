//! Figures in the PDF, drawn by the code that draws them as SVG.

use std::io;

use fmc_report::figure::ems;
use krilla::color::rgb;
use krilla::geom::{PathBuilder, Point, Transform};
use krilla::num::NormalizedF32;
use krilla::paint::{Fill, Stroke};
use krilla::surface::Surface;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use super::typeface::{Typeface, Weight};

/// Share of the radius at which the control points of a circle's quarter lie (Riškus 2006).
const QUARTER: f32 = 0.551_915;

/// A figure on a page; the surface is scaled to its pixels.
pub(super) struct Canvas<'a, 'p> {
    pub(super) surface: &'a mut Surface<'p>,
    pub(super) typeface: &'a Typeface,
    pub(super) size: (u32, u32),
}

type Drawn = Result<(), DrawingErrorKind<io::Error>>;

fn opacity(color: BackendColor) -> NormalizedF32 {
    NormalizedF32::new(fmc_camera_file::number::single(color.alpha)).unwrap_or(NormalizedF32::ONE)
}

fn fill(color: BackendColor) -> Fill {
    let (red, green, blue) = color.rgb;
    Fill {
        paint: rgb::Color::new(red, green, blue).into(),
        opacity: opacity(color),
        ..Fill::default()
    }
}

fn stroke<S: BackendStyle>(style: &S) -> Stroke {
    let (red, green, blue) = style.color().rgb;
    Stroke {
        paint: rgb::Color::new(red, green, blue).into(),
        width: length(style.stroke_width()),
        opacity: opacity(style.color()),
        ..Stroke::default()
    }
}

fn length(pixels: u32) -> f32 {
    f32::from(u16::try_from(pixels).unwrap_or(u16::MAX))
}

fn place((x, y): BackendCoord) -> [f32; 2] {
    [x, y].map(|pixels| {
        let pixels = pixels.clamp(i16::MIN.into(), i16::MAX.into());
        f32::from(i16::try_from(pixels).unwrap_or_default())
    })
}

impl Canvas<'_, '_> {
    fn path(
        &mut self,
        points: impl IntoIterator<Item = BackendCoord>,
        is_closed: bool,
        fill: Option<Fill>,
        stroke: Option<Stroke>,
    ) {
        let mut builder = PathBuilder::new();
        for (index, point) in points.into_iter().enumerate() {
            let [x, y] = place(point);
            if index == 0 {
                builder.move_to(x, y);
            } else {
                builder.line_to(x, y);
            }
        }
        if is_closed {
            builder.close();
        }
        self.draw(builder, fill, stroke);
    }

    fn draw(&mut self, builder: PathBuilder, fill: Option<Fill>, stroke: Option<Stroke>) {
        if let Some(path) = builder.finish() {
            self.surface.set_fill(fill);
            self.surface.set_stroke(stroke);
            self.surface.draw_path(&path);
        }
    }
}

impl DrawingBackend for Canvas<'_, '_> {
    type ErrorType = io::Error;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        self.path(corners, true, Some(fill(color)), None);
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, a: BackendCoord, b: BackendCoord, style: &S) -> Drawn {
        if style.color().alpha > 0.0 {
            self.path([a, b], false, None, Some(stroke(style)));
        }
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        is_filled: bool,
    ) -> Drawn {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        let (fill, stroke) = if is_filled {
            (Some(fill(style.color())), None)
        } else {
            (None, Some(stroke(style)))
        };
        self.path(corners, true, fill, stroke);
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        if style.color().alpha > 0.0 {
            self.path(path, false, None, Some(stroke(style)));
        }
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        is_filled: bool,
    ) -> Drawn {
        let ([x, y], r) = (place(center), length(radius));
        let k = QUARTER * r;
        let mut builder = PathBuilder::new();
        builder.move_to(x + r, y);
        builder.cubic_to(x + r, y + k, x + k, y + r, x, y + r);
        builder.cubic_to(x - k, y + r, x - r, y + k, x - r, y);
        builder.cubic_to(x - r, y - k, x - k, y - r, x, y - r);
        builder.cubic_to(x + k, y - r, x + r, y - k, x + r, y);
        builder.close();
        if is_filled {
            self.draw(builder, Some(fill(style.color())), None);
        } else {
            self.draw(builder, None, Some(stroke(style)));
        }
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Drawn {
        self.path(corners, true, Some(fill(style.color())), None);
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        anchor: BackendCoord,
    ) -> Drawn {
        let failed = |error| DrawingErrorKind::DrawingError(io::Error::other(error));
        let em = ems(style.size());
        let line = self.typeface.line(text, Weight::Regular).map_err(failed)?;
        let right = match style.anchor().h_pos {
            HPos::Left => 0.0,
            HPos::Center => -em * line.width / 2.0,
            HPos::Right => -em * line.width,
        };
        // As the figures' PNG and plotters' SVG place the baseline.
        let down = match style.anchor().v_pos {
            VPos::Top => 0.76 * em,
            VPos::Center => 0.25 * em,
            VPos::Bottom => -0.25 * em,
        };
        let [x, y] = place(anchor);
        let angle = match style.transform() {
            FontTransform::None => 0.0,
            FontTransform::Rotate90 => 90.0,
            FontTransform::Rotate180 => 180.0,
            FontTransform::Rotate270 => 270.0,
        };
        self.surface
            .push_transform(&Transform::from_rotate_at(angle, x, y));
        self.surface.set_fill(Some(fill(style.color())));
        self.surface.set_stroke(None);
        self.surface.draw_glyphs(
            Point::from_xy(x + right, y + down),
            &line.glyphs,
            self.typeface.font(Weight::Regular),
            text,
            em,
            false,
        );
        self.surface.pop();
        Ok(())
    }
}
