//! The sweep as a table for a terminal or a pipe.

use fmc_simulation::sweep::result::Sweep;

use super::results::SweepResults;
use crate::terminal::{self, numbers, words};

/// Writes the simulation, σ of every case and model, the coefficients, and the results.
#[must_use]
pub fn text(sweep: &Sweep) -> String {
    let results = SweepResults::of(sweep);
    let mut lines = vec![results.simulated.clone(), table(&results)];
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

/// Writes a row per case: of every model σ and n - 5, below them the same without noise.
fn table(results: &SweepResults) -> String {
    let models = ["static", "five coefficients", "exact"];
    let columns = std::iter::once(words("simulated"))
        .chain(models.map(|model| numbers(format!("{model}\nσ / n - 5\nwithout noise"))));
    let rows = results.rows.iter().map(|row| {
        let cells = row.cells.iter().map(|cell| {
            let simulated = format!("{} / {}", cell.sigma, cell.as_printed);
            format!("{simulated}\n{}", cell.noise_free)
        });
        std::iter::once(row.case.to_owned()).chain(cells).collect()
    });
    terminal::lines(columns, rows)
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
