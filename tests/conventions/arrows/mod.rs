//! Direction of dependencies, from the edge to the core: cargo keeps it between crates, these tests
//! inside a crate.

mod circles;
mod modules;

use std::fs;
use std::path::{Path, PathBuf};

use self::circles::{between, circles, of_the_top_level};
use self::modules::{Arrows, of_directory, of_files};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the arrows of the library; its programs are crates of their own.
fn library() -> Arrows {
    of_directory(&root().join("src"), &["bin"])
}

/// Returns the arrows of every library of `crates`.
fn crates() -> Vec<(String, Arrows)> {
    let entries = fs::read_dir(root().join("crates")).unwrap();
    let directories = entries.map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> = directories.filter(|path| path.is_dir()).collect();
    found.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    let arrows = |path: &Path| of_directory(&path.join("src"), &[]);
    found
        .iter()
        .map(|path| (name(path), arrows(path)))
        .collect()
}

fn count(arrows: &Arrows) -> usize {
    arrows.values().map(std::collections::BTreeSet::len).sum()
}

#[test]
fn geometry_knows_neither_flight_nor_io_and_flight_neither_link_nor_store() {
    let arrows = library();
    assert!(count(&arrows) > 100, "{arrows:#?}");
    assert_ne!(between(&arrows, "flight", "geometry"), [""; 0]);
    for (from, to) in [
        ("geometry", "flight"),
        ("geometry", "io"),
        ("flight", "io::link"),
        ("flight", "io::store"),
    ] {
        assert_eq!(between(&arrows, from, to), [""; 0], "{from} knows {to}");
    }
}

#[test]
fn no_modules_of_a_crates_top_level_use_each_other_in_a_circle() {
    for (name, arrows) in crates() {
        assert_eq!(
            circles(&of_the_top_level(&arrows)),
            [""; 0],
            "crates/{name}"
        );
    }
    let program = of_directory(&root().join("host-sim/src"), &[]);
    assert_eq!(circles(&of_the_top_level(&program)), [""; 0], "host-sim");
    assert_eq!(circles(&of_the_top_level(&library())), [""; 0], "src");
}

#[test]
fn no_files_of_a_crate_use_each_other_in_a_circle() {
    let crates = crates();
    for expected in [
        "adjustment",
        "camera-file",
        "exchange",
        "frames",
        "reference",
        "report",
        "simulation",
    ] {
        let (_, arrows) = crates.iter().find(|(name, _)| name == expected).unwrap();
        assert!(count(arrows) >= arrows.len(), "{expected}: {arrows:#?}");
    }
    for (name, arrows) in crates {
        assert_eq!(circles(&arrows), [""; 0], "crates/{name}");
    }
    assert_eq!(circles(&library()), [""; 0], "src");
}

/// Returns the arrows of a sample, whose files are given by name and text.
fn sample(files: &[(&str, &str)]) -> Arrows {
    let owned = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
    of_files(&files.iter().map(owned).collect::<Vec<_>>())
}

#[test]
fn circle_is_found_and_named_however_its_paths_are_written() {
    let lens = "use super::shutter::{self, blade::Blade}; pub struct Lens;";
    for (text, is_circle) in [
        ("use crate::lens::Lens;", true),
        ("use super::super::lens as glass;", true),
        ("fn f(_: crate::lens::Lens) {}", true),
        ("fn f() { println!(\"{}\", g(crate::lens::name())) }", true),
        ("mod inner { use super::super::super::lens::Lens; }", true),
        ("use crate::Lens;", true),
        ("use fmc_camera::lens::Lens;", false),
        ("//! [`Lens`](crate::lens::Lens)", false),
        ("pub(in crate::shutter) struct Blade;", false),
        ("mod lens {} use self::lens as _;", false),
        ("#[cfg(test)] mod tests { use crate::lens::Lens; }", false),
    ] {
        let arrows = sample(&[
            (
                "lib.rs",
                "pub mod lens; pub mod shutter; pub use lens::Lens;",
            ),
            ("lens.rs", lens),
            ("shutter/mod.rs", "pub mod blade;"),
            ("shutter/blade.rs", text),
        ]);
        let expected: &[&str] = if is_circle {
            &["lens → shutter::blade → lens"]
        } else {
            &[]
        };
        assert_eq!(circles(&arrows), expected, "{text}: {arrows:?}");
        let top: &[&str] = if is_circle {
            &["lens → shutter → lens"]
        } else {
            &[]
        };
        assert_eq!(circles(&of_the_top_level(&arrows)), top, "{text}");
        let forbidden: &[&str] = if is_circle {
            &["shutter::blade → lens"]
        } else {
            &[]
        };
        assert_eq!(between(&arrows, "shutter", "lens"), forbidden, "{text}");
    }
}

#[test]
fn parent_that_passes_its_child_on_does_not_use_it_and_one_that_calls_it_does() {
    let child = ("stage/path.rs", "use super::Stage; pub struct Path;");
    let parent = |text| sample(&[("lib.rs", "mod stage;"), ("stage/mod.rs", text), child]);
    let passes_on = parent("mod path; pub use path::Path; pub struct Stage;");
    assert_eq!(circles(&passes_on), [""; 0]);
    for text in [
        "mod path; use path::Path; pub struct Stage;",
        "mod path; pub struct Stage; fn f() { path::Path; }",
    ] {
        assert_eq!(circles(&parent(text)), ["stage → stage::path → stage"]);
    }
    // An item of another module that is passed on is an arrow.
    let elsewhere = sample(&[
        ("lib.rs", "mod stage; mod io;"),
        ("stage.rs", "pub use crate::io::Port;"),
        ("io.rs", "pub struct Port;"),
    ]);
    assert_eq!(between(&elsewhere, "stage", "io"), ["stage → io"]);
}

#[test]
fn files_without_a_circle_can_make_one_of_their_folders() {
    let arrows = sample(&[
        ("lib.rs", "mod a; mod b;"),
        ("a/mod.rs", "mod first; mod second;"),
        ("a/first.rs", "use crate::b::first::B;"),
        ("a/second.rs", ""),
        ("b/mod.rs", "mod first; mod second;"),
        ("b/first.rs", ""),
        ("b/second.rs", "use crate::a::second::A;"),
    ]);
    assert_eq!(circles(&arrows), [""; 0]);
    assert_eq!(circles(&of_the_top_level(&arrows)), ["a → b → a"]);
}

#[test]
fn files_of_tests_are_left_out() {
    let arrows = sample(&[
        ("lib.rs", "mod a; #[cfg(test)] mod fixture;"),
        ("a.rs", "#[cfg(test)] use crate::fixture::F;"),
        ("fixture.rs", "use crate::a::A;"),
    ]);
    assert_eq!(arrows.len(), 2, "{arrows:?}");
    assert_eq!(circles(&arrows), [""; 0]);
}
