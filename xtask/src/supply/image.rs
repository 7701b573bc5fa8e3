//! The images and libraries that leave the project, and the crates in each.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, ensure};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::workspace::Workspace;

/// Name of an image, and cargo's arguments that choose it.
pub(super) const IMAGES: [(&str, &str); 7] = [
    (
        "qemu",
        "-p fmc-camera --features board-mps2 --target thumbv7em-none-eabihf",
    ),
    (
        "board",
        "-p fmc-camera --features board-nucleo-h743zi --target thumbv7em-none-eabihf",
    ),
    ("c", "-p fmc-camera-c --target thumbv7em-none-eabihf"),
    ("host-sim", "-p host-sim --target x86_64-unknown-linux-gnu"),
    (
        "wheel",
        "-p fmc-camera-python --target x86_64-unknown-linux-gnu",
    ),
    (
        "wheel-export",
        "-p fmc-camera-export --target x86_64-unknown-linux-gnu",
    ),
    ("web", "-p fmc-camera-web --target wasm32-unknown-unknown"),
];

/// A crate in an image: a row of the list.
#[derive(Clone, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
pub(super) struct Part {
    pub(super) image: String,
    #[serde(rename = "crate")]
    pub(super) name: String,
    pub(super) version: String,
    pub(super) licence: String,
    /// `yes` if a line of its sources has the word `unsafe`, even one that is left out of the
    /// image.
    #[serde(rename = "unsafe")]
    pub(super) has_unsafe: String,
}

/// Returns the crates that are linked into the images.
///
/// # Errors
/// An error if cargo fails.
pub(super) fn parts(workspace: &Workspace) -> Result<BTreeSet<Part>> {
    let sources = sources(workspace)?;
    let mut has_unsafe = BTreeMap::new();
    let mut parts = BTreeSet::new();
    for (image, arguments) in IMAGES {
        let tree = workspace.cargo(&format!(
            "tree --locked {arguments} -e normal,no-proc-macro --prefix none"
        ));
        let tree = tree.args(["--format", "{p}|{l}"]).read()?;
        let lines = tree.lines().filter(|line| !line.trim().is_empty());
        for text in lines.clone() {
            let part = line(text).with_context(|| format!("cargo tree: {text:?}"));
            let (name, version, licence) = part?;
            let key = (name.to_owned(), version.to_owned());
            let folder = sources
                .get(&key)
                .with_context(|| format!("{name} {version} has no sources"))?;
            let found = *has_unsafe
                .entry(key)
                .or_insert_with(|| is_unsafe(folder).unwrap_or(true));
            parts.insert(Part {
                image: image.to_owned(),
                name: name.to_owned(),
                version: version.to_owned(),
                licence: licence.to_owned(),
                has_unsafe: if found { "yes" } else { "no" }.to_owned(),
            });
        }
        ensure!(lines.count() > 0, "cargo tree: {image} holds no crate");
    }
    Ok(parts)
}

/// Returns name, version and licence of a line such as `csv v1.4.0 (/path)|MIT (*)`.
fn line(line: &str) -> Option<(&str, &str, &str)> {
    let (package, licence) = line.split_once('|')?;
    let mut words = package.split(' ');
    let name = words.next()?;
    let version = words.next()?.strip_prefix('v')?;
    Some((name, version, licence.trim_end_matches(" (*)").trim()))
}

/// Returns the folders of the packages' sources, by name and version.
fn sources(workspace: &Workspace) -> Result<BTreeMap<(String, String), PathBuf>> {
    let metadata = workspace.cargo(
        "metadata --locked --all-features --format-version 1 --filter-platform x86_64-unknown-linux-gnu --filter-platform thumbv7em-none-eabihf --filter-platform wasm32-unknown-unknown",
    );
    let metadata: Value = serde_json::from_str(&metadata.read()?)?;
    let packages = metadata.get("packages").and_then(Value::as_array);
    let packages = packages.context("cargo metadata has no packages")?;
    let text = |package: &Value, key: &str| {
        let value = package.get(key).and_then(Value::as_str);
        value.unwrap_or_default().to_owned()
    };
    let folders = packages.iter().map(|package| {
        let manifest = PathBuf::from(text(package, "manifest_path"));
        let folder = manifest.parent().unwrap_or(Path::new("")).join("src");
        ((text(package, "name"), text(package, "version")), folder)
    });
    Ok(folders.collect())
}

/// Returns true if a source below a folder has the word `unsafe` outside of a comment.
fn is_unsafe(folder: &Path) -> Result<bool> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            if is_unsafe(&path)? {
                return Ok(true);
            }
        } else if path.extension().is_some_and(|end| end == "rs") {
            let bytes = fs::read(&path)?;
            if String::from_utf8_lossy(&bytes).lines().any(has_the_word) {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

fn has_the_word(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    code.split(|character: char| !(character.is_alphanumeric() || character == '_'))
        .any(|word| word == "unsafe")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_of_cargo_is_divided() {
        assert_eq!(
            line("csv v1.4.0 (/path with spaces)|MIT OR Apache-2.0 (*)"),
            Some(("csv", "1.4.0", "MIT OR Apache-2.0"))
        );
        assert_eq!(line(""), None);
    }

    #[test]
    fn word_is_found_in_code_alone() {
        assert!(has_the_word("    unsafe { x }"));
        assert!(has_the_word("pub unsafe fn f() {}"));
        assert!(!has_the_word("#![forbid(unsafe_code)]"));
        assert!(!has_the_word("/// unsafe to call"));
    }
}
