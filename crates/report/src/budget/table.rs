//! The budget as a page of text.

use comfy_table::{CellAlignment, Table, presets::UTF8_FULL_CONDENSED};
use fmc_simulation::budget::result::Budget;

use super::results::BudgetResults;

/// Writes camera, exposures, a row per term, and the advice.
#[must_use]
pub fn text(budget: &Budget) -> String {
    let results = BudgetResults::of(budget);
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "term, largest over exposures and sensor",
        "what",
        "fmc-camera",
        "paper\nµm",
        "limits\nµm",
        "limits\npx",
        "limits\ncm on the ground",
    ]);
    for row in &results.rows {
        table.add_row([
            row.term.as_str(),
            row.kind,
            row.removed,
            &row.paper_um,
            &row.limits_um,
            &row.limits_px,
            &row.ground_cm,
        ]);
    }
    for column in table.column_iter_mut().skip(3) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    [
        results.camera,
        results.exposures,
        table.trim_fmt(),
        results.advice,
    ]
    .join("\n")
        + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::fixture;

    #[test]
    fn every_term_is_told_on_one_page() {
        let budget = fixture::budget();
        let text = text(&budget);
        for source in budget.terms.iter().map(|term| term.source) {
            assert!(text.contains(source.label()), "{source:?}");
        }
        assert!(text.lines().count() <= 25 && !text.contains("NaN"));
        assert!(
            text.lines()
                .last()
                .unwrap()
                .starts_with("Take principal point and time")
        );
    }
}
