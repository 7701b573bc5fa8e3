//! Names of files and functions as the list has them, the same on every machine.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};
use syn::{Attribute, Item};

/// Sources that have been read.
#[derive(Debug)]
pub(crate) struct Sources {
    root: PathBuf,
    lines: BTreeMap<String, Vec<String>>,
}

impl Sources {
    pub(crate) fn new(root: &Path) -> Self {
        Self {
            root: root.to_owned(),
            lines: BTreeMap::new(),
        }
    }

    /// Returns the lines of a file, by the path that the compiler had; none if it cannot be read.
    pub(crate) fn lines(&mut self, file: &str) -> &[String] {
        let root = &self.root;
        let read = || {
            let text = fs::read_to_string(root.join(file)).unwrap_or_default();
            text.lines().map(str::to_owned).collect()
        };
        self.lines.entry(file.to_owned()).or_insert_with(read)
    }
}

/// Returns the name of a file in the list: from the root for those of this project, else its crate,
/// without a version, and the path in it.
pub(crate) fn file(path: &str) -> String {
    let path = path.replace('\\', "/");
    if let Some((_, of_library)) = path.rsplit_once("/library/") {
        return of_library.to_owned();
    }
    let Some((_, of_registry)) = path.split_once("/registry/src/") else {
        return path;
    };
    let in_crate = of_registry.split_once('/').map(|(_, rest)| rest);
    let Some((package, rest)) = in_crate.and_then(|rest| rest.split_once('/')) else {
        return path;
    };
    let is_version = |(at, _): &(usize, &str)| {
        let next = package.get(at + 1..).and_then(|rest| rest.chars().next());
        next.is_some_and(|first| first.is_ascii_digit())
    };
    let dash = package.match_indices('-').find(is_version);
    let name = dash.and_then(|(at, _)| package.get(..at));
    format!("{}/{rest}", name.unwrap_or(package))
}

/// Returns the paths, from the root, of the modules of tests that are files of their own, without
/// their ending: `src/a/tests` for `src/a/tests.rs` and what is below it.
///
/// # Errors
/// An error if a source cannot be read.
pub(crate) fn modules_of_tests(root: &Path, sources: &[String]) -> Result<Vec<String>> {
    let mut modules = vec![];
    for source in sources {
        let text = fs::read_to_string(root.join(source)).with_context(|| source.clone())?;
        let folder = source.strip_suffix("/mod.rs").unwrap_or(source);
        let folder = folder.strip_suffix(".rs").unwrap_or(folder);
        let file = syn::parse_file(&text).with_context(|| format!("{source}: not Rust"))?;
        for item in &file.items {
            if let Item::Mod(module) = item
                && module.content.is_none()
                && module.attrs.iter().any(is_cfg_test)
            {
                modules.push(format!("{folder}/{}", module.ident));
            }
        }
    }
    Ok(modules)
}

/// Returns `true` for an attribute of code that is compiled for tests alone.
fn is_cfg_test(attribute: &Attribute) -> bool {
    let condition = attribute
        .meta
        .require_list()
        .map(|list| list.tokens.to_string());
    let mut words = condition
        .iter()
        .flat_map(|text| text.split(|c: char| !c.is_alphanumeric()));
    attribute.path().is_ident("cfg") && words.any(|word| word == "test")
}

/// Returns `true` for a source that is a module of tests, or is in one.
pub(crate) fn is_of_tests(modules: &[String], source: &str) -> bool {
    modules.iter().any(|module| {
        let rest = source.strip_prefix(module.as_str());
        rest.is_some_and(|rest| rest == ".rs" || rest.starts_with('/'))
    })
}

/// Returns the function that a line is in, with the type or trait whose function it is, or the
/// macro that makes it: the headers above it that are indented less and less, as rustfmt writes
/// them.
pub(crate) fn function(lines: &[String], line: u32) -> Option<String> {
    let last = usize::try_from(line).ok()?;
    let above = lines.get(..last)?.iter().rev();
    let mut name: Option<String> = None;
    let mut least = usize::MAX;
    let mut is_end_of_header = false;
    for text in above {
        let code = text.trim_start();
        if code.is_empty() || code.starts_with("//") {
            continue;
        }
        let indent = text.len() - code.len();
        if indent > least || (indent == least && !is_end_of_header) {
            continue;
        }
        least = indent;
        // The last line of a header of several lines is indented as its first one.
        is_end_of_header = [")", "{", "where", ">"]
            .iter()
            .any(|end| code.starts_with(end));
        if name.is_none()
            && let Some((name, _)) = code.split_once("! {")
            && name.chars().all(|c| c.is_alphanumeric() || c == '_')
        {
            return Some(format!("{name}!"));
        }
        match &name {
            None => name = name_of_function(code).map(str::to_owned),
            Some(function) => {
                if let Some(owner) = name_of_owner(code) {
                    return Some(format!("{owner}::{function}"));
                }
            }
        }
    }
    name
}

