//! The sweep as a table for a terminal or a pipe.

use comfy_table::{CellAlignment, Table, presets::UTF8_FULL_CONDENSED};
use fmc_simulation::sweep::result::Sweep;

use super::results::SweepResults;

/// Writes the simulation, σ of every case and model, the coefficients, and the results.
#[must_use]
pub fn text(sweep: &Sweep) -> String {
    let results = SweepResults::of(sweep);
    let mut lines = vec![results.simulated.clone(), table(&results).trim_fmt()];
    lines.push(
        "σ: 2n - u, per coordinate; n - 5: the divisor of eq. 28; all in µm, over all exposures"
            .to_owned(),
    );
    lines.extend(
        results
            .estimates
            .iter()
            .map(|found| format!("{} = {} {}", found.symbol, found.value, found.unit))
            .map(|line| line.trim_end().to_owned()),
    );
    lines.extend(results.sentences);
    lines.join("\n") + "\n"
}

fn table(results: &SweepResults) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "simulated",
        "static\nσ / n - 5",
        "without\nnoise",
        "five coefficients\nσ / n - 5",
        "without\nnoise",
        "exact\nσ / n - 5",
        "without\nnoise",
    ]);
    for row in &results.rows {
        let mut cells = vec![row.case.to_owned()];
        for cell in &row.cells {
            cells.push(format!("{} / {}", cell.sigma, cell.as_printed));
            cells.push(cell.noise_free.clone());
        }
        table.add_row(cells);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::fixture;

    #[test]
    fn both_divisors_and_all_cases_are_told() {
        let text = text(&fixture::sweep("from-rest"));
        for part in [
            "focus shift and motion",
            "focus shift alone",
            "motion alone",
            "n - 5",
            "2n - u",
            "K_d1 = ",
            "seed 7",
        ] {
            assert!(text.contains(part), "{part} is missing in\n{text}");
        }
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }

    #[test]
    fn coefficients_that_do_not_exist_have_no_number() {
        let text = text(&fixture::sweep("centred"));
        assert!(text.contains("they do not exist"), "{text}");
        assert!(!text.contains("K_d1 = "), "{text}");
    }
}
