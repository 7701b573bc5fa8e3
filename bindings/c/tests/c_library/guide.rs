//! The code of `docs/c.md`.

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

const GUIDE: &str = include_str!("../../../../docs/c.md");

/// Returns what the C compiler has against a program.
fn faults(program: &str) -> Option<String> {
    let include = Path::new(env!("CARGO_MANIFEST_DIR")).join("include");
    let compiler = std::env::var_os("CC").unwrap_or_else(|| "cc".into());
    let mut child = Command::new(compiler)
        .args("-std=c99 -Wall -Wextra -pedantic -Werror -fsyntax-only -x c -".split(' '))
        .arg("-I")
        .arg(include)
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(program.as_bytes()).unwrap();
    drop(stdin);
    let output = child.wait_with_output().unwrap();
    (!output.status.success()).then(|| String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn code_of_the_guide_compiles_without_a_warning() {
    let blocks: Vec<&str> = GUIDE
        .split("```c\n")
        .skip(1)
        .filter_map(|block| block.split("```").next())
        .collect();
    assert!(!blocks.is_empty());
    for block in blocks {
        let program = format!("#include \"fmc_camera.h\"\n{block}");
        assert_eq!(faults(&program), None, "{program}");
        let other = program.replacen("fmc_camera_init(", "fmc_camera_begin(", 1);
        assert_ne!(other, program);
        assert!(faults(&other).is_some());
    }
}
