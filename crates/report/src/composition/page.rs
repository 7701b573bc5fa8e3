//! A composition as a self-contained page.

use askama::Template;
use base64::prelude::{BASE64_STANDARD, Engine as _};

use crate::page::{PageError, inline};

/// A page: what was found, with tables and figures.
#[derive(Debug, Clone, PartialEq, Template)]
#[template(path = "composition.html")]
pub struct CompositionPage {
    /// Title.
    pub title: String,
    /// Findings, a sentence each.
    pub findings: Vec<String>,
    /// Parts of the page.
    pub sections: Vec<Section>,
    /// Every number is within its limit; `None` where none was judged.
    pub passed: Option<bool>,
}

/// A part of a page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Heading.
    pub heading: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows of the table.
    pub rows: Vec<Vec<String>>,
    /// Meaning of the table.
    pub caption: String,
    /// A figure in SVG.
    pub figure: Option<String>,
    /// Images in PNG, as data of a link, with what they show.
    pub images: Vec<(String, String)>,
}

impl CompositionPage {
    /// Writes the page.
    ///
    /// # Errors
    /// [`PageError`] if the template fails.
    pub fn html(mut self) -> Result<String, PageError> {
        for section in &mut self.sections {
            section.figure = section.figure.take().map(inline);
        }
        Ok(self.render()?)
    }
}

/// Encodes grey values, rows of `width`, as a PNG in the form of a link.
///
/// # Errors
/// [`png::EncodingError`] if there are not whole rows.
pub fn png_link(width: u32, grey: &[u8]) -> Result<String, png::EncodingError> {
    let mut bytes = Vec::new();
    let height = u32::try_from(grey.len()).unwrap_or(u32::MAX) / width.max(1);
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(grey)?;
    Ok(format!(
        "data:image/png;base64,{}",
        BASE64_STANDARD.encode(&bytes)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_stands_alone() {
        let page = CompositionPage {
            title: "Virtual image".to_owned(),
            findings: vec!["Seams 0.1 px".to_owned()],
            sections: vec![Section {
                heading: "Seams".to_owned(),
                columns: vec!["seam".to_owned(), "px".to_owned()],
                rows: vec![vec!["1, 2".to_owned(), "0.1".to_owned()]],
                images: vec![("labels".to_owned(), png_link(2, &[0, 255, 255, 0]).unwrap())],
                ..Section::default()
            }],
            passed: Some(true),
        };
        let html = page.html().unwrap();
        crate::page::assert_stands_alone(&html, 0);
        assert!(html.contains("<td>0.1</td>") && html.contains("data:image/png;base64,iVBOR"));
    }
}
