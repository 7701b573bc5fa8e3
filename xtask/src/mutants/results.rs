//! Results of mutants that have been tried, from which a run that was interrupted goes on.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    hash::{DefaultHasher, Hash as _, Hasher as _},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::Duration,
};

use anyhow::{Context as _, Result};
use serde::{Deserialize, Serialize};

use super::{
    mutant::Mutant,
    trial::{Outcome, Test},
};

/// Results of the same programs, and the file to which others are added.
#[derive(Debug)]
pub(super) struct Results {
    /// Digest of the programs.
    programs: String,
    known: BTreeMap<usize, Outcome>,
    file: Mutex<csv::Writer<File>>,
}

/// Row of the file.
#[derive(Debug, Serialize, Deserialize)]
struct Row {
    programs: String,
    number: usize,
    outcome: Outcome,
    seconds: f64,
    mutant: String,
    /// Test that fails, or the first of those that ran together when one failed.
    test: String,
}

impl Results {
    /// Reads the results of these programs.
    ///
    /// # Errors
    /// An error if a program cannot be read or if the file cannot be written.
    pub(super) fn open(path: &Path, programs: &[PathBuf]) -> Result<Self> {
        let told = || path.display().to_string();
        let mut hasher = DefaultHasher::new();
        for program in programs {
            let bytes = fs::read(program).with_context(|| program.display().to_string())?;
            bytes.hash(&mut hasher);
        }
        let programs = format!("{:016x}", hasher.finish());
        // The last line of a run that was killed may be half a row, and those of other programs say
        // nothing about these.
        let rows: Vec<Row> = csv::Reader::from_path(path).map_or_else(
            |_| vec![],
            |mut reader| {
                let rows = reader.deserialize::<Row>().map_while(Result::ok);
                rows.filter(|row| row.programs == programs).collect()
            },
        );
        let known = rows.iter().map(|row| (row.number, row.outcome)).collect();
        let mut file = csv::Writer::from_path(path).with_context(told)?;
        for row in rows {
            file.serialize(row).with_context(told)?;
        }
        file.flush().with_context(told)?;
        Ok(Self {
            programs,
            known,
            file: Mutex::new(file),
        })
    }

    pub(super) fn known(&self, number: usize) -> Option<Outcome> {
        self.known.get(&number).copied()
    }

    /// Adds a result.
    ///
    /// # Errors
    /// An error if the file cannot be written.
    pub(super) fn add(
        &self,
        number: usize,
        mutant: &Mutant,
        outcome: Outcome,
        time: Duration,
        test: Option<&Test>,
    ) -> Result<()> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.serialize(Row {
            programs: self.programs.clone(),
            number,
            outcome,
            seconds: time.as_secs_f64(),
            mutant: mutant.to_string(),
            test: test.map(|test| test.name.clone()).unwrap_or_default(),
        })?;
        file.flush().context("results of mutants")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mutants::mutant::{Genre, Place, Span};

    #[test]
    fn interrupted_run_goes_on_and_results_of_other_programs_are_forgotten() {
        let folder = std::env::temp_dir().join(format!("fmc-results-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let [path, program] = ["results.csv", "program"].map(|name| folder.join(name));
        fs::write(&program, "first").unwrap();
        let programs = [program.clone()];
        let place = Place { line: 1, column: 1 };
        let mutant = Mutant {
            file: "a.rs".to_owned(),
            genre: Genre::FnValue,
            span: Span {
                start: place,
                end: place,
            },
            replacement: "true".to_owned(),
            change: "replace f with \"true\", at once".to_owned(),
        };
        let results = Results::open(&path, &programs).unwrap();
        assert_eq!(results.known(3), None);
        for (number, outcome) in [(3, Outcome::Killed), (4, Outcome::Survived)] {
            results
                .add(number, &mutant, outcome, Duration::from_millis(20), None)
                .unwrap();
        }
        // The run is killed while it writes.
        let written = fs::read_to_string(&path).unwrap();
        let half = written.lines().nth(1).unwrap().split_at(20).0;
        fs::write(&path, format!("{written}{half}")).unwrap();
        let results = Results::open(&path, &programs).unwrap();
        assert_eq!(
            [2, 3, 4].map(|number| results.known(number)),
            [None, Some(Outcome::Killed), Some(Outcome::Survived)]
        );
        results
            .add(5, &mutant, Outcome::TimedOut, Duration::ZERO, None)
            .unwrap();
        let results = Results::open(&path, &programs).unwrap();
        assert_eq!(results.known(5), Some(Outcome::TimedOut));
        fs::write(&program, "second").unwrap();
        assert_eq!(Results::open(&path, &programs).unwrap().known(3), None);
        fs::remove_dir_all(&folder).unwrap();
    }
}
