//! Calls by pointers, whose targets the code does not state: `docs/pointer-calls.csv` lists them.

use std::path::Path;

use anyhow::{Result, ensure};
use serde::Deserialize;

use super::image::Code;
use crate::bench::read_table;

/// Path of the list.
pub(super) const LIST: &str = "docs/pointer-calls.csv";

/// Row of the list. Names are those that `rust-demangle` gives without `<` and `>`; one `*` stands
/// for any characters, since compilers write the types of generic functions in different ways.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct PointerCall {
    /// Function that calls.
    caller: String,
    /// Function that it may call.
    target: String,
}

/// Targets of calls by pointers.
#[derive(Debug)]
pub(super) struct PointerCalls(Vec<PointerCall>);

impl PointerCalls {
    /// No calls.
    pub(super) const NONE: Self = Self(vec![]);

    /// Reads the list.
    ///
    /// # Errors
    /// An error if it is missing or is not such a table.
    pub(super) fn read(root: &Path) -> Result<Self> {
        read_table(&root.join(LIST)).map(Self)
    }

    /// Returns the functions that a function may call by pointers.
    ///
    /// # Errors
    /// An error if the list has none for it, or the image has none of those.
    pub(super) fn targets(&self, code: &Code, caller: &str) -> Result<Vec<u32>> {
        let rows = self.0.iter().filter(|row| matches(&row.caller, caller));
        let patterns: Vec<_> = rows.map(|row| row.target.as_str()).collect();
        ensure!(
            !patterns.is_empty(),
            "{caller} calls by a pointer, and {LIST} has no target for it"
        );
        let is_target = |name: &str| patterns.iter().any(|pattern| matches(pattern, name));
        let functions = code.functions().filter(|(_, name)| is_target(name));
        let found: Vec<_> = functions.map(|(address, _)| address).collect();
        ensure!(
            !found.is_empty(),
            "{caller} calls by a pointer, and the image has none of its targets in {LIST}"
        );
        Ok(found)
    }

    /// Calls of the second function of each pair by the first.
    #[cfg(test)]
    pub(super) fn of(pairs: &[[&str; 2]]) -> Self {
        let row = |[caller, target]: &[&str; 2]| PointerCall {
            caller: (*caller).to_owned(),
            target: (*target).to_owned(),
        };
        Self(pairs.iter().map(row).collect())
    }

    /// Returns true if the list has a function as a target of one of the image.
    pub(super) fn are_to(&self, code: &Code, function: &str) -> bool {
        let is_there = |caller: &str| code.functions().any(|(_, name)| matches(caller, name));
        let mut rows = self.0.iter();
        rows.any(|row| matches(&row.target, function) && is_there(&row.caller))
    }
}

/// Returns true if a pattern, with one `*` at most, is that of a name.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        None => pattern == name,
        Some((start, end)) => name
            .strip_prefix(start)
            .is_some_and(|rest| rest.ends_with(end)),
    }
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn star_stands_for_any_characters() {
        assert!(matches("a::b", "a::b"));
        assert!(!matches("a::b", "a::bc"));
        assert!(matches("a::B*::act", "a::BD as c::D::act"));
        assert!(!matches("a::B*::act", "a::C::act"));
        // Start and end do not overlap.
        assert!(!matches("aba*ba", "aba"));
    }
}
