//! `cargo xtask supply`: the list of what each image holds, and its rules.

mod image;
mod rules;
mod unsafe_list;

use std::{collections::BTreeSet, path::Path, process::ExitCode};

use anyhow::{Context as _, Result, bail};

use self::image::Part;
use crate::workspace::Workspace;

/// The list.
const LIST: &str = "docs/supply-chain.csv";

/// Checks what the images hold against the list and the rules; with `update` writes the list.
///
/// # Errors
/// An error that names every crate that is not listed, or breaks a rule.
pub(crate) fn run(workspace: &Workspace, update: bool) -> Result<ExitCode> {
    let _root = workspace.shell.push_dir(&workspace.root);
    if update {
        let parts = image::parts(workspace)?;
        write(&workspace.root.join(LIST), &parts)?;
    }
    check(workspace)?;
    println!("{}", workspace.root.join(LIST).display());
    Ok(ExitCode::SUCCESS)
}

/// Checks what the images hold against the list and the rules, and the project's own `unsafe`.
///
/// # Errors
/// An error that names every crate that is not listed, or breaks a rule.
pub(crate) fn check(workspace: &Workspace) -> Result<()> {
    unsafe_list::check(&workspace.root)?;
    // The targets of the fuzzing, which no other step builds, have a lock of their own.
    let fuzz = "metadata --locked --format-version 1 --manifest-path fuzz/Cargo.toml";
    let locked = workspace.cargo(fuzz).quiet().ignore_stdout();
    locked.run().context("fuzz/Cargo.lock")?;
    let parts = image::parts(workspace)?;
    let mut faults = rules::faults(&parts);
    faults.extend(differences(&read(&workspace.root.join(LIST))?, &parts));
    if parts.is_empty() || !faults.is_empty() {
        bail!("what the images hold:\n{}", faults.join("\n"));
    }
    for (image, _) in image::IMAGES {
        let count = parts.iter().filter(|part| part.image == image).count();
        eprintln!("{image}: {count} crates, all listed");
    }
    Ok(())
}

/// Returns how the list differs from what the images hold.
fn differences(listed: &BTreeSet<Part>, parts: &BTreeSet<Part>) -> Vec<String> {
    let row = |part: &Part| {
        format!(
            "{}: {} {}, {}, unsafe: {}",
            part.image, part.name, part.version, part.licence, part.has_unsafe
        )
    };
    let new = parts.difference(listed).map(|part| {
        let part = row(part);
        format!("{part} is not in {LIST}; once it is looked at: cargo xtask supply --update")
    });
    let gone = listed.difference(parts);
    new.chain(gone.map(|part| format!("{} is in {LIST} alone", row(part))))
        .collect()
}

fn read(path: &Path) -> Result<BTreeSet<Part>> {
    let mut reader = csv::Reader::from_path(path).with_context(|| path.display().to_string())?;
    let rows = reader.deserialize().collect::<Result<_, _>>();
    rows.with_context(|| path.display().to_string())
}

fn write(path: &Path, parts: &BTreeSet<Part>) -> Result<()> {
    let mut writer = csv::Writer::from_path(path).with_context(|| path.display().to_string())?;
    for part in parts {
        writer.serialize(part)?;
    }
    writer.flush().with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn new_dependency_and_one_that_has_gone_are_differences() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let listed = read(&root.join(LIST)).unwrap();
        assert!(listed.len() > 300, "{}", listed.len());
        assert_eq!(differences(&listed, &listed), Vec::<String>::new());
        let mut parts = listed.clone();
        let mut first = parts.pop_first().unwrap();
        assert_eq!(differences(&listed, &parts).len(), 1);
        first.version.push_str("-new");
        let new = format!("{} {}", first.name, first.version);
        parts.insert(first);
        let found = differences(&listed, &parts);
        assert_eq!(found.len(), 2);
        assert!(
            found[0].contains(&new) && found[0].contains("is not in"),
            "{found:?}"
        );
    }

    #[test]
    fn listed_crates_keep_the_rules() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let listed = read(&root.join(LIST)).unwrap();
        assert_eq!(rules::faults(&listed), Vec::<String>::new());
    }
}
