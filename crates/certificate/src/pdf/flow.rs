//! Flow of the blocks down the pages.

use super::error::PdfError;
use super::typeface::{Typeface, Weight};
use crate::document::Document;
use crate::document::block::{Block, Figure, Section};

/// Width and height of A4, points.
pub(super) const PAGE: [f32; 2] = [595.276, 841.89];
/// Left and right margin.
pub(super) const MARGIN: f32 = 54.0;
/// Upper end of the blocks.
const TOP: f32 = 54.0;
/// Lower end of the blocks; the foot is below.
const BOTTOM: f32 = 784.0;
/// Width of the blocks.
pub(super) const WIDTH: f32 = PAGE[0] - 2.0 * MARGIN;
/// Size of running text.
pub(super) const BODY: f32 = 8.6;
/// Distance of lines by the size of their letters.
pub(super) const LEADING: f32 = 1.32;
/// Width of the names of pairs.
const NAMES: f32 = 140.0;
/// Height below which a list of pairs is not broken.
const WHOLE: f32 = 280.0;
/// Height of the title of a section, with its rule, and more than that.
const HEADING: f32 = 30.0;
/// Size of captions.
const CAPTION: f32 = 7.6;

/// Grey of names and captions.
const GREY: u8 = 90;

/// A mark on a page, lengths in points from the upper left corner.
#[derive(Debug, Clone)]
pub(super) enum Mark<'a> {
    /// A line of text that starts at its baseline.
    Text {
        at: [f32; 2],
        text: String,
        size: f32,
        weight: Weight,
        grey: u8,
    },
    /// A straight stroke.
    Rule {
        from: [f32; 2],
        to: [f32; 2],
        width: f32,
    },
    /// A figure, scaled from its pixels.
    Figure {
        at: [f32; 2],
        scale: f32,
        figure: &'a Figure,
    },
}

/// Pages that are being filled.
pub(super) struct Flow<'a> {
    pub(super) typeface: &'a Typeface,
    pages: Vec<Vec<Mark<'a>>>,
    y: f32,
    /// Title, page and height of each section.
    headings: Vec<(String, usize, f32)>,
}

/// Filled pages.
pub(super) struct Pages<'a> {
    pub(super) pages: Vec<Vec<Mark<'a>>>,
    pub(super) headings: Vec<(String, usize, f32)>,
}

/// Number of lines of a pair, those of its name and those of its text.
type BrokenPair = (usize, Vec<String>, Vec<String>);

