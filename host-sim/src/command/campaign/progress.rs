//! Progress of a campaign on the disk: the outcomes of complete blocks, appended one by one.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use fmc_simulation::campaign::outcome::Outcome;
use fmc_simulation::campaign::plan::Block;

use crate::failure::Failure;

/// Name of the file.
const NAME: &str = "progress.txt";
/// First line of the file.
const TITLE: &str = "host-sim campaign";

/// Names and values on which the results depend.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header(pub(super) Vec<(&'static str, String)>);

impl Header {
    fn text(&self) -> String {
        let lines = self
            .0
            .iter()
            .map(|(key, value)| format!("{key} = {value}\n"));
        format!("{TITLE}\n{}\n", lines.collect::<String>())
    }
}

/// The file with the blocks that are complete.
///
/// A block is written at once, and ends with a check sum. What a kill or a full disk leaves of one
/// is cut off when the campaign goes on.
#[derive(Debug)]
pub(super) struct Progress {
    file: File,
    path: PathBuf,
    done: BTreeMap<String, Vec<Outcome>>,
}

impl Progress {
    /// Opens the progress of a folder, or begins it.
    ///
    /// # Errors
    /// [`Failure`] if the file is another's, is that of a campaign with another header, is in use,
    /// or cannot be read or written.
    pub(super) fn open(folder: &Path, header: &Header) -> Result<Self, Failure> {
        let path = folder.join(NAME);
        let failed = |error: &std::io::Error| Failure::writing(path.display(), error);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(|error| failed(&error))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return Err(Failure::bad_input(format!(
                    "{}: another campaign writes it",
                    path.display()
                )));
            }
            // Some network file systems have no locks.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)
            .map_err(|error| Failure::reading(&path, &error))?;
        let title = header.text();
        let mut done = BTreeMap::new();
        let kept = if title.as_bytes().starts_with(&bytes) {
            // New, or ended before its header was complete.
            0
        } else if let Some(blocks) = bytes.strip_prefix(title.as_bytes()) {
            title.len() + read_blocks(utf8_start(blocks), &mut done)
        } else {
            let text = String::from_utf8_lossy(&bytes);
            return Err(difference(&text, header, &path));
        };
        let kept_bytes = u64::try_from(kept).unwrap_or(0);
        file.set_len(kept_bytes).map_err(|error| failed(&error))?;
        file.seek(SeekFrom::End(0))
            .map_err(|error| failed(&error))?;
        let mut progress = Self { file, path, done };
        if kept == 0 {
            progress.append(&title)?;
        }
        Ok(progress)
    }

    /// Returns true if a block of so many runs is there.
    pub(super) fn has(&self, block: Block, runs: usize) -> bool {
        self.done
            .get(&name(block))
            .is_some_and(|outcomes| outcomes.len() == runs)
    }

    /// Appends the outcomes of a block.
    ///
    /// # Errors
    /// [`Failure`] naming the file; the blocks before are kept.
    pub(super) fn add(&mut self, block: Block, outcomes: Vec<Outcome>) -> Result<(), Failure> {
        let name = name(block);
        let text =
            text(&name, &outcomes).map_err(|error| Failure::device_or_io(error.to_string()))?;
        self.append(&text)?;
        self.done.insert(name, outcomes);
        Ok(())
    }

    /// Removes and returns the outcomes of a block; none for one that is not there.
    pub(super) fn take(&mut self, block: Block) -> Vec<Outcome> {
        self.done.remove(&name(block)).unwrap_or_default()
    }

    fn append(&mut self, text: &str) -> Result<(), Failure> {
        self.file
            .write_all(text.as_bytes())
            .map_err(|error| Failure::writing(self.path.display(), &error))
    }
}

fn name(block: Block) -> String {
    match block {
        Block::Tick(tick) => format!("tick {tick}"),
        Block::Pairs(first) => format!("pairs {first}"),
    }
}

/// Writes a block: its name, its outcomes, and the check sum of both.
fn text(name: &str, outcomes: &[Outcome]) -> csv::Result<String> {
    let lines = format!("{name}\n{}", Outcome::write_rows(outcomes)?);
    Ok(format!("{lines}end {:08x}\n", sum(&lines)))
}

fn sum(lines: &str) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(lines.as_bytes())
}

/// Returns the bytes before the first that is not UTF-8.
fn utf8_start(bytes: &[u8]) -> &str {
    bytes.utf8_chunks().next().map_or("", |chunk| chunk.valid())
}

/// Reads complete blocks. Returns the length of their text, after which nothing is to be trusted.
fn read_blocks(text: &str, done: &mut BTreeMap<String, Vec<Outcome>>) -> usize {
    let mut length = 0;
    while let Some((name, outcomes, end)) = text.get(length..).and_then(read_block) {
        done.insert(name, outcomes);
        length += end;
    }
    length
}

fn read_block(text: &str) -> Option<(String, Vec<Outcome>, usize)> {
    let (lines, rest) = text.split_at_checked(text.find("\nend ")? + 1)?;
    let (end, _) = rest.split_once('\n')?;
    if end.strip_prefix("end ")? != format!("{:08x}", sum(lines)) {
        return None;
    }
    let (name, outcomes) = lines.split_once('\n')?;
    let outcomes = Outcome::read_rows(outcomes).ok()?;
    let length = lines.len() + end.len() + 1;
    Some((name.to_owned(), outcomes, length))
}

