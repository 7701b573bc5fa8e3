//! Modules of a crate and the modules that each uses, by the paths in their sources.
//!
//! A module is a file. Paths of `use`, of code and of macros' arguments count; those of tests, of
//! documentation and of visibilities do not. An item that a module passes on (`pub use`) belongs to
//! the module that it comes from, so a module that passes on items of its own children does not use
//! them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, ItemMod, ItemUse, UseTree, Visibility};

/// A module's path from the root of its crate; that of the root is empty.
pub(crate) type Module = Vec<String>;

/// For each module the modules that it uses.
pub(crate) type Arrows = BTreeMap<Module, BTreeSet<Module>>;

/// Contents of a source, its inline modules included.
#[derive(Debug, Default)]
struct Source {
    /// Paths, and the module, of the file or inline, in which they stand.
    used: Vec<(Module, Vec<String>)>,
    /// Names that are passed on, with the paths of the items for which they stand; `*` is
    /// everything.
    passed_on: Vec<(String, Vec<String>)>,
    /// Children that exist only in tests.
    of_tests: BTreeSet<String>,
}

/// Returns the arrows of a crate whose sources lie in a directory; `skipped` are directories of
/// programs.
pub(crate) fn of_directory(root: &Path, skipped: &[&str]) -> Arrows {
    let mut files = Vec::new();
    let mut directories = vec![root.to_owned()];
    while let Some(directory) = directories.pop() {
        for entry in fs::read_dir(&directory).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap().to_str().unwrap();
            let name = name.replace('\\', "/");
            if path.is_dir() {
                if !skipped.contains(&name.as_str()) {
                    directories.push(path);
                }
            } else if path.extension().is_some_and(|end| end == "rs") {
                files.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    of_files(&files)
}

/// Returns the arrows of a crate of these files: paths from the root's directory, and texts.
pub(crate) fn of_files(files: &[(String, String)]) -> Arrows {
    let mut sources: BTreeMap<Module, Source> = files
        .iter()
        .map(|(name, text)| {
            let module = module_of(name);
            let source = Source::read(&module, text)
                .unwrap_or_else(|error| panic!("{name} is not Rust: {error}"));
            (module, source)
        })
        .collect();
    let of_tests: Vec<Module> = sources
        .iter()
        .flat_map(|(module, source)| source.of_tests.iter().map(|child| below(module, child)))
        .collect();
    sources.retain(|module, _| !of_tests.iter().any(|test| module.starts_with(test)));
    let mut arrows = Arrows::new();
    for (module, source) in &sources {
        let used = source.used.iter();
        let mut targets: BTreeSet<Module> = used
            .filter_map(|(place, path)| target(&sources, place, path, 0))
            .collect();
        let passed_on = source.passed_on.iter();
        targets.extend(
            passed_on
                .filter_map(|(_, path)| target(&sources, module, path, 0))
                .filter(|target| !target.starts_with(module)),
        );
        targets.remove(module);
        arrows.insert(module.clone(), targets);
    }
    arrows
}

/// Returns the module of a file.
fn module_of(name: &str) -> Module {
    let stem = name.strip_suffix(".rs").unwrap_or(name);
    let mut module: Module = stem.split('/').map(str::to_owned).collect();
    let is_parent = module.last().is_some_and(|last| last == "mod");
    if is_parent || ["lib", "main"].contains(&stem) {
        module.pop();
    }
    module
}

fn below(module: &[String], child: &str) -> Module {
    let mut path = module.to_vec();
    path.push(child.to_owned());
    path
}

/// Returns the module to which a path in a module leads; `None` if it leads out of the crate, or to
/// a name of this module itself: an item, or a name that a `use` has brought.
fn target(
    sources: &BTreeMap<Module, Source>,
    place: &[String],
    path: &[String],
    depth: usize,
) -> Option<Module> {
    let mut module = place.to_vec();
    let mut rest = path;
    match path.first().map(String::as_str) {
        Some("crate") => {
            module.clear();
            rest = &path[1..];
        }
        Some("self") => rest = &path[1..],
        Some("super") => {}
        Some(child) if sources.contains_key(&below(place, child)) => {}
        _ => return None,
    }
    while let Some((first, others)) = rest.split_first()
        && first == "super"
    {
        module.pop();
        rest = others;
    }
    while let Some((first, others)) = rest.split_first()
        && sources.contains_key(&below(&module, first))
    {
        module.push(first.clone());
        rest = others;
    }
    // An inline module is a part of its file.
    while !sources.contains_key(&module) {
        module.pop()?;
    }
    // An item that is passed on through three modules is passed on in a circle.
    if let Some(name) = rest.first()
        && depth < 3
    {
        let passed_on = &sources[&module].passed_on;
        let by_name = passed_on.iter().filter(|(passed, _)| passed == name);
        let by_star = passed_on.iter().filter(|(passed, _)| passed == "*");
        let from = by_name
            .chain(by_star)
            .find_map(|(_, path)| target(sources, &module, path, depth + 1));
        if from.is_some() {
            return from;
        }
    }
    Some(module)
}

impl Source {
    fn read(module: &[String], text: &str) -> syn::Result<Self> {
        let file = syn::parse_file(text)?;
        let mut reader = Reader {
            place: module.to_vec(),
            is_inline: false,
            source: Self::default(),
        };
        reader.visit_file(&file);
        Ok(reader.source)
    }
}

/// Visitor that walks through a file.
struct Reader {
    place: Module,
    is_inline: bool,
    source: Source,
}

impl Reader {
    fn use_path(&mut self, path: Vec<String>) {
        self.source.used.push((self.place.clone(), path));
    }

    /// Adds the paths among tokens that only their macro understands.
    fn use_tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Punct(punct) if punct.as_char() == ':' && !path.is_empty() => {
                    colons += 1;
                }
                TokenTree::Ident(ident) if colons == 2 => {
                    path.push(ident.to_string());
                    colons = 0;
                }
                other => {
                    self.end_of(&mut path);
                    colons = 0;
                    match other {
                        TokenTree::Ident(ident) => path.push(ident.to_string()),
                        TokenTree::Group(group) => self.use_tokens(group.stream()),
                        _ => {}
                    }
                }
            }
        }
        self.end_of(&mut path);
    }

    fn end_of(&mut self, path: &mut Vec<String>) {
        if path.len() > 1 {
            self.use_path(path.clone());
        }
        path.clear();
    }
}

