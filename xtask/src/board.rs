//! Image for the real board: lints, build, and the functions in it that can panic.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use anyhow::{Context as _, Result, bail, ensure};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, RelocationTarget, SymbolKind};

use crate::{
    firmware::{self, Image},
    stack,
    target::Target,
    workspace::Workspace,
};

/// Document of the board.
const DOCUMENT: &str = "docs/board.md";

/// Runner of cargo in place of the one that flashes a board: it prints the image's path.
const RUNNER: (&str, &str) = (
    "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUNNER",
    if cfg!(windows) { "cmd /c echo" } else { "echo" },
);

/// List of the functions that may panic.
const ALLOWED: &str = "docs/board-panics.txt";

/// Callers of a function, by name.
type Callers = BTreeMap<String, BTreeSet<String>>;

/// Lints and links the image, compares its panics with the list, bounds its stack, runs the
/// document's command without a board, and copies the image to `<target>/firmware`.
///
/// # Errors
/// An error if the image has lints, does not link, can panic in functions that are not listed, or
/// has a stack without a bound.
pub(crate) fn check(workspace: &Workspace, target: &Target<'_>) -> Result<()> {
    let board = Image::NucleoH743zi;
    firmware::lint(target, board)?;
    let image = firmware::link_with_relocations(target, board)?;
    let found = panicking(&callers(&image)?);
    // The vendor's clock set-up can panic: if it is not found, the check does not work.
    ensure!(
        !found.is_empty(),
        "no function of the image can panic, not even those of {ALLOWED}: either shorten it, or the check is blind"
    );
    let allowed = workspace.shell.read_file(workspace.root.join(ALLOWED))?;
    let unlisted: Vec<_> = found
        .iter()
        .filter(|name| !listed(&allowed).any(|listed| listed == *name))
        .map(String::as_str)
        .collect();
    ensure!(
        unlisted.is_empty(),
        "{ALLOWED} does not list functions of the image that can panic:\n    {}",
        unlisted.join("\n    ")
    );
    eprintln!(
        "{} functions can panic, as listed in {ALLOWED}",
        found.len()
    );
    for name in listed(&allowed).filter(|name| !found.contains(*name)) {
        eprintln!("note: {ALLOWED} lists {name}, which cannot panic with this compiler");
    }

    let image = firmware::build(workspace, target, board)?;
    eprintln!("image: {}", image.display());
    stack::check(&workspace.root, &image)?;
    check_command(workspace, target, &image)
}

/// Runs the command by which the document flashes the image, with a runner that needs no board. It
/// must make the image that is kept, and the image must name its sources.
fn check_command(workspace: &Workspace, target: &Target<'_>, image: &Path) -> Result<()> {
    let document = workspace.shell.read_file(workspace.root.join(DOCUMENT))?;
    let command = flash_command(&document).with_context(|| format!("no command in {DOCUMENT}"))?;
    let command = target.cargo(&command).env(RUNNER.0, RUNNER.1);
    eprintln!("$ {command}");
    command.run()?;
    let read = |path: &Path| std::fs::read(path).with_context(|| path.display().to_string());
    let made = read(&target.programs().join("firmware"))?;
    ensure!(
        made == read(image)?,
        "the command of {DOCUMENT} makes another image than this step"
    );
    Ok(())
}

/// Returns cargo's arguments of the document's command, without the target, which [`Target::cargo`]
/// adds.
fn flash_command(document: &str) -> Option<String> {
    let line = document
        .lines()
        .find_map(|line| line.strip_prefix("    cargo run "))?;
    let arguments = line.replace(" --target thumbv7em-none-eabihf", "");
    (arguments != line).then(|| format!("run {arguments}"))
}

/// Returns the callers of every function in an image that was linked with its relocations.
fn callers(image: &Path) -> Result<Callers> {
    let data = std::fs::read(image).with_context(|| image.display().to_string())?;
    let file = object::File::parse(&*data)?;
    // Bit 0 of a function's address marks Thumb code.
    let functions: BTreeMap<u64, (u64, String)> = file
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0)
        .filter_map(|symbol| {
            let name = path_of(symbol.name().ok()?);
            Some((symbol.address() & !1, (symbol.size(), name)))
        })
        .collect();
    let at = |address: u64| {
        let (start, (size, name)) = functions.range(..=address).next_back()?;
        (address < start + size).then_some(name)
    };

    let mut callers = Callers::new();
    let code = file
        .sections()
        .filter(|section| section.kind() == object::SectionKind::Text);
    for (address, relocation) in code.flat_map(|section| section.relocations().collect::<Vec<_>>())
    {
        let RelocationTarget::Symbol(index) = relocation.target() else {
            continue;
        };
        let target = file.symbol_by_index(index)?;
        if let (Some(caller), Some(callee)) = (at(address), at(target.address() & !1)) {
            callers
                .entry(callee.clone())
                .or_default()
                .insert(caller.clone());
        }
    }
    if callers.is_empty() {
        bail!("{} has no relocations", image.display());
    }
    Ok(callers)
}

