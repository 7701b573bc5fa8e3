//! The statistics as a self-contained page: `report.html`.

use askama::Template;

use super::summary::Summary;
use super::text::headline;
use crate::page::{PageError, inline};

#[derive(Template)]
#[template(path = "statistics.html")]
struct Page<'a> {
    summary: &'a Summary,
    headline: String,
    figures: Vec<String>,
    cases: Vec<CaseRow>,
}

/// A row of the table of worst cases.
struct CaseRow {
    what: String,
    size: String,
    trigger: String,
    scenario: String,
}

/// Writes the page, with the figures in it.
///
/// # Errors
/// [`PageError`] if the template fails.
pub fn page(summary: &Summary, figures: Vec<String>) -> Result<String, PageError> {
    let cases = summary.cases.iter().map(|case| CaseRow {
        what: case.what.clone(),
        size: case.size.map_or(String::new(), |size| format!("{size:.2}")),
        trigger: case
            .trigger
            .map_or(String::new(), |trigger| trigger.to_string()),
        scenario: case.scenario.clone(),
    });
    let page = Page {
        summary,
        headline: headline(summary),
        figures: figures.into_iter().map(inline).collect(),
        cases: cases.collect(),
    };
    Ok(page.render()?)
}