impl<'ast> Visit<'ast> for Reader {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        let name = item.ident.to_string();
        match (&item.content, is_for_tests(&item.attrs)) {
            (None, true) => {
                self.source.of_tests.insert(name);
            }
            (Some(_), false) => {
                let was_inline = std::mem::replace(&mut self.is_inline, true);
                self.place.push(name);
                visit::visit_item_mod(self, item);
                self.place.pop();
                self.is_inline = was_inline;
            }
            (None, false) | (Some(_), true) => {}
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if is_for_tests(&item.attrs) {
            return;
        }
        let mut leaves = Vec::new();
        leaves_of(&item.tree, &mut Vec::new(), &mut leaves);
        let is_private = matches!(item.vis, Visibility::Inherited);
        for (name, path) in leaves {
            if is_private || self.is_inline {
                self.use_path(path);
            } else {
                self.source.passed_on.push((name, path));
            }
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names = path.segments.iter();
        let names: Vec<String> = names.map(|segment| segment.ident.to_string()).collect();
        if names.len() > 1 {
            self.use_path(names);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, invoked: &'ast syn::Macro) {
        self.visit_path(&invoked.path);
        self.use_tokens(invoked.tokens.clone());
    }

    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute
                .parse_args::<syn::Path>()
                .is_ok_and(|path| path.is_ident("test"))
    })
}

/// Returns the names that a `use` brings, `*` for all, with their paths.
fn leaves_of(tree: &UseTree, before: &mut Vec<String>, leaves: &mut Vec<(String, Vec<String>)>) {
    let path = |last: &str| {
        let mut path = before.clone();
        if last != "self" {
            path.push(last.to_owned());
        }
        path
    };
    match tree {
        UseTree::Path(part) => {
            before.push(part.ident.to_string());
            leaves_of(&part.tree, before, leaves);
            before.pop();
        }
        UseTree::Name(name) => {
            let path = path(&name.ident.to_string());
            leaves.push((path.last().cloned().unwrap_or_default(), path));
        }
        UseTree::Rename(name) => {
            leaves.push((name.rename.to_string(), path(&name.ident.to_string())));
        }
        UseTree::Glob(_) => leaves.push(("*".to_owned(), before.clone())),
        UseTree::Group(group) => {
            for tree in &group.items {
                leaves_of(tree, before, leaves);
            }
        }
    }
}
