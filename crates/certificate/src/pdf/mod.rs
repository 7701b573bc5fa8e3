//! The pages of a certificate as PDF, A4.

mod canvas;
mod error;
mod flow;
mod table;
mod typeface;

use canvas::Canvas;
pub use error::PdfError;
use flow::{Flow, MARGIN, Mark, PAGE, Pages};
use krilla::color::luma;
use krilla::configure::{Archival, ConfigurationBuilder};
use krilla::destination::XyzDestination;
use krilla::embed::{AssociationKind, EmbeddedFile, MimeType};
use krilla::geom::{PathBuilder, Point, Transform};
use krilla::metadata::{DateTime, Metadata};
use krilla::outline::{Outline, OutlineNode};
use krilla::page::PageSettings;
use krilla::paint::{Fill, Stroke};
use krilla::surface::Surface;
use krilla::{Document as Pdf, SerializeSettings};
use plotters::prelude::IntoDrawingArea;
use typeface::{Typeface, Weight};

use crate::details::Date;
use crate::document::Document;

/// Most pages of a certificate.
pub const MOST_PAGES: usize = 8;

/// Size of the foot's letters, points.
const FOOT: f32 = 7.0;

/// A file that is attached to the PDF.
#[derive(Debug, Clone, Copy)]
pub struct Attachment<'a> {
    /// Name, without folders.
    pub name: &'a str,
    /// Bytes.
    pub bytes: &'a [u8],
    /// Media type.
    pub media_type: &'a str,
    /// Description.
    pub description: &'a str,
}

/// Writes the pages as PDF, with files attached: PDF/A-3b if the day of issue is stated, as the
/// standard asks for a date, and PDF 1.7 otherwise. The same document gives the same bytes.
///
/// # Errors
/// [`PdfError`] for text without a glyph and for more than [`MOST_PAGES`].
pub fn pdf(
    document: &Document,
    issued_on: Option<Date>,
    software: &str,
    attachments: &[Attachment<'_>],
) -> Result<Vec<u8>, PdfError> {
    let typeface = Typeface::new()?;
    let Pages { pages, headings } = Flow::pages(document, &typeface)?;
    if pages.len() > MOST_PAGES {
        return Err(PdfError::TooLong(pages.len()));
    }
    let mut configuration = ConfigurationBuilder::new();
    if issued_on.is_some() {
        configuration = configuration.with_archival_validator(Archival::A3_B);
    }
    let mut pdf = Pdf::new_with(SerializeSettings {
        configuration: configuration.finish().map_err(PdfError::Configuration)?,
        ..SerializeSettings::default()
    });
    let count = pages.len();
    let [width, height] = PAGE;
    for (number, marks) in (1_usize..).zip(&pages) {
        let settings = PageSettings::from_wh(width, height).unwrap_or_default();
        let mut page = pdf.start_page_with(settings);
        let mut surface = page.surface();
        for mark in marks {
            draw(&mut surface, &typeface, mark)?;
        }
        for mark in foot(document, &typeface, &format!("page {number} of {count}"))? {
            draw(&mut surface, &typeface, &mark)?;
        }
        surface.finish();
        page.finish();
    }
    let mut outline = Outline::new();
    for (title, page, y) in headings {
        let place = XyzDestination::new(page, Point::from_xy(0.0, y));
        outline.push_child(OutlineNode::new(title, place));
    }
    pdf.set_outline(outline);
    pdf.set_metadata(metadata(document, issued_on, software));
    for attachment in attachments {
        attach(&mut pdf, attachment, issued_on)?;
    }
    pdf.finish()
        .map_err(|error| PdfError::Writer(format!("{error:?}")))
}

fn foot<'a>(
    document: &Document,
    typeface: &Typeface,
    page: &str,
) -> Result<[Mark<'a>; 3], PdfError> {
    let [width, height] = PAGE;
    let right = width - MARGIN;
    let baseline = height - 34.0;
    let text = |x: f32, text: &str| Mark::Text {
        at: [x, baseline],
        text: text.to_owned(),
        size: FOOT,
        weight: Weight::Regular,
        grey: 90,
    };
    let length = typeface.width(page, Weight::Regular, FOOT)?;
    // A long number of the certificate must not run into the number of the page.
    let room = right - MARGIN - length - 20.0;
    let lines = typeface.lines(&document.foot, Weight::Regular, FOOT, room)?;
    let left = lines.first().map(String::as_str).unwrap_or_default();
    Ok([
        Mark::Rule {
            from: [MARGIN, baseline - 11.0],
            to: [right, baseline - 11.0],
            width: 0.4,
        },
        text(MARGIN, left),
        text(right - length, page),
    ])
}

