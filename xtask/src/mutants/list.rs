//! Lists of the project: sources whose mutants have been tried, and mutants that no test can kill.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize, de::DeserializeOwned};

use super::{mutant::Mutant, source_text::SourceText};

/// Sources whose mutants have been tried, as they were then.
pub(super) const TRIED: &str = "docs/mutants.csv";
/// Mutants that survive and do as the library does.
pub(super) const EQUIVALENT: &str = "docs/equivalent-mutants.csv";

/// A source whose mutants are all killed or equivalent.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Tried {
    pub(super) file: String,
    /// CRC-32 of the source, in hexadecimal digits.
    pub(super) crc: String,
    /// Number of mutants that were tried.
    pub(super) mutants: usize,
}

/// A mutant that survives.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Equivalent {
    pub(super) file: String,
    /// Line with the place that is changed.
    pub(super) code: String,
    pub(super) change: String,
    /// Reason that it does as the library does.
    pub(super) reason: String,
}

/// Reads a list.
///
/// # Errors
/// An error if it cannot be read or if a row is none.
pub(super) fn read<T: DeserializeOwned>(root: &Path, list: &str) -> Result<Vec<T>> {
    let mut reader = csv::Reader::from_path(root.join(list)).with_context(|| list.to_owned())?;
    let rows = reader.deserialize().collect::<Result<_, _>>();
    rows.with_context(|| list.to_owned())
}

/// Returns the CRC-32 of a text, in hexadecimal digits.
pub(super) fn crc(text: &str) -> String {
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    format!("{:08x}", crc.checksum(text.as_bytes()))
}

/// Returns the sources in the list that are no longer as they were.
///
/// # Errors
/// An error if a source cannot be read: its row is one too many.
pub(super) fn changed(root: &Path, tried: &[Tried]) -> Result<Vec<String>> {
    let mut changed = vec![];
    for row in tried {
        let text = fs::read_to_string(root.join(&row.file));
        let text = text.with_context(|| format!("{} of {TRIED}", row.file))?;
        if crc(&text) != row.crc {
            changed.push(row.file.clone());
        }
    }
    Ok(changed)
}

/// Replaces the rows of sources, or adds them.
///
/// # Errors
/// An error if a source cannot be read or if the list cannot be written.
pub(super) fn update(root: &Path, mutants_of: &BTreeMap<String, usize>) -> Result<()> {
    let mut rows: Vec<Tried> = read(root, TRIED)?;
    rows.retain(|row| !mutants_of.contains_key(&row.file));
    for (file, mutants) in mutants_of {
        let text = fs::read_to_string(root.join(file)).with_context(|| file.clone())?;
        rows.push(Tried {
            file: file.clone(),
            crc: crc(&text),
            mutants: *mutants,
        });
    }
    rows.sort_by(|a, b| a.file.cmp(&b.file));
    let mut writer = csv::Writer::from_writer(vec![]);
    for row in rows {
        writer.serialize(row)?;
    }
    fs::write(root.join(TRIED), writer.into_inner()?).context(TRIED)
}

