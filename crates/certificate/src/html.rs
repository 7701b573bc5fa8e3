//! The pages of a certificate as HTML.

use std::collections::BTreeMap;

use askama::Template;
use fmc_report::figure::FigureError;
use fmc_report::page::{PageError, inline};

use crate::document::Document;
use crate::document::block::Block;

/// Content of the page.
#[derive(Template)]
#[template(path = "certificate.html")]
struct Page<'a> {
    document: &'a Document,
    /// Figures by their captions.
    figures: BTreeMap<&'a str, String>,
}

impl Page<'_> {
    /// Returns a figure as SVG.
    fn svg(&self, caption: &str) -> &str {
        self.figures.get(caption).map_or("", String::as_str)
    }
}

/// Writes the certificate as one HTML page that needs no other file.
///
/// # Errors
/// [`PageError`] if a figure cannot be drawn.
pub fn page(document: &Document) -> Result<String, PageError> {
    let blocks = document.sections.iter().flat_map(|section| &section.blocks);
    let figures = blocks
        .filter_map(|block| match block {
            Block::Figures(figures) => Some(figures),
            _ => None,
        })
        .flatten()
        .map(|figure| Ok((figure.caption.as_str(), inline(figure.drawing.svg()?))))
        .collect::<Result<_, FigureError>>()?;
    Ok(Page { document, figures }.render()?)
}
