//! Places of outputs and inputs.

use std::fs;
use std::path::Path;

/// Returns `true` if an output would take the place of an input: both exist, and are one file, by
/// whatever names and links.
#[must_use]
pub fn is_the_same(out: &Path, input: &Path) -> bool {
    matches!((fs::canonicalize(out), fs::canonicalize(input)), (Ok(a), Ok(b)) if a == b)
}
