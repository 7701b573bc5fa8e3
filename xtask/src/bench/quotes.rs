//! Quotes of the tables in sentences of documents and of the sources' documentation.
//!
//! Every sentence with a number of instructions or cycles is listed here: it is built from the
//! tables in [`quotes`], or, if the number has another origin, it is in [`OF_OTHER_SOURCES`].

mod sentences;

use std::ops::Range;

use self::sentences::{Quote, quotes};
use super::{
    cost::{Cost as _, Footprint, Instructions},
    limit::LIMITS,
    prose::{files, paragraphs, places, with_numbers},
};

const README: &str = "README.md";
const CHANGELOG: &str = "CHANGELOG.md";
const PERFORMANCE: &str = "docs/performance.md";
const CONTROL_LOOP: &str = "docs/control_loop.md";
const INTEGRATION: &str = "docs/integration.md";
const ROWS: &str = "src/geometry/mesh/displacement_rows.rs";

/// Numbers that are not in a table: those of manuals, of experiments that are not repeated, and of
/// the method of counting.
const OF_OTHER_SOURCES: [(&str, &str); 22] = [
    // From manuals and models.
    (CONTROL_LOOP, "square roots (14 cycles each)"),
    (CONTROL_LOOP, "the 12 cycles each way"),
    (PERFORMANCE, "a taken branch 3 (its manual: 2 to 4)"),
    (PERFORMANCE, "on the M7 26.5 with every word apart"),
    (PERFORMANCE, "llvm-mca gives the loop 0.80"),
    (
        "src/geometry/mesh/pixel_correction.rs",
        "a division would take 14 cycles",
    ),
    ("crates/kernel/src/thumbv7em.s", "M4F: 2 cycles, M7: 3"),
    (
        "benches/instructions/src/interrupts.rs",
        "12 cycles each on a Cortex-M4",
    ),
    // From experiments.
    (CHANGELOG, "instead of 2218"),
    (
        PERFORMANCE,
        "23 to 30 instructions, but 41 to 49 modelled cycles",
    ),
    (
        PERFORMANCE,
        "AVX2 3.88 and 4.88 in the full form, pairs 4.25",
    ),
    (
        PERFORMANCE,
        "an event or tick takes up to 240 instructions more",
    ),
    (ROWS, "60 instructions per start"),
    (
        INTEGRATION,
        "on an M4F 99 instructions per point instead of 13",
    ),
    // From the registers of a loop, by its source.
    (PERFORMANCE, "29 less the 2 that VMLA joins"),
    // From the method of counting and flying.
    (
        PERFORMANCE,
        "Instructions per point over a slice of 1024 points",
    ),
    (CONTROL_LOOP, "in a flight at 2 frames/s"),
    (
        PERFORMANCE,
        "240 instructions at least for an event or tick",
    ),
    (
        "host-sim/src/device/machine.rs",
        "One instruction takes 1 ns",
    ),
    (
        "benches/instructions/src/main.rs",
        "40 to a tick, 31.25 on the Cortex-M55",
    ),
    (
        "benches/instructions/src/counter.rs",
        "Instructions to four ticks: 1 ns each",
    ),
    // Compared by the step `c`.
    ("docs/c.md", "takes at most 60 instructions over"),
];

#[test]
fn every_quote_is_that_of_the_committed_tables() {
    let mut missing = Vec::new();
    for Quote { file, sentence } in quotes() {
        let paragraphs = paragraphs(file);
        let is_in = |text: &String| places(text, &sentence).next().is_some();
        if !paragraphs.iter().any(is_in) {
            missing.push(format!("{file}: {sentence}"));
        }
    }
    assert!(missing.is_empty(), "{missing:#?}");
}

/// Returns true if one of the texts overlaps a sentence of a paragraph.
fn is_read(paragraph: &str, sentence: &Range<usize>, texts: &[&str]) -> bool {
    texts.iter().any(|text| {
        let mut places = places(paragraph, text);
        places.any(|place| place.start < sentence.end && sentence.start < place.end)
    })
}

#[test]
fn every_number_of_instructions_or_cycles_is_read() {
    let quotes = quotes();
    let mut sentences = 0;
    let mut unread = Vec::new();
    for file in files() {
        let of_tables = quotes.iter().filter(|quote| quote.file == file);
        let of_others = OF_OTHER_SOURCES.iter().filter(|(name, _)| *name == file);
        let texts: Vec<_> = of_tables
            .map(|quote| quote.sentence.as_str())
            .chain(of_others.map(|(_, text)| *text))
            .collect();
        let paragraphs = paragraphs(&file);
        // The rows of tables are compared elsewhere.
        for paragraph in paragraphs.iter().filter(|text| !text.starts_with('|')) {
            for sentence in with_numbers(paragraph) {
                sentences += 1;
                if !is_read(paragraph, &sentence, &texts) {
                    unread.push(format!("{file}: {}", &paragraph[sentence]));
                }
            }
        }
    }
    assert!(unread.is_empty(), "{unread:#?}");
    assert!(sentences > 30, "{sentences}");
}

#[test]
fn numbers_of_other_sources_are_still_there() {
    for (file, text) in OF_OTHER_SOURCES {
        let is_there = paragraphs(file).iter().any(|paragraph| {
            let sentences = with_numbers(paragraph);
            sentences
                .iter()
                .any(|sentence| is_read(paragraph, sentence, &[text]))
        });
        assert!(is_there, "{file}: {text}");
    }
}

#[test]
fn tables_and_limits_are_named_by_the_readme() {
    let readme = paragraphs(README);
    for table in [Instructions::TABLE, Footprint::TABLE, LIMITS] {
        let link = format!("[{table}]");
        assert!(readme.iter().any(|text| text.contains(&link)), "{table}");
    }
}
