//! Links of the README, beside the source and in the documentation.

use std::path::Path;

const README: &str = include_str!("../../README.md");
const SHOWN_AS_DOCUMENTATION: &str = include_str!("../../src/readme_links.md");

/// Returns labels and targets of the links that a text defines.
fn definitions(text: &str) -> Vec<(&str, &str)> {
    text.lines()
        .filter_map(|line| line.strip_prefix('[')?.split_once("]: "))
        .collect()
}

#[test]
fn every_link_leads_to_a_file_or_folder() {
    let links = definitions(README);
    assert!(!links.is_empty());
    for (label, target) in links {
        assert_eq!(label, target);
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(target);
        assert!(path.exists(), "{target}");
        let uses = README.matches(&format!("[{label}]")).count();
        assert!(uses > 1, "{label} is defined and not used");
    }
}

#[test]
fn every_link_leads_to_a_module_where_it_is_shown_as_documentation() {
    let labels = |text| {
        let definitions = definitions(text).into_iter();
        definitions.map(|(label, _)| label).collect::<Vec<_>>()
    };
    assert_eq!(labels(README), labels(SHOWN_AS_DOCUMENTATION));
    // The build of the documentation checks that the modules exist.
    let inline = README
        .match_indices("](")
        .filter(|(at, _)| !README[at + 2..].starts_with("http"));
    assert_eq!(inline.count(), 0, "a link in line cannot be led elsewhere");
}
