//! Links of a document in Markdown, and of a page in HTML.

use std::path::{Component, Path, PathBuf};

/// Returns a document with every link to a file changed by `change`, which receives what is before
/// a `#`; code and links to other sites stay.
pub(super) fn change(
    document: &str,
    mut change: impl FnMut(&str) -> Result<String, String>,
) -> Result<String, Vec<String>> {
    let mut faults = Vec::new();
    let mut changed = String::with_capacity(document.len());
    let mut in_code = false;
    for (number, line) in document.split_inclusive('\n').enumerate() {
        if line.starts_with("```") {
            in_code = !in_code;
        }
        if in_code || line.starts_with("    ") {
            changed.push_str(line);
            continue;
        }
        let mut rest = line;
        // A definition has a line of its own.
        if rest.starts_with('[')
            && let Some((label, target)) = rest.split_once("]: ")
        {
            changed.push_str(label);
            changed.push_str("]: ");
            match moved(target.trim_end(), &mut change) {
                Ok(target) => changed.push_str(&target),
                Err(fault) => faults.push(format!("line {}: {fault}", number + 1)),
            }
            changed.push('\n');
            continue;
        }
        while let Some((before, target, after)) = inline(rest) {
            changed.push_str(before);
            match moved(target, &mut change) {
                Ok(target) => changed.push_str(&target),
                Err(fault) => faults.push(format!("line {}: {fault}", number + 1)),
            }
            rest = after;
        }
        changed.push_str(rest);
    }
    if faults.is_empty() {
        Ok(changed)
    } else {
        Err(faults)
    }
}

/// Divides a line about the target of its first link.
fn inline(line: &str) -> Option<(&str, &str, &str)> {
    let start = line.find("](")? + 2;
    let (before, rest) = line.split_at_checked(start)?;
    let (target, after) = rest.split_at_checked(rest.find(')')?)?;
    Some((before, target, after))
}

fn moved(
    target: &str,
    change: &mut impl FnMut(&str) -> Result<String, String>,
) -> Result<String, String> {
    if is_elsewhere(target) || target.starts_with('#') {
        return Ok(target.to_owned());
    }
    match target.split_once('#') {
        Some((file, anchor)) => Ok(format!("{}#{anchor}", change(file)?)),
        None => change(target),
    }
}

/// Returns true for an address on another site, and for what is no file.
pub(super) fn is_elsewhere(target: &str) -> bool {
    ["http://", "https://", "mailto:", "data:", "javascript:"]
        .iter()
        .any(|scheme| target.starts_with(scheme))
}

/// Returns the place of a link's target, seen from the folder of the page: without `.` and `..`.
pub(super) fn resolved(folder: &Path, target: &str) -> Option<PathBuf> {
    let mut path = PathBuf::new();
    for part in folder.join(target).components() {
        match part {
            Component::Normal(name) => path.push(name),
            Component::ParentDir => {
                if !path.pop() {
                    return None;
                }
            }
            Component::CurDir => {}
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(path)
}

/// Returns the values of an attribute in a page.
pub(super) fn attributes(page: &str, name: &str) -> Vec<String> {
    let begin = format!(" {name}=\"");
    let values = page.split(begin.as_str()).skip(1);
    values
        .filter_map(|rest| rest.split('"').next())
        .map(|value| decoded(&value.replace("&amp;", "&")))
        .collect()
}

/// Returns an address with its bytes in place of `%xx`.
fn decoded(address: &str) -> String {
    let mut bytes = Vec::with_capacity(address.len());
    let mut rest = address;
    while let Some((before, after)) = rest.split_once('%') {
        bytes.extend_from_slice(before.as_bytes());
        let byte = after
            .get(..2)
            .and_then(|digits| u8::from_str_radix(digits, 16).ok());
        if let (Some(byte), Some(behind)) = (byte, after.get(2..)) {
            bytes.push(byte);
            rest = behind;
        } else {
            bytes.push(b'%');
            rest = after;
        }
    }
    bytes.extend_from_slice(rest.as_bytes());
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_changed_and_code_and_other_sites_are_not() {
        let document =
            "[a](x.rs#l1), [b](https://x.org/y.rs) [c](#here)\n```text\n[a](x.rs)\n```\n[d]: src\n";
        let found = change(document, |file| Ok(format!("{file}.md"))).unwrap();
        let expected = "[a](x.rs.md#l1), [b](https://x.org/y.rs) [c](#here)\n```text\n[a](x.rs)\n```\n[d]: src.md\n";
        assert_eq!(found, expected);
    }

    #[test]
    fn every_dead_link_is_named_with_its_line() {
        let refused = |file: &str| Err(format!("{file} does not exist"));
        let faults = change("a\n[b](x) [c](y)\n", refused).unwrap_err();
        assert_eq!(
            faults,
            ["line 2: x does not exist", "line 2: y does not exist"]
        );
    }

    #[test]
    fn targets_are_resolved_inside_the_project_alone() {
        let resolved = |target: &str| resolved(Path::new("docs"), target);
        assert_eq!(resolved("../src/./lib.rs"), Some("src/lib.rs".into()));
        assert_eq!(resolved("../../etc"), None);
        assert_eq!(resolved("/etc"), None);
    }

    #[test]
    fn attributes_are_decoded() {
        let page = "<a href=\"x.html#l3-19-%C2%B5m\">x</a><h2 id=\"a&amp;b\">";
        assert_eq!(attributes(page, "href"), ["x.html#l3-19-µm"]);
        assert_eq!(attributes(page, "id"), ["a&b"]);
        assert_eq!(decoded("100%"), "100%");
    }
}