fn draw(surface: &mut Surface<'_>, typeface: &Typeface, mark: &Mark<'_>) -> Result<(), PdfError> {
    match mark {
        Mark::Text {
            at: [x, y],
            text,
            size,
            weight,
            grey,
        } => {
            let line = typeface.line(text, *weight)?;
            surface.set_stroke(None);
            surface.set_fill(Some(Fill {
                paint: luma::Color::new(*grey).into(),
                ..Fill::default()
            }));
            surface.draw_glyphs(
                Point::from_xy(*x, *y),
                &line.glyphs,
                typeface.font(*weight),
                text,
                *size,
                false,
            );
        }
        Mark::Rule { from, to, width } => {
            let mut builder = PathBuilder::new();
            let ([left, top], [right, bottom]) = (from, to);
            builder.move_to(*left, *top);
            builder.line_to(*right, *bottom);
            surface.set_fill(None);
            surface.set_stroke(Some(Stroke {
                paint: luma::Color::new(90).into(),
                width: *width,
                ..Stroke::default()
            }));
            if let Some(path) = builder.finish() {
                surface.draw_path(&path);
            }
        }
        Mark::Figure {
            at: [x, y],
            scale,
            figure,
        } => {
            surface.push_transform(&Transform::from_row(*scale, 0.0, 0.0, *scale, *x, *y));
            let canvas = Canvas {
                surface,
                typeface,
                size: figure.drawing.size(),
            };
            let drawn = figure.drawing.draw(&canvas.into_drawing_area());
            surface.pop();
            drawn?;
        }
    }
    Ok(())
}

fn day(date: Date) -> DateTime {
    let Date { year, month, day } = date;
    DateTime::new(year).month(month).day(day)
}

fn metadata(document: &Document, issued_on: Option<Date>, software: &str) -> Metadata {
    let metadata = Metadata::new()
        .title(format!("{}: {}", document.title, document.subtitle))
        .creator(software.to_owned())
        .language("en".to_owned());
    match issued_on {
        Some(date) => metadata.creation_date(day(date)),
        None => metadata,
    }
}

fn attach(
    pdf: &mut Pdf,
    attachment: &Attachment<'_>,
    issued_on: Option<Date>,
) -> Result<(), PdfError> {
    let file = EmbeddedFile {
        path: attachment.name.to_owned(),
        mime_type: MimeType::new(attachment.media_type),
        description: Some(attachment.description.to_owned()),
        association_kind: AssociationKind::Data,
        data: attachment.bytes.to_vec().into(),
        modification_date: issued_on.map(day),
        compress: Some(true),
        location: None,
    };
    pdf.embed_file(file)
        .ok_or_else(|| PdfError::Writer(format!("{} is attached twice", attachment.name)))
}

#[cfg(test)]
mod tests {
    use lopdf::Object;

    use super::*;
    use crate::document::block::{Block, Column, Section, Table};
    use crate::pdf_reader::ReadPdf;

    const DAY: Date = Date {
        year: 2026,
        month: 3,
        day: 20,
    };

    fn document(blocks: Vec<Block>) -> Document {
        Document {
            title: "Title".to_owned(),
            subtitle: "subtitle".to_owned(),
            foot: "foot".to_owned(),
            sections: vec![Section {
                title: "Section".to_owned(),
                blocks,
            }],
        }
    }

