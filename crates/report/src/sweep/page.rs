//! The sweep as a self-contained page: `report.html`.

use askama::Template;
use fmc_simulation::sweep::result::Sweep;

use super::coefficient_plot;
use super::results::SweepResults;
use crate::page::{PageError, inline};

/// Content of the page.
#[derive(Template)]
#[template(path = "sweep.html")]
struct Page {
    results: SweepResults,
    figure: String,
}

/// Writes the whole sweep as one HTML page, with the figure in it.
///
/// # Errors
/// [`PageError`] if the figure cannot be drawn.
pub fn page(sweep: &Sweep) -> Result<String, PageError> {
    let page = Page {
        results: SweepResults::of(sweep),
        figure: inline(coefficient_plot::svg(sweep)?),
    };
    Ok(page.render()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::assert_stands_alone;
    use crate::sweep::fixture;

    #[test]
    fn page_stands_alone_and_names_are_text() {
        for strategy in ["from-rest", "centred"] {
            let page = page(&fixture::sweep(strategy)).unwrap();
            assert_stands_alone(&page, 1);
            assert!(!page.contains("Small <&>"));
            assert!(page.contains("focus shift alone"));
        }
    }
}
