//! The comparison as a self-contained page: `report.html`.

use askama::Template;

use super::summary::Summary;
use super::text::{centimetres, headline, plus_minus, share};
use crate::page::{PageError, inline};

#[derive(Template)]
#[template(path = "block.html")]
struct Page<'a> {
    summary: &'a Summary,
    headline: String,
    figure: String,
    rows: Vec<Row>,
}

/// A row of the table of variants.
struct Row {
    label: &'static str,
    numbers: [String; 5],
    named: String,
}

/// Writes the page, with the figure in it.
///
/// # Errors
/// [`PageError`] if the template fails.
pub fn page(summary: &Summary, figure: String) -> Result<String, PageError> {
    let rows = summary.variants.iter().map(|variant| Row {
        label: variant.label,
        numbers: [
            centimetres(variant.along_m),
            centimetres(variant.across_m),
            centimetres(variant.height_m),
            plus_minus(variant.sigma0, 3),
            share(variant.sigma0_beyond),
        ],
        named: variant
            .named
            .iter()
            .map(|(frame, runs)| format!("{frame} ({runs})"))
            .collect::<Vec<_>>()
            .join(", "),
    });
    let page = Page {
        summary,
        headline: headline(summary),
        figure: inline(figure),
        rows: rows.collect(),
    };
    Ok(page.render()?)
}
