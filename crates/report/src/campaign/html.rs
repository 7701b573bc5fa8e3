//! The campaign as a self-contained page with its heat map: `report.html`.

use askama::Template;
use fmc_simulation::campaign::results::{CELL_MS, Row};

use super::summary::Summary;
use super::text::headline;
use crate::page::PageError;
use crate::wording;

/// Parts of what a record allows at which the colour changes.
const STEPS: [f64; 6] = [0.1, 0.25, 0.5, 0.75, 0.9, 1.0];

#[derive(Template)]
#[template(path = "campaign.html")]
struct Page<'a> {
    summary: &'a Summary,
    headline: String,
    columns: Vec<String>,
    rows: Vec<HeatRow<'a>>,
    steps: Vec<Step>,
}

/// A row of the heat map.
struct HeatRow<'a> {
    name: &'a str,
    runs: String,
    without_effect: String,
    worst: String,
    effects: String,
    cells: Vec<Cell>,
}

/// A cell of the heat map.
struct Cell {
    class: usize,
    title: String,
}

/// A colour of the key.
struct Step {
    class: usize,
    label: String,
}

/// Writes the page.
///
/// # Errors
/// [`PageError`] if the template fails.
pub fn page(summary: &Summary) -> Result<String, PageError> {
    let cells = summary.rows.iter().map(|row| row.cells.len()).max();
    let columns = (0_u32..).take(cells.unwrap_or(0));
    let page = Page {
        summary,
        headline: headline(summary),
        columns: columns
            .map(|cell| {
                if cell.is_multiple_of(4) {
                    (cell * CELL_MS).to_string()
                } else {
                    String::new()
                }
            })
            .collect(),
        rows: summary.rows.iter().map(heat_row).collect(),
        steps: (0..=STEPS.len())
            .map(|class| Step {
                class,
                label: label(class),
            })
            .collect(),
    };
    Ok(page.render()?)
}

fn heat_row(row: &Row) -> HeatRow<'_> {
    let mut effects: Vec<(&String, &u32)> = row.effects.iter().collect();
    effects.sort_by(|(_, one), (_, other)| other.cmp(one));
    let effects: Vec<String> = effects
        .into_iter()
        .take(3)
        .map(|(effect, runs)| format!("{effect} {}", wording::count(u64::from(*runs))))
        .collect();
    HeatRow {
        name: &row.name,
        runs: wording::count(u64::from(row.runs)),
        without_effect: wording::count(u64::from(row.without_effect)),
        worst: row.worst.map_or(String::new(), |used| format!("{used:.2}")),
        effects: effects.join(", "),
        cells: (0_u32..)
            .zip(&row.cells)
            .map(|(index, cell)| Cell {
                class: cell.map_or(STEPS.len() + 1, class),
                title: match cell {
                    Some(used) => format!("{} ms: {used:.2}", index * CELL_MS),
                    None => format!("{} ms: no record without fault or flag", index * CELL_MS),
                },
            })
            .collect(),
    }
}

/// Returns the colour of a part: the number of steps that it is beyond.
fn class(used: f64) -> usize {
    STEPS.iter().filter(|step| used > **step).count()
}

fn label(class: usize) -> String {
    match (
        class.checked_sub(1).and_then(|one| STEPS.get(one)),
        STEPS.get(class),
    ) {
        (None, Some(to)) => format!("to {to}"),
        (Some(from), Some(to)) => format!("{from} to {to}"),
        (Some(from), None) => format!("above {from}: silently wrong"),
        (None, None) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_beyond_what_the_record_allows_has_the_last_colour_and_one_at_the_limit_does_not() {
        assert_eq!(class(0.0), 0);
        assert_eq!(class(1.0), STEPS.len() - 1);
        assert_eq!(class(1.000_1), STEPS.len());
        assert_eq!(label(STEPS.len()), "above 1: silently wrong");
    }
}
