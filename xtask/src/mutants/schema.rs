//! One program that is every mutant, by a number that is given at its start.
//!
//! Each expression that a mutant changes becomes `(if is(NUMBER) { changed } else { as it was })`.
//! In the changed one nothing else is a mutant, so that the text grows with the depth of the
//! expressions alone.

use anyhow::Result;

use super::{edits::Edits, mutant::Mutant, places};

/// Text of a source, with mutants in it.
#[derive(Debug)]
pub(super) struct Schema {
    pub(super) text: String,
    /// Numbers of the mutants for which there is no place.
    pub(super) without_place: Vec<usize>,
}

/// Returns the source with mutants, each under its number.
///
/// # Errors
/// An error if the source is not Rust.
pub(super) fn write(text: &str, mutants: &[(usize, &Mutant)]) -> Result<Schema> {
    let mut edits = Edits::default();
    let mut without_place: Vec<usize> = mutants.iter().map(|(number, _)| *number).collect();
    for change in places::changes(text, mutants)? {
        without_place.retain(|number| *number != change.number);
        edits.add(change);
    }
    Ok(Schema {
        text: edits.apply(text),
        without_place,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::{
        edits::numbers_at,
        mutant::{Genre, Place, Span},
    };

    /// Returns a source without its brackets, and the mutant of the part between them.
    fn mutant(bracketed: &str, genre: Genre, replacement: &str) -> (String, Mutant) {
        let [before, changed, after] = bracketed.split(['«', '»']).collect::<Vec<_>>()[..] else {
            panic!("{bracketed} has no brackets");
        };
        let place = |text: &str| Place {
            line: text.matches('\n').count() + 1,
            column: text.rsplit('\n').next().unwrap().chars().count() + 1,
        };
        let mutant = Mutant {
            file: "a.rs".to_owned(),
            genre,
            span: Span {
                start: place(before),
                end: place(&format!("{before}{changed}")),
            },
            replacement: replacement.to_owned(),
            change: String::new(),
        };
        (format!("{before}{changed}{after}"), mutant)
    }

    fn without_marks(text: &str) -> String {
        let parts = text.split("/*").map(|part| match part.split_once("*/") {
            Some((mark, after)) if mark.starts_with(['<', '>']) => after,
            _ => part,
        });
        parts.collect()
    }

    #[test]
    fn each_change_stands_beside_the_code_as_it_was() {
        use Genre::{
            BinaryOperator, Condition, FnValue, MatchArm, MatchArmGuard, StructField, UnaryOperator,
        };
        for (source, genre, replacement, expected) in [
            (
                "fn f() -> u8 {\n    1 «+» 2 * 3 }",
                BinaryOperator,
                "*",
                "fn f() -> u8 {\n    (if IS { (1) * (2 * 3) } else {1 + 2 * 3}) }",
            ),
            (
                "fn f() { a «+=» b; }",
                BinaryOperator,
                "-=",
                "fn f() { (if IS { (a) -= (b) } else {a += b}); }",
            ),
            (
                "fn f() { let µ = «!»a(); }",
                UnaryOperator,
                "",
                "fn f() { let µ = (if IS { a() } else {!a()}); }",
            ),
            (
                "fn f() -> bool {«true»}",
                FnValue,
                "false",
                "fn f() -> bool {if IS { return false; }true}",
            ),
            (
                "fn f() { match x { «1 => 2», _ => 3 } }",
                MatchArm,
                "",
                "fn f() { match x { 1 if !IS => 2, _ => 3 } }",
            ),
            (
                "fn f() { match x { «1 if y => 2», _ => 3 } }",
                MatchArm,
                "",
                "fn f() { match x { 1 if (if IS { false } else {y}) => 2, _ => 3 } }",
            ),
            (
                "fn f() { match x { 1 if «y» => 2, _ => 3 } }",
                MatchArmGuard,
                "true",
                "fn f() { match x { 1 if (if IS { true } else {y}) => 2, _ => 3 } }",
            ),
            (
                "fn f() -> S { S { «a: 1», ..b } }",
                StructField,
                "",
                "fn f() -> S { (if IS { S { ..b } } else {S { a: 1, ..b }}) }",
            ),
            (
                "fn f() -> bool { if let Some(a) = b && «c» {} }",
                Condition,
                "true",
                "fn f() -> bool { if let Some(a) = b && (if IS { true } else {c}) {} }",
            ),
        ] {
            let (source, mutant) = mutant(source, genre, replacement);
            let schema = write(&source, &[(7, &mutant)]).unwrap();
            assert_eq!(schema.without_place, [0; 0], "{source}");
            let expected = expected.replace("IS", "crate::mutant::is(7)");
            assert_eq!(without_marks(&schema.text), expected);
        }
    }

    #[test]
    fn changes_for_which_there_is_no_place_are_named() {
        for (source, genre, replacement) in [
            // The pattern of a chain is no operand.
            (
                "fn f() { if let Some(a) = b «&&» c {} }",
                Genre::BinaryOperator,
                "||",
            ),
            // Two bodies of one function have one type.
            (
                "fn f() -> impl Iterator<Item = u8> { «a» }",
                Genre::FnValue,
                "core::iter::empty()",
            ),
            // Without the arm there is none for its value.
            (
                "fn f() { match x { «A => 2», _ if b => 3, B => 4 } }",
                Genre::MatchArm,
                "",
            ),
            (
                "fn f() {} #[cfg(test)] mod tests { fn g() { 1 «+» 2; } }",
                Genre::BinaryOperator,
                "-",
            ),
        ] {
            let (source, mutant) = mutant(source, genre, replacement);
            let schema = write(&source, &[(7, &mutant)]).unwrap();
            assert_eq!(schema.without_place, [7], "{source}");
            assert_eq!(schema.text, source);
        }
    }

    #[test]
    fn error_is_of_the_mutant_in_whose_text_it_is_or_of_those_around_it() {
        let (source, plus) = mutant(
            "fn f() -> u8 { g(1 «+» 2) * 3 }",
            Genre::BinaryOperator,
            "-",
        );
        let (_, times) = mutant(
            "fn f() -> u8 { g(1 + 2) «*» 3 }",
            Genre::BinaryOperator,
            "/",
        );
        let schema = write(&source, &[(4, &plus), (5, &plus), (6, &times)]).unwrap();
        let text = schema.text;
        for (part, numbers) in [
            ("fn f", vec![]),
            ("/ (3)", vec![6]),
            ("- (2)", vec![4]),
            ("1 + 2})", vec![4, 5]),
            ("* 3", vec![6]),
        ] {
            let at = text.find(part).unwrap();
            assert_eq!(numbers_at(&text, at), numbers, "{part} in {text}");
        }
    }
}
