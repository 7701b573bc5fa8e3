//! Copies of the sources that interrupts and the main loop share, with the atomics of the model
//! checker, as they are and each with one fault.
//!
//! What is replaced must be in the source as often as is said here, so that a change of the source
//! leaves no check without its object.

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Root of the project.
const ROOT: &str = "../..";

/// A source, and its faults.
struct Source {
    path: &'static str,
    /// Name of the copies.
    name: &'static str,
    /// First line of the part that is copied, and the first behind it; all up to the tests if there
    /// is none.
    part: Option<[&'static str; 2]>,
    faults: &'static [Fault],
}

/// A fault of a copy.
struct Fault {
    /// Name of the copy.
    name: &'static str,
    /// Text of the source, which has it once.
    old: &'static str,
    new: &'static str,
}

const SOURCES: [Source; 3] = [
    Source {
        path: "src/flight/ring.rs",
        name: "ring",
        part: None,
        faults: &[
            Fault {
                name: "ring_number_before_item",
                old: "                item.store(place);
                self.written
                    .store(written.wrapping_add(1), Ordering::Release);",
                new: "                self.written
                    .store(written.wrapping_add(1), Ordering::Release);
                item.store(place);",
            },
            Fault {
                name: "ring_writer_without_release",
                old: ".store(written.wrapping_add(1), Ordering::Release)",
                new: ".store(written.wrapping_add(1), Ordering::Relaxed)",
            },
            Fault {
                name: "ring_reader_without_acquire",
                old: "if read == self.written.load(Ordering::Acquire) {
            return None;",
                new: "if read == self.written.load(Ordering::Relaxed) {
            return None;",
            },
            Fault {
                name: "ring_place_free_before_it_is_read",
                old: "        let item = T::load(self.places.get(read % PLACES)?);
        self.read.store(read.wrapping_add(1), Ordering::Release);",
                new: "        self.read.store(read.wrapping_add(1), Ordering::Release);
        let item = T::load(self.places.get(read % PLACES)?);",
            },
            Fault {
                name: "ring_reader_without_release",
                old: "self.read.store(read.wrapping_add(1), Ordering::Release)",
                new: "self.read.store(read.wrapping_add(1), Ordering::Relaxed)",
            },
            Fault {
                name: "ring_writer_without_acquire",
                old: "written.wrapping_sub(self.read.load(Ordering::Acquire)) < PLACES",
                new: "written.wrapping_sub(self.read.load(Ordering::Relaxed)) < PLACES",
            },
            Fault {
                name: "ring_lost_in_two_steps",
                old: "self.lost.fetch_add(items, Ordering::Relaxed);",
                new: "self.lost.store(self.lost.load(Ordering::Relaxed) + items, Ordering::Relaxed);",
            },
        ],
    },
    Source {
        path: "src/flight/round_guard.rs",
        name: "round_guard",
        part: None,
        faults: &[
            Fault {
                name: "round_guard_in_two_steps",
                old: "self.last_us.store(now_us, Ordering::Relaxed);",
                new: "self.last_us.store(now_us & 0xffff, Ordering::Relaxed);
        self.last_us.store(now_us, Ordering::Relaxed);",
            },
            Fault {
                name: "round_guard_without_wrap",
                old: "now_us.wrapping_sub(self.last_us.load(Ordering::Relaxed)) > LONGEST_ROUND_US",
                new: "now_us.saturating_sub(self.last_us.load(Ordering::Relaxed)) > LONGEST_ROUND_US",
            },
        ],
    },
    Source {
        path: "src/bin/firmware/board/nucleo_h743zi/shutter.rs",
        name: "shutter",
        part: Some([
            "/// Sets the command that leaves at a time of the counter",
            "/// The compare interrupt.",
        ]),
        faults: &[
            Fault {
                name: "shutter_without_mask",
                old: "critical_section::with(",
                new: "critical_section::without(",
            },
            Fault {
                name: "shutter_without_second_look",
                old: "if !has_come(next_us, now_us) {",
                new: "if has_come(now_us, now_us) {",
            },
            Fault {
                name: "shutter_without_match",
                old: "if timer.dier().read().ccie(COMMAND) && timer.sr().read().ccif(COMMAND) {",
                new: "if !timer.dier().read().ccie(COMMAND) && timer.sr().read().ccif(COMMAND) {",
            },
        ],
    },
];

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var("OUT_DIR")?);
    for source in &SOURCES {
        let path = Path::new(ROOT).join(source.path);
        println!("cargo::rerun-if-changed={}", path.display());
        let text = fs::read_to_string(&path)?;
        let copied = source.copied(&text)?;
        let write = |name: &str, text: &str| fs::write(out.join(name).with_extension("rs"), text);
        write(source.name, &copied)?;
        for fault in source.faults {
            let faulty = replaced(&copied, fault.old, fault.new);
            write(
                fault.name,
                &faulty.map_err(|error| format!("{}: {error}", source.path))?,
            )?;
        }
    }
    Ok(())
}

impl Source {
    /// Returns the part of the source that is copied, with the atomics of the model checker.
    fn copied(&self, text: &str) -> Result<String, String> {
        let between = |begin: usize, behind: &str| {
            let rest = text.get(begin..)?;
            rest.get(..rest.find(behind)?)
        };
        let told = |what: &str| format!("{}: {what} is not there", self.path);
        let Some([first, behind]) = self.part else {
            let part =
                between(0, "#[cfg(test)]").ok_or_else(|| told("the beginning of the tests"))?;
            // Comments of a module cannot be included.
            let lines = part.lines().filter(|line| !line.starts_with("//!"));
            let part: Vec<&str> = lines.collect();
            return replaced(&part.join("\n"), "core::sync::atomic", "crate::atomic");
        };
        let begin = text.find(first).ok_or_else(|| told(first))?;
        let part = between(begin, behind).ok_or_else(|| told(behind))?;
        Ok(part.to_owned())
    }
}

/// Returns the text with its one `old` replaced.
fn replaced(text: &str, old: &str, new: &str) -> Result<String, String> {
    match text.matches(old).count() {
        1 => Ok(text.replace(old, new)),
        count => Err(format!("`{old}` is there {count} times")),
    }
}
