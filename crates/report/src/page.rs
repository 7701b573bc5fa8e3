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

/// Turns an SVG into a part of a page, scaled by its view box instead of its width and height.
pub(crate) fn inline(svg: String) -> String {
    match svg.split_once("viewBox") {
        Some((_, rest)) => {
            format!("<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" viewBox{rest}")
        }
        None => svg,
    }
}