    fn table(columns: usize, rows: usize, cell: &str) -> Block {
        let column = Column {
            heading: "head".to_owned(),
            is_words: false,
        };
        Block::Table(Table {
            title: "Table".to_owned(),
            columns: vec![column; columns],
            rows: vec![vec![cell.to_owned(); columns]; rows],
        })
    }

    fn written(blocks: Vec<Block>, issued_on: Option<Date>) -> Result<Vec<u8>, PdfError> {
        let attachment = Attachment {
            name: "a.toml",
            bytes: b"attached",
            media_type: "application/toml",
            description: "camera file",
        };
        pdf(&document(blocks), issued_on, "test 1", &[attachment])
    }

    #[test]
    fn text_and_attachment_are_read_back_and_all_fonts_are_embedded() {
        let words = "σ0 = 1.0234 and δ of 12.5 µm, 3e-5 mm⁻²";
        for issued_on in [None, Some(DAY)] {
            let bytes = written(vec![Block::Text(words.to_owned())], issued_on).unwrap();
            assert!(bytes.len() < 60_000, "{}", bytes.len());
            assert_eq!(
                bytes,
                written(vec![Block::Text(words.to_owned())], issued_on).unwrap()
            );
            let read = ReadPdf::parse(&bytes).unwrap();
            assert!(read.words().join(" ").contains(words), "{:?}", read.pages);
            assert_eq!(read.attachments["a.toml"], b"attached");
            let parsed = lopdf::Document::load_mem(&bytes).unwrap();
            let dictionaries = parsed.objects.values().filter_map(|one| one.as_dict().ok());
            let fonts: Vec<_> = dictionaries
                .filter(|one| one.has_type(b"FontDescriptor"))
                .collect();
            assert_eq!(fonts.len(), 2);
            for font in fonts {
                assert!(font.has(b"FontFile2") || font.has(b"FontFile3"), "{font:?}");
            }
            let is_archive = parsed.objects.values().any(|one| match one {
                Object::Stream(stream) => {
                    let content = stream.decompressed_content().unwrap_or_default();
                    let content = String::from_utf8_lossy(&content).into_owned();
                    content.contains("pdfaid:part>3<")
                }
                _ => false,
            });
            assert_eq!(is_archive, issued_on.is_some());
        }
    }

    #[test]
    fn table_goes_on_with_its_heading_on_the_next_page() {
        let bytes = written(vec![table(4, 100, "1.5")], None).unwrap();
        let read = ReadPdf::parse(&bytes).unwrap();
        assert_eq!(read.pages.len(), 2);
        for page in &read.pages {
            assert_eq!(page.matches("head").count(), 4, "{page}");
        }
        assert_eq!(
            read.words().iter().filter(|word| **word == "1.5").count(),
            400
        );
    }

    #[test]
    fn title_stays_with_the_pairs_below_it() {
        let pairs = |count: usize| {
            let pair = |index: usize| [format!("name{index}"), "text".to_owned()];
            Block::Pairs((0..count).map(pair).collect())
        };
        // Wherever the page ends.
        for lines in 20..60 {
            let text = |_| Block::Text("line".to_owned());
            let mut document = document((0..lines).map(text).collect());
            document.sections.push(Section {
                title: "Last".to_owned(),
                blocks: vec![pairs(16)],
            });
            let bytes = pdf(&document, None, "test 1", &[]).unwrap();
            let read = ReadPdf::parse(&bytes).unwrap();
            let page = read.pages.iter().find(|page| page.contains("Last"));
            let page = page.unwrap();
            assert!(
                page.contains("name0") && page.contains("name15"),
                "{lines}: {page}"
            );
        }
    }

    #[test]
    fn what_cannot_be_set_is_an_error() {
        let wide = written(vec![table(30, 1, "123456.789012")], None);
        assert!(matches!(wide, Err(PdfError::TooWide(_))));
        let long = written(vec![table(4, 700, "1.5")], None);
        assert!(matches!(long, Err(PdfError::TooLong(pages)) if pages > MOST_PAGES));
        let missing = written(vec![Block::Text("\u{6f22}".to_owned())], None);
        assert!(matches!(missing, Err(PdfError::NoGlyph('\u{6f22}'))));
    }
}
