//! Rounding of single precision, proved by Gappa for every number of a range.
//!
//! The computations come from the library's sources, and the bounds from `docs/rounding.md`. A
//! bound is accepted if Gappa proves it and does not prove one that is a hundredth smaller: so a
//! bound is that of Gappa, and a proof that holds for anything is found out.

mod claims;
mod expression;
mod function;
mod script;
mod source;

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use anyhow::{Context as _, Result, bail, ensure};

use crate::workspace::Workspace;
use claims::Claim;

/// Document with the bounds.
const DOCUMENT: &str = "docs/rounding.md";

/// Factor to a bound that must be refused.
const SMALLER: f64 = 0.99;

/// Proves the bounds of the document.
///
/// # Errors
/// An error if a bound is not proved, is larger than Gappa's by a hundredth, is missing, is that of
/// no claim or stands there twice.
pub(crate) fn check(workspace: &Workspace, gappa: &Path) -> Result<()> {
    let claims = claims::all(&workspace.root)?;
    let document = fs::read_to_string(workspace.root.join(DOCUMENT)).context(DOCUMENT)?;
    let out = workspace.target_dir.join("rounding");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
    }
    fs::create_dir_all(&out).with_context(|| out.display().to_string())?;
    let prover = Prover {
        gappa: gappa.to_owned(),
        out,
    };
    let rows = rows(&document);
    let mut findings = Vec::new();
    for claim in &claims {
        findings.extend(prover.judged(claim, &rows)?);
    }
    let names: Vec<_> = claims.iter().map(|claim| claim.name.as_str()).collect();
    findings.extend(superfluous(&rows, &names));
    ensure!(
        findings.is_empty(),
        "bounds of {DOCUMENT}:\n    {}",
        findings.join("\n    ")
    );
    ensure!(!claims.is_empty(), "nothing is claimed");
    eprintln!(
        "{} bounds are proved, and refused if a hundredth smaller",
        claims.len()
    );
    Ok(())
}

/// Row of the document: name, bound and unit.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    name: String,
    bound: String,
    unit: String,
}

/// Returns the rows of the document's tables that have a bound.
fn rows(document: &str) -> Vec<Row> {
    let row = |line: &str| {
        let cells: Vec<_> = line.strip_prefix('|')?.split('|').map(str::trim).collect();
        let [name, bound, unit, ""] = cells.as_slice() else {
            return None;
        };
        bound.parse::<f64>().ok()?;
        let [name, bound, unit] = [name, bound, unit].map(|cell| (*cell).to_owned());
        Some(Row { name, bound, unit })
    };
    document.lines().filter_map(row).collect()
}

/// Returns what is wrong with rows that no claim has, or that are not the only one of theirs.
fn superfluous(rows: &[Row], claims: &[&str]) -> Vec<String> {
    let mut findings = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let name = &row.name;
        if !claims.contains(&name.as_str()) {
            findings.push(format!("nothing is claimed by the row of {name}"));
        }
        if rows.iter().take(index).any(|other| other.name == *name) {
            findings.push(format!("there is another row of {name}"));
        }
    }
    findings
}

/// Gappa, and the directory of the scripts.
struct Prover {
    gappa: PathBuf,
    out: PathBuf,
}

impl Prover {
    /// Returns what is wrong with the bound of a claim, if something is.
    fn judged(&self, claim: &Claim, rows: &[Row]) -> Result<Option<String>> {
        let name = &claim.name;
        let unit = claim.script.unit.text();
        let Some(row) = rows
            .iter()
            .find(|row| row.name == *name && row.unit == unit)
        else {
            let found = self.bound(claim)?;
            return Ok(Some(format!(
                "there is no row | {name} | {found} | {unit} |"
            )));
        };
        if !self.proves(claim, &row.bound)? {
            let found = self.bound(claim)?;
            return Ok(Some(format!(
                "{name}: {} is not proved; {found} is",
                row.bound
            )));
        }
        self.keep(claim, &row.bound)?;
        let smaller = SMALLER * row.bound.parse::<f64>()?;
        if self.proves(claim, &format!("{smaller:e}"))? {
            let found = self.bound(claim)?;
            return Ok(Some(format!(
                "{name}: {} is proved, and so is {smaller:e}: say {found}",
                row.bound
            )));
        }
        Ok(None)
    }

    /// Returns true if Gappa proves a bound.
    fn proves(&self, claim: &Claim, bound: &str) -> Result<bool> {
        let (is_proved, text) = self.run(claim, Some(bound))?;
        // A script that cannot be read is no refusal.
        if !is_proved && !text.contains("were not satisfied") {
            bail!("{}: Gappa says {text}", claim.name);
        }
        Ok(is_proved)
    }

    /// Returns the bound that Gappa finds, upwards to three digits.
    fn bound(&self, claim: &Claim) -> Result<String> {
        let (_, text) = self.run(claim, None)?;
        let ends = text.split('{').skip(1);
        let ends = ends.filter_map(|end| end.split(',').next()?.parse::<f64>().ok());
        let found = ends.map(f64::abs).reduce(f64::max);
        let found = found.with_context(|| format!("{}: Gappa says {text}", claim.name))?;
        Ok(three_digits_up(found))
    }

    /// Leaves the script of a bound that is proved in the directory.
    fn keep(&self, claim: &Claim, bound: &str) -> Result<()> {
        let file: String = claim
            .name
            .chars()
            .map(|one| {
                if one.is_ascii_alphanumeric() {
                    one
                } else {
                    '-'
                }
            })
            .collect();
        let path = self.out.join(format!("{file}.g"));
        let script = script(claim, Some(bound))?;
        fs::write(&path, script).with_context(|| path.display().to_string())
    }

