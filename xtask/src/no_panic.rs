//! No-panic check: `tests/no-panic` keeps the library's public functions, and links only if none of
//! them can panic. The firmware is checked in the same way.

use std::{collections::BTreeMap, path::Path};

use anyhow::{Result, bail, ensure};
use xshell::{Cmd, Shell};

use crate::{target::Target, workspace::Workspace};

/// Undefined symbol behind the panic handlers of `tests/no-panic` and, for this check, of the
/// firmware.
pub(crate) const PANIC_SYMBOL: &str = "fmc_camera_can_panic";

/// Modules of the library, each with a separate list in `tests/no-panic/src`.
const AREAS: [&str; 3] = ["geometry", "flight", "io"];

/// Compares the program's lists with the library's sources, links the program, which must succeed,
/// and links it with a panic added, which must fail for that reason alone.
///
/// # Errors
/// An error if a public function is not listed, a panic is reachable, the control links, or a build
/// fails for another reason.
pub(crate) fn check(workspace: &Workspace, target: &Target<'_>) -> Result<()> {
    for area in AREAS {
        let list = workspace.root.join(format!("tests/no-panic/src/{area}.rs"));
        let list = listed(&workspace.shell.read_file(&list)?);
        let sources = sources(&workspace.shell, &workspace.root.join("src").join(area))?;
        let missing = missing(&public_functions(&sources), &list);
        ensure!(
            missing.is_empty(),
            "tests/no-panic/src/{area}.rs does not list {}",
            missing.join(", ")
        );
    }
    // The features are those of the flight image, so that the library is compiled once for both.
    let link = |flags: &[&str]| {
        let rustc = "rustc --release -p no-panic-check --features fmc-camera/board-mps2 --";
        target.cargo(rustc).args(flags)
    };
    prove("tests/no-panic", link)
}

/// Links a program, which must succeed, and links it with a panic added, which must fail for that
/// reason alone. The program's panic handler calls [`PANIC_SYMBOL`]; `link` builds it with flags of
/// the compiler.
///
/// # Errors
/// An error if a panic is reachable, the control links, or a build fails for another reason.
pub(crate) fn prove<'a>(program: &str, link: impl Fn(&[&str]) -> Cmd<'a>) -> Result<()> {
    if let Link::PanicReachable = try_link(program, link(&[]))? {
        let why_live = link(&["-Clink-arg=--why-live=*rust_begin_unwind"]);
        bail!(
            "{program} can panic; from the panic up:{}",
            panic_path(why_live)?
        );
    }
    let control = link(&["--cfg", "negative_control"]);
    ensure!(
        matches!(try_link(program, control)?, Link::PanicReachable),
        "{program} links although its negative control can panic: the check sees nothing"
    );
    Ok(())
}

/// Outcome of a link.
enum Link {
    /// No panic is reachable.
    Complete,
    /// The linker reported the panic handler's symbol as undefined.
    PanicReachable,
}

/// Builds and links; any failure except the panic symbol is an error, shown in full.
fn try_link(program: &str, command: Cmd<'_>) -> Result<Link> {
    eprintln!("$ {command}");
    let output = command.ignore_status().output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    if output.status.success() {
        return Ok(Link::Complete);
    }
    let names_symbol = |line: &str| line.contains("undefined") && line.contains(PANIC_SYMBOL);
    if text.lines().any(names_symbol) {
        return Ok(Link::PanicReachable);
    }
    eprint!("{text}");
    bail!("{program} does not build for the target")
}

/// Returns the functions from the panic up to the program's entry, if the linker can report them
/// (LLVM's from version 21 on).
fn panic_path(command: Cmd<'_>) -> Result<String> {
    let output = command.ignore_status().output()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let function = |line: &str| {
        let section = line.split_once(">>> referenced by: ")?.1;
        let name = section.rsplit_once(":(")?.1.split(')').next()?;
        Some(format!("\n    {name}"))
    };
    let callers: Vec<_> = text.lines().filter_map(function).collect();
    Ok(callers.concat())
}

/// Returns the sources of a module and of its submodules.
fn sources(shell: &Shell, directory: &Path) -> Result<String> {
    let mut text = String::new();
    for path in shell.read_dir(directory)? {
        if path.is_dir() {
            text += &sources(shell, &path)?;
        } else {
            text += &shell.read_file(&path)?;
        }
    }
    Ok(text)
}

/// Number of occurrences of each name; different types may have functions of one name.
type Names = BTreeMap<String, usize>;

/// Returns the names of the functions that sources define as public.
fn public_functions(sources: &str) -> Names {
    let name = |line: &str| {
        let line = line.trim_start().strip_prefix("pub ")?;
        let line = line.strip_prefix("const ").unwrap_or(line);
        let name = line.strip_prefix("fn ")?.split(['(', '<']).next()?;
        Some(name.to_owned())
    };
    count(sources.lines().filter_map(name))
}

/// Returns the names of the functions that a list keeps: lines `Type::function,` or
/// `module::function,`, the function with the types of its arguments if it is generic.
fn listed(list: &str) -> Names {
    let path = |line: &str| {
        let path = line.trim().strip_suffix(',')?;
        let function = match path.strip_suffix('>') {
            Some(generic) => generic.rsplit_once("::<")?.0,
            None => path,
        };
        Some(function.rsplit_once("::")?.1.to_owned())
    };
    let keep = list.split_once("keep![").map_or("", |(_, keep)| keep);
    count(keep.lines().filter_map(path))
}

fn count(names: impl Iterator<Item = String>) -> Names {
    names.fold(Names::new(), |mut counts, name| {
        *counts.entry(name).or_default() += 1;
        counts
    })
}

/// Returns the names that are defined more often than listed.
fn missing(defined: &Names, listed: &Names) -> Vec<String> {
    let lacks = |(name, count): (&String, &usize)| {
        (listed.get(name).unwrap_or(&0) < count).then(|| name.clone())
    };
    defined.iter().filter_map(lacks).collect()
}

#[cfg(test)]
mod tests {
    use super::{listed, missing, public_functions};

    #[test]
    fn public_function_without_a_line_in_the_list_is_named() {
        let sources = "
            impl Sensor {
                pub const fn new(width_px: u32) -> Self {
                pub fn contains(&self, point: SensorPoint) -> bool {
                pub fn rows<T>(&self, of: T) {
                fn private(&self) {}
                pub(crate) fn inner(&self) {}
            impl Shutter { // two of one name
                pub fn new<T>(profile: T) -> Self {
            pub fn mean_transfers(";
        let list = "use fmc_camera::a::{\n b::Sensor,\n};\nkeep![\n Sensor::new,\n Sensor::rows::<f32>,\n tdi::mean_transfers,\n ]";
        assert_eq!(
            missing(&public_functions(sources), &listed(list)),
            ["contains", "new"]
        );
    }
}
