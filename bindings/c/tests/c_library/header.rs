//! The checked-in header against the sources.

use std::path::{Path, PathBuf};
use std::{env, fs};

/// Variable that makes the test write the header.
const WRITE: &str = "FMC_WRITE_HEADER";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Returns the header that the sources make.
fn header() -> String {
    let sources = root().join("src");
    let mut files: Vec<_> = fs::read_dir(&sources)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| {
            path.file_stem().is_none_or(|stem| {
                !["control", "error_sentences"]
                    .iter()
                    .any(|other| stem == *other)
            })
        })
        .collect();
    files.sort();
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).unwrap();
    let builder = cbindgen::Builder::new().with_config(config);
    let builder = files.iter().fold(builder, cbindgen::Builder::with_src);
    let mut text = Vec::new();
    builder.generate().unwrap().write(&mut text);
    String::from_utf8(text).unwrap()
}

#[test]
fn header_is_that_of_the_sources() {
    let path = root().join("include/fmc_camera.h");
    let made = header();
    if env::var_os(WRITE).is_some() {
        fs::write(&path, &made).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap();
    assert!(
        kept == made,
        "the header differs; {WRITE}=1 cargo test -p fmc-camera-c --test c_library writes it"
    );
}