/// Compares survivors with the list of those that are equivalent, in both directions, and returns
/// the differences by source.
///
/// `tried` are all mutants of the sources that were tried.
pub(super) fn faults(
    tried: &[Mutant],
    survivors: &[&Mutant],
    equivalent: &[Equivalent],
    text_of: impl Fn(&str) -> String,
) -> BTreeMap<String, Vec<String>> {
    let files: BTreeSet<_> = tried.iter().map(|mutant| &mutant.file).collect();
    let texts: BTreeMap<_, _> = files.iter().map(|file| (*file, text_of(file))).collect();
    let mut faults = BTreeMap::<String, Vec<String>>::new();
    let mut fault = |file: &str, text| faults.entry(file.to_owned()).or_default().push(text);
    let mut listed: Vec<_> = equivalent
        .iter()
        .filter(|row| files.contains(&row.file))
        .collect();
    for row in &listed {
        if row.reason.trim().is_empty() {
            fault(
                &row.file,
                format!("{}: {}: no reason", row.file, row.change),
            );
        }
    }
    for mutant in survivors {
        let text = texts.get(&mutant.file).map_or("", String::as_str);
        let code = SourceText::new(text).line(mutant.span.start.line);
        let at = listed.iter().position(|row| {
            row.file == mutant.file && row.change == mutant.change && row.code == code
        });
        match at {
            Some(at) => _ = listed.swap_remove(at),
            None => fault(&mutant.file, format!("{mutant} survives: {code}")),
        }
    }
    for row in listed {
        let text = format!(
            "{}: {} is killed or is none: {}",
            row.file, row.change, row.code
        );
        fault(&row.file, text);
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::mutant::{Genre, Place, Span};

    fn mutant(file: &str, line: usize, change: &str) -> Mutant {
        let place = Place { line, column: 1 };
        Mutant {
            file: file.to_owned(),
            genre: Genre::BinaryOperator,
            span: Span {
                start: place,
                end: place,
            },
            replacement: "-".to_owned(),
            change: change.to_owned(),
        }
    }

    fn equivalent(code: &str, change: &str, reason: &str) -> Equivalent {
        Equivalent {
            file: "a.rs".to_owned(),
            code: code.to_owned(),
            change: change.to_owned(),
            reason: reason.to_owned(),
        }
    }

    #[test]
    fn survivors_are_compared_with_the_list_in_both_directions() {
        let tried = [
            mutant("a.rs", 2, "replace + with -"),
            mutant("a.rs", 3, "replace + with -"),
            mutant("b.rs", 1, "replace + with -"),
        ];
        let text_of = |_: &str| "fn f() {\n    a + b;\n    c + d;\n}\n".to_owned();
        let [first, second, _] = &tried;
        let faults = |survivors: &[&Mutant], rows: &[Equivalent]| {
            let faults = faults(&tried, survivors, rows, text_of);
            faults.into_values().flatten().collect::<Vec<_>>()
        };
        let known = equivalent("a + b;", "replace + with -", "b is zero");
        assert_eq!(faults(&[], &[]), [""; 0]);
        assert_eq!(faults(&[first], std::slice::from_ref(&known)), [""; 0]);
        assert_eq!(
            faults(&[first, second], std::slice::from_ref(&known)),
            ["a.rs:3:1: replace + with - survives: c + d;"]
        );
        assert_eq!(
            faults(&[], &[known]),
            ["a.rs: replace + with - is killed or is none: a + b;"]
        );
        let without_reason = equivalent("a + b;", "replace + with -", " ");
        assert_eq!(
            faults(&[first], &[without_reason]),
            ["a.rs: replace + with -: no reason"]
        );
        // A source that was not tried says nothing.
        let mut other = equivalent("a + b;", "replace + with -", "b is zero");
        other.file = "c.rs".to_owned();
        assert_eq!(faults(&[], &[other]), [""; 0]);
    }

    #[test]
    fn source_that_is_no_longer_as_it_was_is_named() {
        let folder = std::env::temp_dir().join(format!("fmc-mutants-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("a.rs"), "fn f() {}").unwrap();
        let row = |text: &str| Tried {
            file: "a.rs".to_owned(),
            crc: crc(text),
            mutants: 1,
        };
        assert_eq!(changed(&folder, &[row("fn f() {}")]).unwrap(), [""; 0]);
        assert_eq!(changed(&folder, &[row("fn g() {}")]).unwrap(), ["a.rs"]);
        fs::remove_file(folder.join("a.rs")).unwrap();
        let error = changed(&folder, &[row("fn f() {}")]).unwrap_err();
        assert_eq!(error.to_string(), "a.rs of docs/mutants.csv");
        fs::remove_dir(&folder).unwrap();
    }
}