impl<'a> Flow<'a> {
    /// Sets a document.
    ///
    /// # Errors
    /// [`PdfError::NoGlyph`] for a character that the font does not have.
    pub(super) fn pages(
        document: &'a Document,
        typeface: &'a Typeface,
    ) -> Result<Pages<'a>, PdfError> {
        let mut flow = Self {
            typeface,
            pages: vec![Vec::new()],
            y: TOP,
            headings: Vec::new(),
        };
        flow.paragraph(&document.title, 20.0, Weight::Bold, 0)?;
        flow.paragraph(&document.subtitle, 10.0, Weight::Regular, GREY)?;
        for section in &document.sections {
            flow.section(section)?;
        }
        Ok(Pages {
            pages: flow.pages,
            headings: flow.headings,
        })
    }

    fn section(&mut self, section: &'a Section) -> Result<(), PdfError> {
        self.space(12.0);
        let places = section.blocks.iter().map(|block| match block {
            Block::Signatures(places) => 90.0 * height(places.len().div_ceil(2), 1.0 / LEADING),
            _ => 0.0,
        });
        let places: f32 = places.sum();
        // Pairs that are not broken would leave the title alone on its page.
        let first = match section.blocks.first() {
            Some(Block::Pairs(pairs)) => self.broken(pairs)?.1,
            _ => 0.0,
        };
        let first = if first < WHOLE { first } else { 0.0 };
        self.keep((110.0 + places).max(HEADING + first));
        let page = self.pages.len().saturating_sub(1);
        self.headings.push((section.title.clone(), page, self.y));
        self.paragraph(&section.title, 13.0, Weight::Bold, 0)?;
        self.rule(0.8);
        self.space(5.0);
        for block in &section.blocks {
            match block {
                Block::Text(text) => {
                    let lines = self.typeface.lines(text, Weight::Regular, BODY, WIDTH)?;
                    // A short paragraph is not broken.
                    if lines.len() < 6 {
                        self.keep(height(lines.len(), BODY));
                    }
                    self.paragraph(text, BODY, Weight::Regular, 0)?;
                    self.space(3.0);
                }
                Block::Pairs(pairs) => self.pairs(pairs)?,
                Block::Table(table) => self.table(table)?,
                Block::Figures(figures) => self.figures(figures)?,
                Block::Signatures(places) => self.signatures(places)?,
            }
        }
        Ok(())
    }

    /// Room that is left on the page.
    pub(super) fn room(&self) -> f32 {
        BOTTOM - self.y
    }

    /// Place of the next block from the upper edge of the page.
    pub(super) fn y(&self) -> f32 {
        self.y
    }

    /// Moves down.
    pub(super) fn space(&mut self, points: f32) {
        self.y += points;
    }

    /// Begins a page if the rest of this one is lower than that.
    pub(super) fn keep(&mut self, points: f32) {
        if points > self.room() && self.y > TOP {
            self.pages.push(Vec::new());
            self.y = TOP;
        }
    }

    pub(super) fn mark(&mut self, mark: Mark<'a>) {
        if let Some(page) = self.pages.last_mut() {
            page.push(mark);
        }
    }

    /// Writes a line of text whose upper edge is at the present place, without moving down.
    pub(super) fn write(&mut self, x: f32, text: &str, size: f32, weight: Weight, grey: u8) {
        let baseline = self.y + size;
        self.mark(Mark::Text {
            at: [x, baseline],
            text: text.to_owned(),
            size,
            weight,
            grey,
        });
    }

    /// Draws a horizontal stroke over the width.
    pub(super) fn rule(&mut self, width: f32) {
        let y = self.y + 1.0;
        self.stroke(MARGIN, MARGIN + WIDTH, y, width);
        self.space(2.0);
    }

    pub(super) fn stroke(&mut self, left: f32, right: f32, y: f32, width: f32) {
        self.mark(Mark::Rule {
            from: [left, y],
            to: [right, y],
            width,
        });
    }

    pub(super) fn paragraph(
        &mut self,
        text: &str,
        size: f32,
        weight: Weight,
        grey: u8,
    ) -> Result<(), PdfError> {
        for line in self.typeface.lines(text, weight, size, WIDTH)? {
            self.keep(size * LEADING);
            self.write(MARGIN, &line, size, weight, grey);
            self.space(size * LEADING);
        }
        Ok(())
    }

    /// Returns the lines of pairs, and their height.
    fn broken(&self, pairs: &[[String; 2]]) -> Result<(Vec<BrokenPair>, f32), PdfError> {
        let mut broken = Vec::new();
        for [name, what] in pairs {
            let names = self
                .typeface
                .lines(name, Weight::Regular, BODY, NAMES - 8.0)?;
            let lines = self
                .typeface
                .lines(what, Weight::Regular, BODY, WIDTH - NAMES)?;
            broken.push((names.len().max(lines.len()).max(1), names, lines));
        }
        let all = height(broken.iter().map(|(rows, ..)| rows).sum(), BODY);
        Ok((broken, all))
    }

    fn pairs(&mut self, pairs: &[[String; 2]]) -> Result<(), PdfError> {
        let (broken, all) = self.broken(pairs)?;
        if all < WHOLE {
            self.keep(all);
        }
        for (rows, names, lines) in broken {
            // A long text is broken over pages.
            self.keep(height(rows.min(8), BODY));
            for index in 0..rows {
                self.keep(height(1, BODY));
                if let Some(name) = names.get(index) {
                    self.write(MARGIN, name, BODY, Weight::Regular, GREY);
                }
                if let Some(line) = lines.get(index) {
                    self.write(MARGIN + NAMES, line, BODY, Weight::Regular, 0);
                }
                self.space(BODY * LEADING);
            }
        }
        self.space(5.0);
        Ok(())
    }

    fn figures(&mut self, figures: &'a [Figure]) -> Result<(), PdfError> {
        let gap = 16.0;
        let count = f32::from(u8::try_from(figures.len()).unwrap_or(u8::MAX)).max(1.0);
        let shares: f32 = figures.iter().map(|figure| figure.drawing.share()).sum();
        let unit = (WIDTH - gap * (count - 1.0)) / shares;
        let mut captions = Vec::new();
        let mut tallest = 0.0_f32;
        let mut placed = Vec::new();
        for figure in figures {
            let [across, down] = <[u32; 2]>::from(figure.drawing.size()).map(pixels);
            let width = unit * figure.drawing.share();
            let scale = width / across;
            tallest = tallest.max(scale * down);
            placed.push((figure, scale, width));
            let caption = &figure.caption;
            captions.push(
                self.typeface
                    .lines(caption, Weight::Regular, CAPTION, width)?,
            );
        }
        let most = captions.iter().map(Vec::len).max().unwrap_or(0);
        self.keep(tallest + height(most, CAPTION) + 10.0);
        let mut x = MARGIN;
        for ((figure, scale, width), caption) in placed.into_iter().zip(&captions) {
            let at = [x, self.y];
            self.mark(Mark::Figure { at, scale, figure });
            let top = self.y;
            self.y += tallest + 3.0;
            for line in caption {
                self.write(x, line, CAPTION, Weight::Regular, GREY);
                self.space(CAPTION * LEADING);
            }
            self.y = top;
            x += width + gap;
        }
        self.space(tallest + height(most, CAPTION) + 10.0);
        Ok(())
    }

    fn signatures(&mut self, places: &[[String; 2]]) -> Result<(), PdfError> {
        let gap = 30.0;
        let width = (WIDTH - gap) / 2.0;
        for row in places.chunks(2) {
            self.keep(90.0);
            self.space(46.0);
            let mut x = MARGIN;
            for [name, role] in row {
                let top = self.y;
                self.stroke(x, x + width, top, 0.6);
                self.space(3.0);
                for (text, grey) in [
                    (name.as_str(), 0),
                    (role, GREY),
                    ("place, date, signature", GREY),
                ] {
                    for line in self.typeface.lines(text, Weight::Regular, BODY, width)? {
                        self.write(x, &line, BODY, Weight::Regular, grey);
                        self.space(BODY * LEADING);
                    }
                }
                self.y = top;
                x += width + gap;
            }
            self.space(44.0);
        }
        Ok(())
    }
}

/// Returns the height of so many lines.
pub(super) fn height(lines: usize, size: f32) -> f32 {
    f32::from(u16::try_from(lines).unwrap_or(u16::MAX)) * size * LEADING
}

fn pixels(count: u32) -> f32 {
    f32::from(u16::try_from(count).unwrap_or(u16::MAX))
}
