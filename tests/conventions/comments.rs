//! The comments of all sources: one width, and a beginning that names the item.

use std::fs;
use std::path::{Path, PathBuf};

/// Largest width of a comment, in characters.
const WIDTH: usize = 100;

/// Words with which a question begins, and not a description.
const QUESTIONS: [&str; 4] = ["What ", "How ", "Whether ", "Where "];

/// Directories with sources, from the root of the workspace.
const DIRECTORIES: [&str; 8] = [
    "src", "crates", "host-sim", "xtask", "tests", "examples", "benches", "fuzz",
];

fn sources(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            if path.file_name().is_some_and(|name| name != "target") {
                sources(&path, found);
            }
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
}

/// Returns the text of a line of a comment, without code in examples.
fn comments(text: &str) -> impl Iterator<Item = (usize, &str, &str)> {
    let mut is_code = false;
    (1..).zip(text.lines()).filter_map(move |(number, line)| {
        let comment = line.trim_start().strip_prefix("//")?;
        let comment = comment.trim_start_matches(['/', '!']).trim_start();
        let is_fence = comment.starts_with("```");
        is_code ^= is_fence;
        (!is_code && !is_fence && !comment.starts_with('|')).then_some((number, line, comment))
    })
}

/// Returns the faults of a source's comments: line and text.
fn faults(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut before = None;
    for (number, line, comment) in comments(text) {
        // A line in the middle of a comment may begin with any word.
        let is_first = before != Some(number - 1);
        before = Some(number);
        let is_question = is_first && QUESTIONS.iter().any(|word| comment.starts_with(word));
        if line.chars().count() > WIDTH || is_question {
            found.push(format!("line {number}: {line}"));
        }
    }
    found
}

#[test]
fn wide_lines_and_questions_are_found_outside_of_code() {
    let wide = format!("fn f() {{}} // {0}\n/// {0}\n", "x".repeat(100));
    assert_eq!(faults(&wide).len(), 1);
    assert_eq!(faults("/// Whether it is open.\nfn f() {}\n").len(), 1);
    assert_eq!(faults("/// True if it is\n/// Where it was.\n"), [""; 0]);
    let code = format!("/// ```\n/// {}\n/// ```\n", "x".repeat(100));
    assert_eq!(faults(&code), [""; 0]);
}

#[test]
fn comments_are_at_most_100_columns_wide_and_begin_with_no_question() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for directory in DIRECTORIES {
        sources(&root.join(directory), &mut files);
    }
    assert!(files.len() > 600, "{} sources", files.len());
    let found: Vec<_> = files
        .iter()
        .flat_map(|path| {
            let text = fs::read_to_string(path).unwrap();
            let name = path.strip_prefix(root).unwrap().display().to_string();
            let faults = faults(&text).into_iter();
            faults.map(move |fault| format!("{name}, {fault}"))
        })
        .collect();
    assert_eq!(found, [""; 0]);
}