/// Returns the functions outside the core library that reach the panic handler only through the
/// core library.
fn panicking(callers: &Callers) -> BTreeSet<String> {
    let handler = |name: &&String| name.ends_with("rust_begin_unwind");
    let mut open: Vec<_> = callers.keys().filter(handler).collect();
    let mut seen: BTreeSet<_> = open.iter().copied().collect();
    let mut found = BTreeSet::new();
    while let Some(callee) = open.pop() {
        for caller in callers.get(callee).into_iter().flatten() {
            if !is_core(caller) {
                found.insert(caller.clone());
            } else if seen.insert(caller) {
                open.push(caller);
            }
        }
    }
    found
}

/// Returns the readable path of a function, without hashes, in one form for all ways in which
/// compilers write methods.
pub(crate) fn path_of(symbol: &str) -> String {
    format!("{:#}", rustc_demangle::demangle(symbol)).replace(['<', '>'], "")
}

/// Returns true for a function of the core library, which includes those of primitive types.
fn is_core(path: &str) -> bool {
    let own = path.trim_start_matches(['&', '[', '(', '*']);
    let own = own.strip_prefix("mut ").unwrap_or(own);
    let (first, _) = own.split_once([':', ' ']).unwrap_or((own, ""));
    let primitive = own.contains(" as ") && !own.starts_with(&format!("{first}::"));
    first == "core" || first == "__rustc" || primitive
}

/// Returns the functions that a list names, one per line.
fn listed(list: &str) -> impl Iterator<Item = &str> {
    list.lines().filter(|line| !line.starts_with('#'))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use std::path::Path;

    use super::{Callers, DOCUMENT, flash_command, is_core, listed, panicking};

    #[test]
    fn first_callers_outside_core_are_found_through_core() {
        let callers: Callers = [
            ("__rustc::rust_begin_unwind", "core::panicking::panic_fmt"),
            ("core::panicking::panic_fmt", "core::option::unwrap_failed"),
            (
                "core::panicking::panic_fmt",
                "u32 as core::fmt::Display::fmt",
            ),
            ("core::option::unwrap_failed", "vendor::start"),
            ("u32 as core::fmt::Display::fmt", "firmware::show"),
            ("vendor::start", "firmware::main"),
            ("firmware::other", "firmware::main"),
        ]
        .into_iter()
        .map(|(callee, caller)| (callee.to_owned(), BTreeSet::from([caller.to_owned()])))
        .fold(Callers::new(), |mut callers, (callee, caller)| {
            callers.entry(callee).or_default().extend(caller);
            callers
        });
        assert_eq!(
            panicking(&callers).into_iter().collect::<Vec<_>>(),
            ["firmware::show", "vendor::start"]
        );
    }

    #[test]
    fn types_of_others_are_not_core_even_in_its_traits() {
        assert!(is_core("core::str::count::do_count_chars"));
        assert!(is_core("usize as core::fmt::Display::fmt"));
        assert!(!is_core("firmware::Error as core::fmt::Display::fmt"));
        assert!(!is_core("main"));
    }

    #[test]
    fn list_names_functions_in_lines_that_are_no_comments() {
        let list = "# a::comment\na::start\na::clock::set\n";
        assert_eq!(
            listed(list).collect::<Vec<_>>(),
            ["a::start", "a::clock::set"]
        );
    }

    #[test]
    fn command_of_the_document_is_found_and_names_its_package() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let document = std::fs::read_to_string(root.join(DOCUMENT)).unwrap();
        let command = flash_command(&document).unwrap();
        // Without its package cargo takes features of the PC's programs, which need std.
        assert!(command.contains("-p fmc-camera "), "{command}");
        assert_eq!(flash_command("    cargo run --bin firmware\n"), None);
    }

    /// The board's document has the pins and the speed of the firmware's link.
    #[test]
    fn pin_table_is_that_of_the_firmware() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
        let document = read("docs/board.md");
        let board = read("src/bin/firmware/board/nucleo_h743zi/mod.rs");
        let pins: BTreeSet<&str> = board
            .split("p.P")
            .skip(1)
            .filter_map(|rest| rest.split(|c: char| !c.is_alphanumeric()).next())
            .collect();
        assert!(pins.len() > 15, "{pins:?}");
        for pin in pins {
            assert!(
                document.contains(&format!("P{pin}")),
                "P{pin} is not in docs/board.md"
            );
        }
        let (firmware, program) = (read("build.rs"), read("host-sim/src/device/serial_line.rs"));
        assert!(firmware.contains("USUAL_BAUD: u32 = 921_600;"));
        assert!(program.contains(" BAUD: u32 = 921_600;") && document.contains("921,600 baud"));
        for ends in [&firmware, &program] {
            assert!(ends.contains("BAUDS: [u32; 2] = [57_600, 3_000_000];"));
        }
    }
}
