//! The terms of section 15: the types in whose names they occur.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use syn::Item;

use super::document::{names, rows};

/// Directories of the library's sources and of the PC's, programs for a target excepted.
fn sources() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = fs::read_dir(root.join("crates")).unwrap();
    let crates = crates.map(|entry| entry.unwrap().path().join("src"));
    ["src/geometry", "src/flight", "src/io", "host-sim/src"]
        .map(|directory| root.join(directory))
        .into_iter()
        .chain(crates.filter(|path| path.is_dir()))
        .collect()
}

fn files_in(directory: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files_in(&path, files);
        } else if path.extension().is_some_and(|end| end == "rs") {
            files.push(path);
        }
    }
}

/// Names of the public types of a module and of the modules in its file.
fn public_types(items: &[Item], found: &mut Vec<String>) {
    for item in items {
        let (visibility, name) = match item {
            Item::Struct(item) => (&item.vis, &item.ident),
            Item::Enum(item) => (&item.vis, &item.ident),
            Item::Trait(item) => (&item.vis, &item.ident),
            Item::Type(item) => (&item.vis, &item.ident),
            Item::Mod(item) => {
                let items = item.content.as_ref().map(|(_, items)| items.as_slice());
                public_types(items.unwrap_or_default(), found);
                continue;
            }
            _ => continue,
        };
        if matches!(visibility, syn::Visibility::Public(_)) {
            found.push(name.to_string());
        }
    }
}

fn types() -> Vec<String> {
    let mut files = Vec::new();
    for directory in sources() {
        files_in(&directory, &mut files);
    }
    let mut found = Vec::new();
    for path in files {
        let file = syn::parse_file(&fs::read_to_string(&path).unwrap());
        let file = file.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        public_types(&file.items, &mut found);
    }
    assert!(found.len() > 300, "{} types", found.len());
    found
}

/// Returns true if the name has the word, at the beginning or after another word, as a whole or
/// in the plural.
fn has(name: &str, word: &str) -> bool {
    let ends = |rest: &str| {
        let rest = rest.strip_prefix('s').unwrap_or(rest);
        rest.chars().next().is_none_or(char::is_uppercase)
    };
    name.match_indices(word)
        .any(|(at, _)| ends(&name[at + word.len()..]))
}

#[test]
fn words_of_a_name_are_found() {
    assert!(has("FrameRecord", "Frame") && has("FrameRecord", "Record"));
    assert!(has("Events", "Event") && has("TrueFrame", "Frame") && has("VhFindingKind", "Finding"));
    assert!(!has("Started", "Start") && !has("Framed", "Frame") && !has("Recorder", "Record"));
}

#[test]
fn each_term_stands_for_the_types_of_its_row_alone() {
    let types = types();
    let rows = rows("term");
    let mut words = BTreeSet::new();
    let mut listed = BTreeSet::new();
    let mut problems = Vec::new();
    for row in &rows {
        let [word] = names(row[2])[..] else {
            panic!("{row:?}: one word")
        };
        assert!(words.insert(word), "{word} is in two rows");
        for name in names(row[3]) {
            assert!(has(name, word), "{name} is in the row of {word}");
            assert!(listed.insert(name), "{name} is listed twice");
            let times = types.iter().filter(|known| *known == name).count();
            if times != 1 {
                problems.push(format!("{name} is a public type {times} times"));
            }
        }
    }
    for name in types.iter().filter(|name| !listed.contains(name.as_str())) {
        let of = words.iter().filter(|word| has(name, word));
        problems.extend(of.map(|word| format!("{name} has {word} in its name and is not listed")));
    }
    assert_eq!(problems, [""; 0], "section 15");
}
