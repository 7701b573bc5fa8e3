//! Numbers, ranges and places as the pages write them.

use crate::stated::Stated;

/// Word for what is not known.
pub(super) const NOT_STATED: &str = "not stated";

/// Writes a number, or that it is not stated.
pub(super) fn number(stated: Option<&Stated>) -> String {
    stated.map_or(NOT_STATED, Stated::text).to_owned()
}

/// Writes a number with its unit, or that it is not stated.
pub(super) fn with_unit(stated: Option<&Stated>, unit: &str) -> String {
    match (stated, unit) {
        (None, _) => NOT_STATED.to_owned(),
        (Some(stated), "") => stated.text().to_owned(),
        (Some(stated), unit) => format!("{stated} {unit}"),
    }
}

/// Writes the number of a cell, or a dash: what is missing is explained under the table.
pub(super) fn cell(stated: Option<&Stated>) -> String {
    stated.map_or("–", Stated::text).to_owned()
}

/// Writes both ends of a range with their unit.
pub(super) fn range([least, most]: &[Option<Stated>; 2], unit: &str) -> String {
    match (least, most) {
        (Some(least), Some(most)) => format!("{least} to {most} {unit}").trim_end().to_owned(),
        _ => NOT_STATED.to_owned(),
    }
}

/// Writes a place in the sensor frame.
pub(super) fn place([x, y]: &[Option<Stated>; 2]) -> String {
    match (x, y) {
        (Some(x), Some(y)) => format!("({x}, {y}) mm"),
        _ => NOT_STATED.to_owned(),
    }
}

/// Returns a name with what it stands for.
pub(super) fn pair(name: &str, what: impl Into<String>) -> [String; 2] {
    [name.to_owned(), what.into()]
}
