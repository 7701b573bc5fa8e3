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

/// Width of a figure on a telephone of 500 pixels.
#[cfg(test)]
const TELEPHONE: f64 = 476.0;

/// Asserts that a page needs no other file and no network, and shows so many figures, whose letters
/// are at least 9 pixels high on a telephone.
#[cfg(test)]
pub(crate) fn assert_stands_alone(page: &str, figures: usize) {
    let links = page
        .match_indices("http")
        .filter(|(at, _)| !page[*at..].starts_with("http://www.w3.org/2000/svg"));
    assert_eq!(links.count(), 0);
    assert_eq!(page.matches("<svg").count(), figures);
    assert!(!page.contains("NaN"));
    assert!(page.contains("prefers-color-scheme: dark"));
    let number = |text: &str| -> f64 { text.split('"').next().unwrap().parse().unwrap() };
    let mut letters = 0;
    for figure in page.split("style=\"--width:").skip(1) {
        let scale = (TELEPHONE / number(figure)).min(1.0);
        let figure = figure.split("</svg>").next().unwrap();
        for size in figure.split("font-size=\"").skip(1).map(number) {
            assert!(scale * size > 9.0, "{size} pixels, scaled by {scale}");
            letters += 1;
        }
    }
    assert!(letters > 0 || figures == 0);
}

/// Turns an SVG into a part of a page, scaled by its view box instead of its width and height. The
/// page's style finds the width in `--width`.
#[must_use]
pub fn inline(svg: String) -> String {
    match svg.split_once("viewBox") {
        Some((_, rest)) => {
            // viewBox="0 0 1500 900"
            let width = rest.split_whitespace().nth(2).unwrap_or("1000");
            format!("<svg role=\"img\" style=\"--width:{width}\" viewBox{rest}")
        }
        None => svg,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure;

    #[test]
    fn figure_in_a_page_tells_its_width() {
        let svg = figure::svg((1500, 900), |_| Ok(())).unwrap();
        let part = inline(svg);
        assert!(
            part.contains("style=\"--width:1500\" viewBox=\"0 0 1500 900\""),
            "{part}"
        );
        // Twice would be no XML.
        assert_eq!(part.matches("xmlns=").count(), 1, "{part}");
    }
}
