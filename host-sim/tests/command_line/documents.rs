//! Commands and files that the documents show.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser as _;
use host_sim::cli::Cli;

use crate::command_line::support::Bench;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Returns the documents: the README, and those of `docs`.
fn documents() -> Vec<PathBuf> {
    let mut found = vec![root().join("README.md"), root().join("docs/demo/README.md")];
    for entry in fs::read_dir(root().join("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "md") {
            found.push(path);
        }
    }
    found
}

/// Returns the commands of `host-sim` in the blocks of a document, each on one line.
fn commands(document: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let (mut in_code, mut goes_on) = (false, false);
    for line in document.lines() {
        if line.starts_with("```") {
            in_code = !in_code;
            continue;
        }
        if !in_code && !line.starts_with("    ") {
            continue;
        }
        let text = line.trim();
        let (text, next) = match text.strip_suffix('\\') {
            Some(text) => (text.trim(), true),
            None => (text, false),
        };
        let text = text.split(" # ").next().unwrap_or_default().trim();
        let command = text
            .strip_prefix("target/release/host-sim ")
            .or(text.strip_prefix("host-sim "));
        match (command, goes_on) {
            (Some(arguments), _) => found.push(arguments.to_owned()),
            (None, true) => {
                let last = found.last_mut().unwrap();
                last.push(' ');
                last.push_str(text);
            }
            (None, false) => continue,
        }
        goes_on = next;
    }
    found
}

/// Returns why the program does not take a command, if it does not.
fn refusal(command: &str) -> Option<String> {
    // The shell, or GNU parallel, puts a number in.
    let command = command
        .replace("$SLURM_ARRAY_TASK_ID", "1")
        .replace("$SLURM_CPUS_PER_TASK", "2")
        .replace("{}", "1");
    let words = command
        .split_whitespace()
        .take_while(|word| ![":::", "|", ">", ">>", "&&"].contains(word))
        .map(|word| word.trim_matches('"').to_owned());
    let words = std::iter::once("host-sim".to_owned()).chain(words);
    let refused = Cli::try_parse_from(words).err()?;
    Some(refused.to_string())
}

#[test]
fn every_command_of_the_documents_has_arguments_that_the_program_takes() {
    let mut refused = Vec::new();
    let mut count = 0;
    for path in documents() {
        let text = fs::read_to_string(&path).unwrap();
        for command in commands(&text) {
            count += 1;
            if let Some(why) = refusal(&command) {
                refused.push(format!("{}: {command}\n{why}", path.display()));
            }
        }
    }
    assert!(count > 30, "{count}");
    assert!(refused.is_empty(), "{}", refused.join("\n"));
}

#[test]
fn command_with_an_unknown_option_is_found_wherever_it_stands() {
    let document = "x\n\n    host-sim frame --camera a.toml \\\n        --vh 0.1 --speed 3 # fast\n\n```text\nhost-sim frobnicate\n```\n";
    let commands = commands(document);
    assert_eq!(
        commands,
        ["frame --camera a.toml --vh 0.1 --speed 3", "frobnicate"]
    );
    for command in commands {
        assert!(refusal(&command).is_some(), "{command}");
    }
}

#[test]
fn camera_file_of_its_document_is_one() {
    let document = include_str!("../../../docs/camera-file.md");
    let (_, file) = document.split_once("```toml\n").unwrap();
    let (file, _) = file.split_once("```").unwrap();
    let bench = Bench::with(file, b"");
    let answer = bench.run(&["camera-file", "check", "camera.toml"]).ok();
    assert!(
        answer.stdout.contains("Double Gauss 150 mm"),
        "{}",
        answer.stdout
    );
}