/// Returns the name of the function whose header a line begins.
fn name_of_function(code: &str) -> Option<&str> {
    let (before, after) = code.split_once("fn ")?;
    let is_qualifier = |word: &str| {
        ["const", "unsafe", "async", "extern", "default", "\"C\""].contains(&word)
            || word.starts_with("pub")
            || word.ends_with(')')
    };
    if !before.split_whitespace().all(is_qualifier) {
        return None;
    }
    let is_end = |c: char| !(c.is_alphanumeric() || c == '_' || c == '$');
    after.split(is_end).next().filter(|name| !name.is_empty())
}

/// Returns the type or the trait whose functions follow a line.
fn name_of_owner(code: &str) -> Option<&str> {
    let code = code.trim_start_matches("unsafe ");
    let header = if let Some(rest) = code.strip_prefix("impl") {
        let rest = if rest.starts_with('<') {
            rest.get(end_of_generics(rest)?..)?
        } else {
            rest
        };
        rest.split_once(" for ").map_or(rest, |(_, owner)| owner)
    } else {
        let (before, rest) = code.split_once("trait ")?;
        let is_header = before.is_empty() || before.starts_with("pub");
        is_header.then_some(rest)?
    };
    let header = header.trim_start().trim_start_matches("const ");
    let header = header.trim_start_matches(['&', '[', '(', '*']);
    let is_lifetime = header.starts_with('\'');
    let behind = header.split_once(' ').filter(|_| is_lifetime);
    let header = behind.map_or(header, |(_, behind)| behind);
    let is_end = |c: char| !(c.is_alphanumeric() || "_:$".contains(c));
    let path = header.split(is_end).next()?;
    let path = path.trim_end_matches(':');
    Some(path.rsplit("::").next().unwrap_or(path)).filter(|name| !name.is_empty())
}

/// Returns where the generics at the start of a text end.
fn end_of_generics(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        match c {
            '<' => depth += 1,
            '>' if before != '-' => depth = depth.checked_sub(1)?,
            _ => {}
        }
        if depth == 0 {
            return Some(at + 1);
        }
        before = c;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn function_at(text: &str, line: u32) -> Option<String> {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        function(&lines, line)
    }

    #[test]
    fn file_is_named_alike_on_every_machine() {
        for (path, name) in [
            ("src/flight/ring.rs", "src/flight/ring.rs"),
            (
                "/root/.cargo/registry/src/index.crates.io-1949/sha2-0.11.0/src/a.rs",
                "sha2/src/a.rs",
            ),
            (
                "C:\\u\\.cargo\\registry\\src\\index-1\\embassy-stm32-0.6.0\\src\\a.rs",
                "embassy-stm32/src/a.rs",
            ),
            (
                "/usr/src/rust/library/core/src/fmt/mod.rs",
                "core/src/fmt/mod.rs",
            ),
        ] {
            assert_eq!(file(path), name);
        }
    }

    #[test]
    fn function_is_that_of_the_headers_above() {
        let text = "
impl<T: Fn() -> u8, const N: usize> Ring<T, N> {
    /// fn not_this()
    pub(crate) const fn push(
        &mut self,
        value: T,
    ) -> usize
    where
        T: Copy,
    {
        fn inner(a: usize) -> usize {
            a + 1
        }
        if self.is_full() {
            self.start += 1;
        }
    }
}

fn free(a: u8) -> u8 { a + 1 }

impl<'a> core::ops::Add<&'a u8> for &'a super::Count {
    fn add(self) {
        self.iter().map(|one| {
            one + 1
        })
    }
}

all_sums! { u8 u16 }
";
        let at = |code: &str| {
            let line = text.lines().position(|line| line.contains(code));
            function_at(text, u32::try_from(line.unwrap() + 1).unwrap())
        };
        assert_eq!(at("self.start += 1").as_deref(), Some("Ring::push"));
        assert_eq!(at("            a + 1").as_deref(), Some("Ring::inner"));
        assert_eq!(at("fn free").as_deref(), Some("free"));
        assert_eq!(at("one + 1").as_deref(), Some("Count::add"));
        assert_eq!(at("all_sums!").as_deref(), Some("all_sums!"));
        assert_eq!(function_at(text, 1), None);
        assert_eq!(function_at(text, 1000), None);
    }

    #[test]
    fn modules_of_tests_and_what_is_in_them_are_known() {
        let folder = std::env::temp_dir().join(format!("fmc-source-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("src/a")).unwrap();
        let text = "mod b;\n#[cfg(test)]\n#[expect(\n    f,\n)]\nmod tests;\n#[cfg(all(test, feature = \"c\"))]\n\
            pub(crate) mod d;\n#[cfg(test)]\nuse e;\nmod f;\n";
        std::fs::write(folder.join("src/a/mod.rs"), text).unwrap();
        std::fs::write(folder.join("src/g.rs"), "#[cfg(test)]\nmod sequences;\n").unwrap();
        let sources = ["src/a/mod.rs", "src/g.rs"].map(str::to_owned);
        let modules = modules_of_tests(&folder, &sources).unwrap();
        assert_eq!(modules, ["src/a/tests", "src/a/d", "src/g/sequences"]);
        for (source, expected) in [
            ("src/a/tests.rs", true),
            ("src/a/tests/outages.rs", true),
            ("src/a/tests_of_others.rs", false),
            ("src/a/f.rs", false),
            ("src/g.rs", false),
        ] {
            assert_eq!(is_of_tests(&modules, source), expected, "{source}");
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