/// Returns the refusal of a file with another header, which names the first difference.
fn difference(text: &str, header: &Header, path: &Path) -> Failure {
    let path = path.display();
    let mut lines = text.lines();
    if lines.next() != Some(TITLE) {
        return Failure::bad_input(format!("{path}: is not the progress of a campaign"));
    }
    for (key, value) in &header.0 {
        let found = lines
            .next()
            .and_then(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        if found != Some(value.as_str()) {
            let found = found.unwrap_or("missing");
            return Failure::bad_input(format!(
                "{path}: {key} is {found} there and {value} here"
            ))
            .with_help(
                "a campaign goes on with the program and the options that it was begun with; give another --out for a new one",
            );
        }
    }
    Failure::bad_input(format!("{path}: its header is damaged"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(exposed: u32) -> Outcome {
        Outcome {
            arrived_ms: Some(1),
            effect: "fault stall".to_owned(),
            effect_ms: Some(5),
            worst_of: String::new(),
            worst: None,
            silent: 0,
            first_silent: None,
            unrecorded: 0,
            unanswered: 0,
            exposed,
        }
    }

    fn header(seed: &str) -> Header {
        Header(vec![("version", "1".to_owned()), ("seed", seed.to_owned())])
    }

    #[test]
    fn file_cut_at_any_byte_keeps_its_complete_blocks_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let mut progress = Progress::open(folder.path(), &header("1")).unwrap();
        let blocks = [Block::Tick(0), Block::Tick(1), Block::Pairs(500)];
        let mut ends = Vec::new();
        for (block, exposed) in blocks.into_iter().zip(3..) {
            // The second block has no runs.
            let runs = if exposed == 4 {
                Vec::new()
            } else {
                vec![outcome(exposed); 2]
            };
            progress.add(block, runs).unwrap();
            ends.push(std::fs::metadata(folder.path().join(NAME)).unwrap().len());
        }
        drop(progress);
        let whole = std::fs::read(folder.path().join(NAME)).unwrap();
        for length in 0..=whole.len() {
            std::fs::write(folder.path().join(NAME), &whole[..length]).unwrap();
            let progress = Progress::open(folder.path(), &header("1")).unwrap();
            let complete = ends.iter().filter(|end| **end <= length as u64).count();
            assert_eq!(progress.done.len(), complete, "cut at {length}");
            for block in blocks.into_iter().take(complete) {
                assert!(progress.done.contains_key(&name(block)));
            }
        }
    }

    #[test]
    fn other_options_and_other_files_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        drop(Progress::open(folder.path(), &header("1")).unwrap());
        let refused = Progress::open(folder.path(), &header("2")).unwrap_err();
        assert!(
            refused.text().contains("seed is 1 there and 2 here"),
            "{}",
            refused.text()
        );
        std::fs::write(folder.path().join(NAME), "my notes\n").unwrap();
        let refused = Progress::open(folder.path(), &header("1")).unwrap_err();
        assert!(
            refused.text().contains("is not the progress"),
            "{}",
            refused.text()
        );
        assert_eq!(
            std::fs::read(folder.path().join(NAME)).unwrap(),
            b"my notes\n"
        );
    }

    #[test]
    fn header_with_other_line_ends_is_refused_and_the_file_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let mut progress = Progress::open(folder.path(), &header("1")).unwrap();
        progress.add(Block::Tick(0), vec![outcome(4)]).unwrap();
        drop(progress);
        let path = folder.path().join(NAME);
        let text = std::fs::read_to_string(&path).unwrap();
        let damaged = text.replace('\n', "\r\n");
        std::fs::write(&path, &damaged).unwrap();
        let refused = Progress::open(folder.path(), &header("1")).unwrap_err();
        assert!(
            refused.text().contains("its header is damaged"),
            "{}",
            refused.text()
        );
        assert_eq!(std::fs::read_to_string(&path).unwrap(), damaged);
    }

    #[test]
    fn damaged_block_ends_what_is_trusted() {
        let folder = tempfile::tempdir().unwrap();
        let mut progress = Progress::open(folder.path(), &header("1")).unwrap();
        for tick in 0..3 {
            progress.add(Block::Tick(tick), vec![outcome(4)]).unwrap();
        }
        drop(progress);
        let path = folder.path().join(NAME);
        let text = std::fs::read_to_string(&path).unwrap();
        let (before, after) = text.split_once("tick 1\n").unwrap();
        let changed = after.replacen("stall", "scale", 1);
        let damages: [(&[u8], &str); 4] = [
            (b"tick 1\n", &changed),
            (b"tick 7\n", after),
            (b"tick \xff\n", after),
            (b"tick 1\xff\n", after),
        ];
        for (name, after) in damages {
            let damaged = [before.as_bytes(), name, after.as_bytes()].concat();
            std::fs::write(&path, damaged).unwrap();
            let progress = Progress::open(folder.path(), &header("1")).unwrap();
            assert_eq!(progress.done.len(), 1);
            assert!(progress.has(Block::Tick(0), 1) && !progress.has(Block::Tick(0), 2));
            drop(progress);
            assert_eq!(std::fs::read_to_string(&path).unwrap(), before);
        }
    }
}
