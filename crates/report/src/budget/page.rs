//! The budget as a self-contained page: `report.html`.

use askama::Template;
use fmc_simulation::budget::result::Budget;

use super::dots;
use super::results::BudgetResults;
use crate::page::{PageError, inline};

/// Content of the page.
#[derive(Template)]
#[template(path = "budget.html")]
struct Page {
    results: BudgetResults,
    figure: String,
}

/// The table of the page alone.
#[derive(Template)]
#[template(path = "budget_table.html")]
struct Rows {
    results: BudgetResults,
}

/// Writes the table of a budget as a part of an HTML page.
///
/// # Errors
/// [`PageError`] if the template fails.
pub fn rows(budget: &Budget) -> Result<String, PageError> {
    let results = BudgetResults::of(budget);
    Ok(Rows { results }.render()?)
}

/// Writes the whole budget as one HTML page, with the figure in it.
///
/// # Errors
/// [`PageError`] if the figure cannot be drawn.
pub fn page(budget: &Budget) -> Result<String, PageError> {
    let page = Page {
        results: BudgetResults::of(budget),
        figure: inline(dots::svg(budget)?),
    };
    Ok(page.render()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::fixture;
    use crate::page::assert_stands_alone;

    #[test]
    fn page_stands_alone_and_names_are_text() {
        let page = page(&fixture::budget()).unwrap();
        assert_stands_alone(&page, 1);
        assert!(!page.contains("Small <&>"));
    }
}
