//! `cargo xtask docs`: the project's documents as a site of pages.

#[cfg(test)]
mod blocks;
mod contents;
mod links;
mod source;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use anyhow::{Context as _, Result, bail};
use xshell::cmd;

use self::source::Source;
use crate::{NOT_STARTED, crate_program::CrateProgram, workspace::Workspace};

/// mdBook, which makes pages of the documents.
pub(crate) const MDBOOK: CrateProgram = CrateProgram {
    name: "mdbook",
    version: "0.5.4",
    before_version: "mdbook v",
    options: "--no-default-features",
};

/// Its settings.
const SETTINGS: &str = include_str!("book.toml");
const STYLE: &str = include_str!("site.css");

/// Builds the site into target/site, and checks its links.
///
/// # Errors
/// An error if a link is dead.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    if let Err(error) = MDBOOK.find(workspace) {
        eprintln!("xtask: the site was not built: {error:#}");
        return Ok(ExitCode::from(NOT_STARTED));
    }
    check(workspace)?;
    println!("{}", workspace.target_dir.join("site/index.html").display());
    Ok(ExitCode::SUCCESS)
}

/// Builds the site, and checks its links.
///
/// # Errors
/// An error if it cannot be built, or if a link is dead.
pub(crate) fn check(workspace: &Workspace) -> Result<()> {
    let source = Source::collect(&workspace.root)?;
    let mdbook = MDBOOK.find(workspace)?;
    let book = workspace.target_dir.join("site-source");
    let site = workspace.target_dir.join("site");
    let _lock = Workspace::lock(&workspace.target_dir.join("site-lock"), "builds the site")?;
    lay_out(&workspace.root, &source, &book)?;
    let shell = &workspace.shell;
    cmd!(shell, "{mdbook} build {book} --dest-dir {site}")
        .quiet()
        .run()?;
    let pages = read(&site, &source)?;
    let links = check_links(&site, &pages)?;
    eprintln!(
        "{} pages with {links} links, none of them dead",
        pages.len()
    );
    Ok(())
}

/// Writes what mdBook reads.
fn lay_out(root: &Path, source: &Source, book: &Path) -> Result<()> {
    if book.exists() {
        fs::remove_dir_all(book).with_context(|| book.display().to_string())?;
    }
    let write = |place: &Path, bytes: &[u8]| -> Result<()> {
        let path = book.join(place);
        let told = || path.display().to_string();
        fs::create_dir_all(path.parent().unwrap_or(book)).with_context(told)?;
        fs::write(&path, bytes).with_context(told)
    };
    write(Path::new("book.toml"), SETTINGS.as_bytes())?;
    write(Path::new("site.css"), STYLE.as_bytes())?;
    let pages = Path::new("source");
    write(&pages.join("SUMMARY.md"), source.summary().as_bytes())?;
    write(
        &pages.join("sources.md"),
        b"# Files and folders\n\nSources to which the documents lead.\n",
    )?;
    for (place, text) in &source.pages {
        write(&pages.join(place), text.as_bytes())?;
    }
    for place in &source.files {
        let path = root.join(place);
        let bytes = fs::read(&path).with_context(|| path.display().to_string())?;
        write(&pages.join(place), &bytes)?;
    }
    Ok(())
}

/// Reads the site's pages, by their places in it.
fn read(site: &Path, source: &Source) -> Result<BTreeMap<PathBuf, String>> {
    let places = source.pages.keys().map(|page| page.with_extension("html"));
    places
        .chain(["index.html".into(), "sources.html".into()])
        .map(|place| {
            let path = site.join(&place);
            let page = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            Ok((place, page))
        })
        .collect()
}

/// Checks that every link leads to a file of the site, and to a heading in it if it names one.
/// Returns their number.
fn check_links(site: &Path, pages: &BTreeMap<PathBuf, String>) -> Result<usize> {
    let ids: BTreeMap<&Path, BTreeSet<String>> = pages
        .iter()
        .map(|(place, page)| {
            let ids = links::attributes(page, "id").into_iter().collect();
            (place.as_path(), ids)
        })
        .collect();
    let (mut count, mut dead) = (0, Vec::new());
    for (place, page) in pages {
        let folder = place.parent().unwrap_or(Path::new(""));
        let links = ["href", "src"].map(|name| links::attributes(page, name));
        for link in links.into_iter().flatten() {
            if links::is_elsewhere(&link) {
                continue;
            }
            count += 1;
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = match file {
                "" => Some(place.clone()),
                file => links::resolved(folder, file),
            };
            let is_alive = target.is_some_and(|target| match ids.get(target.as_path()) {
                Some(ids) => anchor.is_empty() || ids.contains(anchor),
                None => site.join(&target).is_file(),
            });
            if !is_alive {
                dead.push(format!("{}: {link}", place.display()));
            }
        }
    }
    if count == 0 {
        bail!("the site has no links");
    }
    if !dead.is_empty() {
        bail!("dead links:\n{}", dead.join("\n"));
    }
    Ok(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dead_link_and_missing_heading_are_found_in_the_site() {
        let page = |links: &str| {
            let text = format!("<h1 id=\"top\">x</h1><a href=\"#top\">y</a>{links}");
            let pages = BTreeMap::from([(PathBuf::from("docs/a.html"), text)]);
            check_links(Path::new("nowhere"), &pages)
        };
        assert_eq!(page("<a href=\"../docs/a.html#top\">z</a>").unwrap(), 2);
        for link in ["#below", "b.html", "../a.html"] {
            let fault = page(&format!("<a href=\"{link}\">z</a>")).unwrap_err();
            assert!(fault.to_string().contains(link), "{fault}");
        }
    }
}
