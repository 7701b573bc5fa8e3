//! Sentences of documents and comments.

use std::{
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

/// Documents besides those in docs.
const DOCUMENTS: [&str; 2] = ["README.md", "CHANGELOG.md"];

/// Directories in which documentation of sources is looked for.
const SOURCES: [&str; 6] = ["src", "crates", "host-sim", "benches", "examples", "tests"];

/// Returns the root of the workspace.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the prose of a line: in a document all of it, in a source its comments and the reasons
/// of its lints.
fn prose<'a>(file: &str, line: &'a str) -> Option<&'a str> {
    let line = line.trim();
    if Path::new(file).extension().is_some_and(|end| end == "md") || line.starts_with("reason = \"")
    {
        return Some(line);
    }
    let marks = ["///", "//!", "//", "@"];
    marks.iter().find_map(|mark| line.strip_prefix(mark))
}

/// Returns the paragraphs of a file, each in one line; a row of a table is a paragraph.
pub(crate) fn paragraphs(file: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join(file)).unwrap();
    let mut paragraphs = vec![String::new()];
    for line in text.lines() {
        let words = prose(file, line).map(str::trim).unwrap_or_default();
        let is_first = words.is_empty() || ["- ", "|"].iter().any(|mark| words.starts_with(mark));
        match paragraphs.last_mut() {
            Some(last) if !is_first => {
                if !last.is_empty() {
                    last.push(' ');
                }
                last.push_str(words);
            }
            _ => paragraphs.push(words.to_owned()),
        }
    }
    paragraphs
}

/// Returns the places of the sentences of a paragraph that have one of the words and a number.
pub(crate) fn with_numbers(paragraph: &str) -> Vec<Range<usize>> {
    let mut start = 0;
    let mut found = Vec::new();
    for sentence in paragraph.split_inclusive(". ") {
        let range = start..start + sentence.len();
        start = range.end;
        let mut words = sentence
            .split_whitespace()
            .map(|word| word.trim_matches(|letter: char| !letter.is_alphanumeric()));
        let names = ["instruction", "Instruction", " cycle"];
        let is_named = names.iter().any(|name| sentence.contains(name));
        if is_named && words.any(|word| word.starts_with(|letter: char| letter.is_ascii_digit())) {
            found.push(range);
        }
    }
    found
}

/// Returns the places of a text in a paragraph where it begins and ends with whole words and
/// numbers.
pub(crate) fn places<'a>(
    paragraph: &'a str,
    text: &'a str,
) -> impl Iterator<Item = Range<usize>> + 'a {
    let places = paragraph.match_indices(text);
    places
        .map(|(start, text)| start..start + text.len())
        .filter(|place| {
            let before = paragraph[..place.start].chars().next_back();
            let after = paragraph[place.end..].chars().next();
            let begins = !text.starts_with(char::is_alphanumeric)
                || !before.is_some_and(|letter| letter.is_alphanumeric() || ".,".contains(letter));
            let ends =
                !text.ends_with(char::is_alphanumeric) || !after.is_some_and(char::is_alphanumeric);
            begins && ends
        })
}

/// Returns the paths of the documents and sources, from the root.
pub(crate) fn files() -> Vec<String> {
    let mut files = DOCUMENTS.map(str::to_owned).to_vec();
    let mut directories: Vec<PathBuf> = SOURCES.iter().map(|name| root().join(name)).collect();
    directories.push(root().join("docs"));
    while let Some(directory) = directories.pop() {
        for entry in fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root()).unwrap().to_str().unwrap();
            if path.is_dir() {
                directories.push(path);
            } else if [".md", ".rs", ".s"].iter().any(|end| name.ends_with(end)) {
                files.push(name.replace('\\', "/"));
            }
        }
    }
    files
}

#[test]
fn texts_are_found_as_whole_words() {
    let paragraph = "124 instructions, 24 instructions";
    let mut found = places(paragraph, "24 instructions");
    assert_eq!(found.next(), Some(18..33));
    assert_eq!(found.next(), None);
    assert_eq!(places("1.24 points", "24 points").count(), 0);
    assert_eq!(places("24 points", "24 point").count(), 0);
}

#[test]
fn sentences_with_the_words_and_a_number_are_found() {
    let paragraph =
        "It takes 24 instructions. It takes 24 ms. Instructions are counted. In 3.5 cycles.";
    let found: Vec<_> = with_numbers(paragraph)
        .into_iter()
        .map(|place| &paragraph[place])
        .collect();
    assert_eq!(found, ["It takes 24 instructions. ", "In 3.5 cycles."]);
}
