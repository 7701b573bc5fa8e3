//! Text of a source with the changes of mutants in it.

use std::{cmp::Reverse, collections::BTreeMap};

/// Path of the function that is asked which mutant the program is.
const IS: &str = "crate::mutant::is";

/// Marks in comments around the text of a mutant, and around all of those of an expression.
const OPEN: &str = "/*<";
const CLOSE: &str = "/*>";

/// Part of a source at which changes are put.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PlaceOfChange {
    /// An expression, from start to end.
    Around(usize, Reverse<usize>),
    /// Beginning of a function's body.
    Before(usize),
    /// End of the pattern of an arm without a guard.
    Guard(usize),
}

/// Change of a mutant.
#[derive(Debug)]
pub(super) struct Change {
    pub(super) place: PlaceOfChange,
    /// Number of the mutant.
    pub(super) number: usize,
    /// Text that stands there in the mutant.
    pub(super) text: String,
}

/// Changes by the part of the source that they change.
#[derive(Debug, Default)]
pub(super) struct Edits {
    changes: BTreeMap<PlaceOfChange, Vec<(usize, String)>>,
}

impl Edits {
    pub(super) fn add(&mut self, change: Change) {
        let at = self.changes.entry(change.place).or_default();
        at.push((change.number, change.text));
    }

    /// Returns the text of a source with the changes.
    pub(super) fn apply(&self, text: &str) -> String {
        // Ends come before beginnings, and of those the innermost first.
        let mut insertions: Vec<(usize, u8, Reverse<usize>, String)> = vec![];
        for (place, changes) in &self.changes {
            let marked = |(number, text): &(usize, String)| {
                format!("if {IS}({number}) {{{OPEN}{number}*/ {text} {CLOSE}{number}*/}}")
            };
            let all: Vec<_> = changes.iter().map(marked).collect();
            match *place {
                PlaceOfChange::Around(start, Reverse(end)) => {
                    let numbers: Vec<_> = changes
                        .iter()
                        .map(|(number, _)| number.to_string())
                        .collect();
                    let numbers = numbers.join(",");
                    let opening = format!("{OPEN}{numbers}*/({} else {{", all.join(" else "));
                    // The longest of those that begin here is the outermost.
                    insertions.push((start, 2, Reverse(end), opening));
                    let closing = format!("}}){CLOSE}{numbers}*/");
                    insertions.push((end, 0, Reverse(start), closing));
                }
                PlaceOfChange::Before(at) => {
                    insertions.push((at, 1, Reverse(0), all.join(" ")));
                }
                PlaceOfChange::Guard(at) => {
                    let is_not = changes.iter().map(|(number, _)| {
                        format!("{OPEN}{number}*/!{IS}({number}){CLOSE}{number}*/")
                    });
                    let is_not: Vec<_> = is_not.collect();
                    insertions.push((at, 0, Reverse(at), format!(" if {}", is_not.join(" && "))));
                }
            }
        }
        insertions.sort_by_key(|(at, rank, other_end, _)| (*at, *rank, *other_end));
        let mut written = String::new();
        let mut from = 0;
        for (at, _, _, insertion) in &insertions {
            written += text.get(from..*at).unwrap_or_default();
            written += insertion;
            from = *at;
        }
        written + text.get(from..).unwrap_or_default()
    }
}

/// Returns the numbers of the mutants in whose text, or in the text around it, an error lies.
pub(super) fn numbers_at(text: &str, at: usize) -> Vec<usize> {
    let before = text.get(..at).unwrap_or_default();
    let mut open: Vec<&str> = vec![];
    let mut rest = before;
    while let Some(next) = rest.find("/*") {
        rest = rest.get(next..).unwrap_or_default();
        let mark = rest.get(..3).unwrap_or_default();
        let inside = rest.get(3..).and_then(|rest| rest.split("*/").next());
        if mark == OPEN {
            open.extend(inside);
        } else if mark == CLOSE {
            open.pop();
        }
        rest = rest.get(2..).unwrap_or_default();
    }
    let innermost = open.last().copied().unwrap_or_default();
    innermost
        .split(',')
        .filter_map(|number| number.parse().ok())
        .collect()
}
