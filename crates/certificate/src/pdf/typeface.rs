//! The fonts of the PDF: `DejaVu` Sans Condensed, regular and bold, embedded as far as it is used.

use krilla::text::{Font, GlyphId, KrillaGlyph};
use rustybuzz::{Face, UnicodeBuffer};
use textwrap::core::Fragment;
use textwrap::wrap_algorithms::wrap_first_fit;

use super::error::PdfError;

/// Weight of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weight {
    Regular,
    Bold,
}

/// Both fonts.
pub(super) struct Typeface {
    regular: Cut,
    bold: Cut,
}

/// One font, for shaping and for drawing.
struct Cut {
    face: Face<'static>,
    font: Font,
}

/// A shaped line of text.
#[derive(Debug, Clone)]
pub(super) struct Line {
    /// Glyphs, lengths in em.
    pub(super) glyphs: Vec<KrillaGlyph>,
    /// Length, em.
    pub(super) width: f32,
}

/// A word with its length.
#[derive(Debug)]
struct Word {
    text: String,
    width: f64,
    blank: f64,
}

impl Fragment for Word {
    fn width(&self) -> f64 {
        self.width
    }

    fn whitespace_width(&self) -> f64 {
        self.blank
    }

    fn penalty_width(&self) -> f64 {
        0.0
    }
}

impl Cut {
    fn new(data: &'static [u8]) -> Result<Self, PdfError> {
        let face = Face::from_slice(data, 0).ok_or(PdfError::Font)?;
        let font = Font::new(data.into(), 0).ok_or(PdfError::Font)?;
        Ok(Self { face, font })
    }
}

impl Typeface {
    /// Reads the fonts.
    ///
    /// # Errors
    /// [`PdfError::Font`] if they are damaged.
    pub(super) fn new() -> Result<Self, PdfError> {
        Ok(Self {
            regular: Cut::new(dejavu::sans_condensed::regular())?,
            bold: Cut::new(dejavu::sans_condensed::bold())?,
        })
    }

    fn cut(&self, weight: Weight) -> &Cut {
        match weight {
            Weight::Regular => &self.regular,
            Weight::Bold => &self.bold,
        }
    }

    /// Returns the font of a weight.
    pub(super) fn font(&self, weight: Weight) -> Font {
        self.cut(weight).font.clone()
    }

    /// Shapes a line of text.
    ///
    /// # Errors
    /// [`PdfError::NoGlyph`] for a character that the font does not have.
    pub(super) fn line(&self, text: &str, weight: Weight) -> Result<Line, PdfError> {
        let face = &self.cut(weight).face;
        let em = f32::from(i16::try_from(face.units_per_em()).unwrap_or(i16::MAX));
        let mut buffer = UnicodeBuffer::new();
        buffer.push_str(text);
        buffer.set_direction(rustybuzz::Direction::LeftToRight);
        buffer.guess_segment_properties();
        let shaped = rustybuzz::shape(face, &[], buffer);
        let starts: Vec<usize> = shaped
            .glyph_infos()
            .iter()
            .map(|info| usize::try_from(info.cluster).unwrap_or(usize::MAX))
            .collect();
        let mut glyphs = Vec::with_capacity(starts.len());
        let mut width = 0.0;
        let positions = shaped.glyph_positions().iter();
        for ((info, position), start) in shaped.glyph_infos().iter().zip(positions).zip(&starts) {
            if info.glyph_id == 0 {
                let character = text.get(*start..).and_then(|rest| rest.chars().next());
                return Err(PdfError::NoGlyph(character.unwrap_or_default()));
            }
            let end = starts.iter().copied().filter(|next| next > start).min();
            let ems = [
                position.x_advance,
                position.x_offset,
                position.y_offset,
                position.y_advance,
            ]
            .map(|units| units_of(units) / em);
            let [advance, right, up, down] = ems;
            width += advance;
            glyphs.push(KrillaGlyph::new(
                GlyphId::new(info.glyph_id),
                advance,
                right,
                up,
                down,
                *start..end.unwrap_or(text.len()),
                None,
            ));
        }
        Ok(Line { glyphs, width })
    }

    /// Returns the length of a text, in the unit of the size.
    ///
    /// # Errors
    /// As [`Self::line`].
    pub(super) fn width(&self, text: &str, weight: Weight, size: f32) -> Result<f32, PdfError> {
        Ok(size * self.line(text, weight)?.width)
    }

    /// Breaks a text into lines of at most that length; a word that is longer is broken, too.
    ///
    /// # Errors
    /// As [`Self::line`].
    pub(super) fn lines(
        &self,
        text: &str,
        weight: Weight,
        size: f32,
        width: f32,
    ) -> Result<Vec<String>, PdfError> {
        let blank = f64::from(self.width(" ", weight, size)?);
        let mut lines = Vec::new();
        for paragraph in text.lines() {
            let mut words = Vec::new();
            for word in paragraph.split_whitespace() {
                for text in self.pieces(word, weight, size, width)? {
                    words.push(Word {
                        width: self.width(&text, weight, size)?.into(),
                        text,
                        blank,
                    });
                }
            }
            // Rounding must not break a line that fits.
            for line in wrap_first_fit(&words, &[f64::from(width) + 0.01]) {
                let words: Vec<&str> = line.iter().map(|word| word.text.as_str()).collect();
                lines.push(words.join(" "));
            }
        }
        Ok(lines)
    }

    /// Breaks a word that is longer than a line into pieces that are not.
    fn pieces(
        &self,
        word: &str,
        weight: Weight,
        size: f32,
        width: f32,
    ) -> Result<Vec<String>, PdfError> {
        if self.width(word, weight, size)? <= width {
            return Ok(vec![word.to_owned()]);
        }
        let mut pieces = vec![String::new()];
        for character in word.chars() {
            let last = pieces.last().map(String::as_str).unwrap_or_default();
            let longer = format!("{last}{character}");
            if last.is_empty() || self.width(&longer, weight, size)? <= width {
                pieces.pop();
                pieces.push(longer);
            } else {
                pieces.push(character.to_string());
            }
        }
        Ok(pieces)
    }
}

/// Converts a number of font units.
#[expect(
    clippy::cast_precision_loss,
    reason = "a few thousand font units, exact in single precision"
)]
const fn units_of(units: i32) -> f32 {
    units as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_of_a_certificate_has_its_glyph() {
        let typeface = Typeface::new().unwrap();
        for weight in [Weight::Regular, Weight::Bold] {
            for text in [
                "σ0 Δδ c̄ μ₂ κ E[τ] f·V/H",
                "mm⁻² mm⁻⁴ mm⁻⁶ ° µm – − … √(P1² + P2²)",
            ] {
                assert!(typeface.width(text, weight, 10.0).unwrap() > 50.0);
            }
        }
        let missing = typeface.line("a\u{6f22}", Weight::Regular).unwrap_err();
        assert!(matches!(missing, PdfError::NoGlyph('\u{6f22}')));
    }

    #[test]
    fn no_line_is_longer_than_its_column() {
        let typeface = Typeface::new().unwrap();
        let text = format!(
            "a few words, then {} and more words after it",
            "0123456789".repeat(6)
        );
        let lines = typeface.lines(&text, Weight::Regular, 8.0, 120.0).unwrap();
        assert!(lines.len() > 3);
        for line in &lines {
            assert!(
                typeface.width(line, Weight::Regular, 8.0).unwrap() <= 120.02,
                "{line}"
            );
        }
        assert_eq!(lines.concat().replace(' ', ""), text.replace(' ', ""));
    }
}
