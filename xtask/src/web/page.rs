//! The page: one file of its sources, the cameras and the module.

use std::{collections::BTreeMap, fs, path::Path};

use anyhow::{Context as _, Result, ensure};
use zopfli::{Format, Options, compress};

use super::module::Module;

/// Directory of the sources, from the root.
const SOURCES: &str = "bindings/web/page";

/// Directory of the camera files, from the root.
const CAMERAS: &str = "host-sim/cameras";

/// The page that is checked in, from the root.
pub(super) const CHECKED_IN: &str = "docs/demo/index.html";

/// Most bytes of a page.
const MOST_BYTES: usize = 60_000;

/// Beginning of the line with the packed module.
const MODULE: &str = "<script type=\"text/plain\" id=\"module\"";

/// Beginning of the line that names the compiler.
const ORIGIN: &str = "<p>The camera's code in this page was compiled to WebAssembly by ";

/// Returns the page with a module.
///
/// # Errors
/// An error if a source cannot be read, or if the page is too large.
pub(super) fn page(root: &Path, module: &Module) -> Result<String> {
    let read = |name: &str| {
        let path = root.join(SOURCES).join(name);
        fs::read_to_string(&path).with_context(|| path.display().to_string())
    };
    let cameras = serde_json::to_string(&cameras(root)?)?;
    let program = [
        read("smol-toml.min.js")?,
        format!("const CAMERAS = {cameras};\n"),
        bare(&read("camera.js")?),
        bare(&read("camera_file.js")?),
        bare(&read("page.js")?),
    ];
    let mut page = read("index.html")?;
    for (place, text) in [
        ("{style}", read("style.css")?.trim().to_owned()),
        ("{origin}", format!("{ORIGIN}{}.</p>", module.compiler)),
        ("{module}", packed(&module.bytes)?),
        ("{program}", packed(program.concat().as_bytes())?),
        ("{loader}", bare(&read("loader.js")?).trim().to_owned()),
    ] {
        ensure!(page.matches(place).count() == 1, "index.html: no {place}");
        page = page.replacen(place, &text, 1);
    }
    ensure!(
        page.len() <= MOST_BYTES,
        "the page has {} bytes, and may have {MOST_BYTES}",
        page.len()
    );
    Ok(page)
}

/// Returns the camera files by their names.
pub(super) fn cameras(root: &Path) -> Result<BTreeMap<String, String>> {
    let folder = root.join(CAMERAS);
    let entries = fs::read_dir(&folder).with_context(|| folder.display().to_string())?;
    let mut cameras = BTreeMap::new();
    for entry in entries {
        let path = entry?.path();
        if let (Some(name), true) = (
            path.file_stem(),
            path.extension().is_some_and(|end| end == "toml"),
        ) {
            let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            cameras.insert(name.to_string_lossy().into_owned(), text);
        }
    }
    ensure!(!cameras.is_empty(), "no camera files in {CAMERAS}");
    Ok(cameras)
}

/// Returns a program without its lines of comment and without the spaces before a line. No text of
/// several lines is in the sources.
fn bare(program: &str) -> String {
    let lines = program.lines().map(str::trim_start);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with("//"));
    lines.fold(String::new(), |bare, line| bare + line + "\n")
}

/// Returns the end of a tag with the number of packed bytes, and the bytes: compressed, and every
/// four of them as five characters.
fn packed(bytes: &[u8]) -> Result<String> {
    let mut compressed = Vec::new();
    compress(Options::default(), Format::Deflate, bytes, &mut compressed)?;
    let mut text = format!("data-bytes=\"{}\">", compressed.len());
    for part in compressed.chunks(4) {
        let mut four = [0; 4];
        for (place, byte) in four.iter_mut().zip(part) {
            *place = *byte;
        }
        let word = u32::from_be_bytes(four);
        for power in [85_u32.pow(4), 85_u32.pow(3), 85_u32.pow(2), 85, 1] {
            let digit = u8::try_from(word / power % 85)?;
            text.push(char::from(b'(' + digit));
        }
    }
    // It would end the element.
    ensure!(
        !text.to_lowercase().contains("</script"),
        "packed bytes end their element"
    );
    Ok(text)
}

/// Checks that the page that is checked in is the one that was built, but for its module, whose
/// bytes depend on the compiler and on the folder: of it the browser compares what it computes.
/// Returns a line for the log.
///
/// # Errors
/// An error if it differs.
pub(super) fn compare(root: &Path, built: &str) -> Result<String> {
    let path = root.join(CHECKED_IN);
    let kept = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let what = if kept == built {
        "the page, byte for byte"
    } else {
        "the page but for its module, of another compiler or folder"
    };
    ensure!(
        without_module(&kept) == without_module(built),
        "{CHECKED_IN} is not of its sources; cargo xtask web --update writes it"
    );
    Ok(format!("{CHECKED_IN} is {what}"))
}

fn without_module(page: &str) -> String {
    let is_of_module = |line: &&str| line.starts_with(MODULE) || line.starts_with(ORIGIN);
    let lines = page.lines().filter(|line| !is_of_module(line));
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
    }

    fn module(bytes: &[u8], compiler: &str) -> Module {
        Module {
            bytes: bytes.to_vec(),
            compiler: compiler.to_owned(),
        }
    }

    #[test]
    fn page_that_is_checked_in_is_of_its_sources() {
        let kept = fs::read_to_string(root().join(CHECKED_IN)).unwrap();
        assert!(kept.len() <= MOST_BYTES);
        let built = page(root(), &module(b"", "another compiler")).unwrap();
        assert_eq!(without_module(&kept), without_module(&built));
        let text = compare(root(), &built).unwrap();
        assert!(text.contains("but for its module"), "{text}");
        let other = built.replace("x to the right", "x to the left");
        assert!(compare(root(), &other).is_err());
    }

    #[test]
    fn module_of_another_folder_is_named() {
        let kept = fs::read_to_string(root().join(CHECKED_IN)).unwrap();
        assert!(compare(root(), &kept).unwrap().contains("byte for byte"));
        let mut lines = kept.lines();
        let module = lines.find(|line| line.starts_with(MODULE)).unwrap();
        let other = kept.replace(module, &format!("{MODULE} data-bytes=\"4\">(((((</script>"));
        assert!(
            compare(root(), &other)
                .unwrap()
                .contains("another compiler or folder")
        );
    }

    #[test]
    fn page_that_is_too_large_is_refused() {
        let bytes: Vec<u8> = (0..60_000_u32)
            .flat_map(|number| number.wrapping_mul(2_654_435_761).to_le_bytes())
            .collect();
        let refused = page(root(), &module(&bytes, "rustc")).unwrap_err();
        assert!(refused.to_string().contains("60000"), "{refused}");
    }
}
