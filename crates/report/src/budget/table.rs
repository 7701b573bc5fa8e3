//! The budget as a page of text.

use fmc_simulation::budget::result::Budget;

use super::results::BudgetResults;
use crate::terminal::{self, numbers, words};

/// Mark of the terms that fmc-camera removes.
const REMOVED: &str = "*";

/// Writes camera, exposures, a row per term, and the advice.
#[must_use]
pub fn text(budget: &Budget) -> String {
    let results = BudgetResults::of(budget);
    let columns = [
        words(format!(
            "term ({REMOVED}: fmc-camera removes it),\nlargest over exposures and sensor"
        )),
        words("what"),
        numbers("paper\nµm"),
        numbers("limits\nµm"),
        numbers("limits\npx"),
        numbers("ground\ncm"),
    ];
    let rows = results.rows.into_iter().map(|row| {
        let mark = if row.removed.is_empty() { "" } else { REMOVED };
        let what = format!("{}{mark}", row.kind);
        [
            row.term,
            what,
            row.paper_um,
            row.limits_um,
            row.limits_px,
            row.ground_cm,
        ]
    });
    [
        results.camera,
        format!(
            "{}; px, and cm on the ground: of the limits",
            results.exposures
        ),
        terminal::table(columns, rows),
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
        // A term that is too long for its column goes on in the next line.
        let width = text.lines().find_map(|line| line.find(" what ")).unwrap();
        let first_column: String = text
            .lines()
            .map(|line| {
                line.chars()
                    .take(width)
                    .collect::<String>()
                    .trim()
                    .to_owned()
                    + " "
            })
            .collect();
        for source in budget.terms.iter().map(|term| term.source) {
            assert!(first_column.contains(source.label()), "{source:?}\n{text}");
        }
        let removed = budget.terms.iter().filter(|term| term.source.is_removed());
        assert_eq!(text.matches("position*").count(), removed.count());
        assert!(text.lines().count() <= 25 && !text.contains("NaN"));
        assert!(
            text.lines()
                .last()
                .unwrap()
                .starts_with("Take principal point and time")
        );
    }
}
