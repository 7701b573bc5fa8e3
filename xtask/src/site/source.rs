//! Sources of the site: the project's documents as they are, but for the links, and a page for
//! every source file and folder to which they lead.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, bail};

use super::{
    contents::{CONTENTS, Entry},
    links,
};

/// Ends of names of files that a browser shows.
const SHOWN: [&str; 5] = ["html", "svg", "png", "jpg", "pdf"];

/// Pages, and files that go along as they are, by their places in the project.
#[derive(Debug, Default)]
pub(super) struct Source {
    /// Text of the pages in Markdown.
    pub(super) pages: BTreeMap<PathBuf, String>,
    /// Files that browsers show.
    pub(super) files: BTreeSet<PathBuf>,
    /// Pages of source files and folders.
    appendix: BTreeMap<PathBuf, PathBuf>,
}

impl Source {
    /// Collects the site's pages, and what they lead to.
    ///
    /// # Errors
    /// An error that names every link to a file that does not exist.
    pub(super) fn collect(root: &Path) -> Result<Self> {
        let mut source = Self::default();
        let mut faults = Vec::new();
        let pages = CONTENTS.iter().filter_map(|entry| match entry {
            Entry::Page(_, file) => Some(PathBuf::from(file)),
            Entry::Part(_) => None,
        });
        let mut left: Vec<PathBuf> = pages.collect();
        while let Some(page) = left.pop() {
            if source.pages.contains_key(&page) {
                continue;
            }
            let path = root.join(&page);
            let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            let folder = page.parent().unwrap_or(Path::new(""));
            let changed = links::change(&text, |target| {
                let dead = || format!("{target} does not exist");
                let place = links::resolved(folder, target).ok_or_else(dead)?;
                source
                    .leads_to(root, &place, target, &mut left)
                    .ok_or_else(dead)
            });
            match changed {
                Ok(text) => {
                    source.pages.insert(page, text);
                }
                Err(dead) => {
                    let page = page.display();
                    faults.extend(dead.iter().map(|fault| format!("{page}, {fault}")));
                    source.pages.insert(page.to_string().into(), String::new());
                }
            }
        }
        if !faults.is_empty() {
            bail!("{}", faults.join("\n"));
        }
        for (page, of) in source.appendix.clone() {
            let text = if root.join(&of).is_dir() {
                listing(root, &of)?
            } else {
                listed(root, &of)?
            };
            source.pages.insert(page, text);
        }
        Ok(source)
    }

    /// Returns the link that leads to a place of the project, if there is something.
    fn leads_to(
        &mut self,
        root: &Path,
        place: &Path,
        target: &str,
        left: &mut Vec<PathBuf>,
    ) -> Option<String> {
        let path = root.join(place);
        let end = place.extension().and_then(|end| end.to_str()).unwrap_or("");
        if path.is_dir() {
            let page = place.join("folder.md");
            self.appendix.insert(page, place.to_owned());
            let slash = if target.ends_with('/') { "" } else { "/" };
            Some(format!("{target}{slash}folder.md"))
        } else if !path.is_file() {
            None
        } else if end == "md" {
            left.push(place.to_owned());
            Some(target.to_owned())
        } else if SHOWN.contains(&end) {
            self.files.insert(place.to_owned());
            Some(target.to_owned())
        } else {
            let page = PathBuf::from(format!("{}.md", place.display()));
            self.appendix.insert(page, place.to_owned());
            Some(format!("{target}.md"))
        }
    }

    /// Returns the table of contents, as mdBook reads it.
    pub(super) fn summary(&self) -> String {
        let mut summary = String::from("# Summary\n\n");
        let mut named = BTreeSet::new();
        for entry in CONTENTS {
            let _ = match entry {
                Entry::Part(title) => writeln!(summary, "\n# {title}\n"),
                Entry::Page(title, file) => {
                    named.insert(PathBuf::from(file));
                    writeln!(summary, "- [{title}]({file})")
                }
            };
        }
        let others = self.pages.keys().filter(|page| !named.contains(*page));
        summary.push_str("\n# Sources\n\n- [Files and folders](sources.md)\n");
        for page in others {
            let title = self.appendix.get(page).unwrap_or(page).display();
            let _ = writeln!(summary, "  - [{title}]({})", page.display());
        }
        summary
    }
}

/// Returns a page of a file.
fn listed(root: &Path, file: &Path) -> Result<String> {
    let path = root.join(file);
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let kind = match file.extension().and_then(|end| end.to_str()) {
        Some("rs") => "rust,ignore",
        Some("py") => "python",
        Some("c" | "h") => "c",
        Some("toml") => "toml",
        _ => "text",
    };
    // More marks than any line of the text begins with.
    let fence = "`".repeat(8);
    let end = if text.ends_with('\n') { "" } else { "\n" };
    Ok(format!(
        "# {}\n\n{fence}{kind}\n{text}{end}{fence}\n",
        file.display()
    ))
}

/// Returns a page of the names in a folder.
fn listing(root: &Path, folder: &Path) -> Result<String> {
    let path = root.join(folder);
    let entries = fs::read_dir(&path).with_context(|| path.display().to_string())?;
    let mut names = entries
        .map(|entry| {
            let entry = entry?;
            let slash = if entry.path().is_dir() { "/" } else { "" };
            Ok(format!("{}{slash}", entry.file_name().to_string_lossy()))
        })
        .collect::<Result<Vec<String>>>()?;
    names.retain(|name| !name.starts_with('.') && name != "target/");
    names.sort();
    let mut page = format!("# {}\n\nA folder of the source:\n\n", folder.display());
    for name in names {
        let _ = writeln!(page, "- `{name}`");
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
    }

    #[test]
    fn every_link_of_every_document_leads_to_a_file_or_folder() {
        let source = Source::collect(root()).unwrap();
        assert!(source.pages.len() > 30, "{}", source.pages.len());
        let linked = source.pages.get(Path::new("docs/c.md")).unwrap();
        assert!(linked.contains("](../bindings/c/examples/main.c.md)"));
        assert!(
            source
                .pages
                .contains_key(Path::new("bindings/c/examples/main.c.md"))
        );
    }

    #[test]
    fn every_document_of_docs_is_a_page() {
        let is_page = |page: &Path| {
            let mut entries = CONTENTS.iter();
            entries.any(|entry| matches!(entry, Entry::Page(_, file) if page == Path::new(file)))
        };
        let mut documents = 0;
        for entry in fs::read_dir(root().join("docs")).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|end| end == "md") {
                let page = path.strip_prefix(root()).unwrap();
                assert!(is_page(page), "{}", page.display());
                documents += 1;
            }
        }
        assert!(documents > 15, "{documents}");
    }

    #[test]
    fn summary_has_every_page_once() {
        let source = Source::collect(root()).unwrap();
        let summary = source.summary();
        for page in source.pages.keys() {
            let link = format!("]({})\n", page.display());
            assert_eq!(summary.matches(&link).count(), 1, "{link}");
        }
    }
}