    /// Runs the script of a claim.
    fn run(&self, claim: &Claim, bound: Option<&str>) -> Result<(bool, String)> {
        let script = script(claim, bound)?;
        // A refusal would halve the ranges a hundred times before it is one.
        let mut gappa = Command::new(&self.gappa)
            .arg("-Eno-auto-dichotomy")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| self.gappa.display().to_string())?;
        // The whole script is written and the pipe closed before anything is read: both are short.
        gappa
            .stdin
            .take()
            .context("no pipe to Gappa")?
            .write_all(script.as_bytes())?;
        let output = gappa.wait_with_output()?;
        let text = [output.stdout, output.stderr].concat();
        let text = String::from_utf8_lossy(&text);
        // Names that stand for others are no matter.
        let lines = text
            .lines()
            .filter(|line| !line.starts_with("Warning: renaming"));
        let text: Vec<_> = lines.collect();
        Ok((output.status.success(), text.join("\n")))
    }
}

/// Returns a number upwards to three digits, and by more than what Gappa's decimals leave out.
fn three_digits_up(number: f64) -> String {
    let digit = number.log10().floor() - 2.0;
    let unit = 10_f64.powf(digit);
    let up = (number / unit * (1.0 + 1e-5)).ceil() * unit;
    format!("{up:.2e}")
}

fn script(claim: &Claim, bound: Option<&str>) -> Result<String> {
    let text = claim.script.text(bound);
    text.with_context(|| claim.name.clone())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_with_a_number() {
        let document =
            "| what | at most | |\n|---|---|---|\n| a, b | 1.50e-7 | of it |\n| c | d | nm |";
        let row = Row {
            name: "a, b".to_owned(),
            bound: "1.50e-7".to_owned(),
            unit: "of it".to_owned(),
        };
        assert_eq!(rows(document), [row]);
    }

    #[test]
    fn row_without_a_claim_and_a_second_one_of_a_claim_are_found() {
        let rows = rows("| a | 1 | nm |\n| b | 1 | nm |\n| a | 2 | 1 |");
        let found = superfluous(&rows, &["a"]);
        let expected = [
            "nothing is claimed by the row of b",
            "there is another row of a",
        ];
        assert_eq!(found, expected);
        assert_eq!(superfluous(&rows[..2], &["a", "b"]), Vec::<String>::new());
    }

    /// With a program in the place of Gappa that proves a bound of 2 and no other.
    #[cfg(unix)]
    #[test]
    fn script_that_stays_is_the_proved_one() {
        use std::os::unix::fs::PermissionsExt as _;

        use super::{function::Definitions, script::Unit};

        let folder = xshell::Shell::new().unwrap().create_temp_dir().unwrap();
        let gappa = folder.path().join("gappa");
        let text = "#!/bin/sh\ngrep -q '<= 2 }' && exit\necho were not satisfied '{3,'\nexit 1\n";
        fs::write(&gappa, text).unwrap();
        fs::set_permissions(&gappa, fs::Permissions::from_mode(0o755)).unwrap();
        let out = folder.path().to_owned();
        let prover = Prover { gappa, out };
        let script = script::Script {
            definitions: Definitions::default(),
            given: [].into(),
            result: expression::Expression::Name("y".to_owned()),
            unit: Unit::Nanometres,
        };
        let name = "y of x".to_owned();
        let claim = Claim { name, script };
        let kept = || fs::read_to_string(folder.path().join("y-of-x.g"));
        for other in ["| y of x | 1 | nm |", "| y of x | 2 | 1 |"] {
            assert!(prover.judged(&claim, &rows(other)).unwrap().is_some());
            assert!(kept().is_err());
        }
        let found = prover.judged(&claim, &rows("| y of x | 2 | nm |"));
        assert_eq!(found.unwrap(), None);
        assert!(kept().unwrap().ends_with("<= 2 }\n"));
    }

    #[test]
    fn bounds_that_the_library_states_are_those_of_the_document() {
        let rows = rows(include_str!("../../../docs/rounding.md"));
        let largest = |start: &str, camera: &str| {
            let of = rows.iter().filter(|row| {
                row.name.starts_with(start) && row.name.contains(camera) && row.unit == "nm"
            });
            let bounds = of.map(|row| row.bound.parse::<f64>().unwrap());
            format!("{:.2} nm", bounds.reduce(f64::max).unwrap())
        };
        let distortion = largest("distortion d", "");
        let brown = include_str!("../../../src/geometry/brown.rs");
        assert!(brown.contains(&format!("Rounding ≤ {distortion} for the published")));
        let correction = include_str!("../../../src/geometry/frame_correction.rs");
        let correction = correction.replace("\n    /// ", " ");
        let stated = [
            format!("the distortion by at most {distortion}"),
            format!("at most {} on the iXM", largest("corrected x", "ixm")),
            format!("{} on the RC30", largest("corrected x", "rc30")),
        ];
        for text in stated {
            assert!(correction.contains(&text), "{text}");
        }
    }

    #[test]
    fn proposed_bound_is_less_than_a_hundredth_above_what_is_proved() {
        for number in [1.0001, 3.8235, 9.9999, 2.778e-1, 1.1921e-7] {
            let bound: f64 = three_digits_up(number).parse().unwrap();
            assert!(number < bound && 0.99 * bound < number, "{number}: {bound}");
        }
    }
}
