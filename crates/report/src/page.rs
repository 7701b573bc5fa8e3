//! Errors and figures of HTML pages.

use crate::figure::FigureError;

/// A reason why a page cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// A figure failed.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The template failed.
    #[error("cannot fill the page: {0}")]
    Template(#[from] askama::Error),
}

/// Asserts that a page needs no other file and no network, and shows so many figures.
#[cfg(test)]
pub(crate) fn assert_stands_alone(page: &str, figures: usize) {
    let links = page
        .match_indices("http")
        .filter(|(at, _)| !page[*at..].starts_with("http://www.w3.org/2000/svg"));
    assert_eq!(links.count(), 0);
    assert_eq!(page.matches("<svg").count(), figures);
    assert!(!page.contains("NaN"));
}

/// Turns an SVG into a part of a page, scaled by its view box instead of its width and height.
#[must_use]
pub fn inline(svg: String) -> String {
    match svg.split_once("viewBox") {
        Some((_, rest)) => {
            format!("<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" viewBox{rest}")
        }
        None => svg,
    }
}
