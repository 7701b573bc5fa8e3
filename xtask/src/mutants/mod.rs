//! `cargo xtask mutants`: small changes of the library, each of which its own tests should notice.
//!
//! All mutants are in one program, which is one of them by a number in its environment: it is built
//! once, and a mutant is tried in the time of the tests that reach it.

mod decisions;
mod edits;
mod list;
mod mutant;
mod places;
mod program;
mod results;
mod schema;
mod source_text;
mod trial;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
    process::ExitCode,
    thread,
    time::Instant,
};

use anyhow::{Context as _, Result, bail, ensure};

use self::{
    list::{EQUIVALENT, Equivalent, TRIED, Tried},
    mutant::Mutant,
    program::Programs,
    results::Results,
    trial::{Outcome, Tests},
};
use crate::{CHECK_FAILED, NOT_CHECKED, source, workspace::Workspace};

/// Folders whose mutants are tried.
const FOLDERS: [&str; 3] = ["src/geometry", "src/flight", "src/io"];

/// Part of the mutants that is tried: the `index`-th of `of`, from one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shard {
    index: usize,
    of: usize,
}

impl std::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(index, of)| {
            let shard = Self {
                index: index.parse().ok()?,
                of: of.parse().ok()?,
            };
            (1..=shard.of).contains(&shard.index).then_some(shard)
        });
        numbers.ok_or_else(|| format!("{text} is no part such as 1/4: 1 to 4 of 4"))
    }
}

/// Options of a run.
#[derive(Debug)]
pub(crate) struct Options {
    /// Sources from the root; all without any.
    pub(crate) files: Vec<String>,
    pub(crate) shard: Option<Shard>,
    /// True if sources without survivors go into the list.
    pub(crate) update: bool,
}

/// Tries mutants, and compares those that survive with the list.
///
/// # Errors
/// An error if a source is none of the library, if tools are missing, if the tests fail without a
/// mutant, or if files cannot be read or written.
pub(crate) fn run(workspace: &Workspace, options: &Options) -> Result<ExitCode> {
    let files = sources(workspace, &options.files)?;
    let place = workspace.target_dir.join("mutants");
    let _lock = Workspace::lock(&place, "tries mutants")?;
    let mutants = mutants(workspace, &files)?;
    let tree = place.join("tree");
    let programs = program::build(workspace, &tree, &mutants)?;
    let jobs = thread::available_parallelism().map_or(1, usize::from);
    let tests = Tests::run_without_mutant(&tree, &programs.paths, jobs)?;
    let (count, time) = tests.effort();
    workspace.tell(&format!(
        "{count} tests, {:.0} s one by one",
        time.as_secs_f64()
    ));
    let results = Results::open(&place.join("results.csv"), &programs.paths)?;
    let outcomes = outcomes(&mutants, &programs, &tests, &results, options.shard, jobs)?;
    tell(&mutants, &programs, &outcomes);
    ensure!(
        outcomes.values().any(|outcome| *outcome == Outcome::Killed),
        "no mutant is killed: the tests are blind"
    );
    judge(workspace, &mutants, &outcomes, options)
}

/// Tries the mutants of the sources in the list that have changed, and says which are not in it.
///
/// # Errors
/// As [`run`].
pub(crate) fn check(workspace: &Workspace) -> Result<()> {
    let tried: Vec<Tried> = list::read(&workspace.root, TRIED)?;
    let all = sources(workspace, &[])?;
    let listed: BTreeSet<_> = tried.iter().map(|row| &row.file).collect();
    let missing = all.iter().filter(|file| !listed.contains(file)).count();
    if missing > 0 {
        println!(
            "{NOT_CHECKED}mutants of {missing} of {} sources, which are not in {TRIED}",
            all.len()
        );
    }
    let changed = list::changed(&workspace.root, &tried)?;
    if changed.is_empty() {
        println!(
            "{} sources are as they were when their mutants were tried",
            tried.len()
        );
        return Ok(());
    }
    let options = Options {
        files: changed,
        shard: None,
        update: false,
    };
    let outcome = run(workspace, &options)?;
    ensure!(
        outcome == ExitCode::SUCCESS,
        "mutants survive that are not in {EQUIVALENT}"
    );
    Ok(())
}

/// Returns the paths of the sources that are named, or of all, from the root.
fn sources(workspace: &Workspace, named: &[String]) -> Result<Vec<String>> {
    let mut all = vec![];
    for folder in FOLDERS {
        let mut found = vec![];
        program::files(&workspace.root.join(folder), &mut found)?;
        all.extend(found.iter().filter_map(|path| {
            let name = path.strip_prefix(&workspace.root).ok()?;
            let is_source = name.extension().is_some_and(|extension| extension == "rs");
            is_source.then(|| name.display().to_string())
        }));
    }
    all.sort();
    let of_tests = source::modules_of_tests(&workspace.root, &all)?;
    all.retain(|name| !source::is_of_tests(&of_tests, name));
    if named.is_empty() {
        return Ok(all);
    }
    for name in named {
        if !all.contains(name) {
            bail!("{name} is no source below {}", FOLDERS.join(", "));
        }
    }
    Ok(named.to_vec())
}

/// Returns all mutants of sources, in their order.
fn mutants(workspace: &Workspace, files: &[String]) -> Result<Vec<Mutant>> {
    let listed = mutant::list(workspace, files)?;
    let mut mutants = listed.mutants;
    for name in files {
        let text = fs::read_to_string(workspace.root.join(name)).with_context(|| name.clone())?;
        mutants.extend(decisions::conditions(name, &text)?);
    }
    ensure!(!mutants.is_empty(), "{} have no mutant", files.join(", "));
    mutants.sort_by(|a, b| (&a.file, a.span, &a.change).cmp(&(&b.file, b.span, &b.change)));
    workspace.tell(&format!(
        "{} mutants; {} in constants are not tried",
        mutants.len(),
        listed.in_constants
    ));
    Ok(mutants)
}

/// Tries all mutants, or the shard's, for which there is no result yet.
fn outcomes(
    mutants: &[Mutant],
    programs: &Programs,
    tests: &Tests,
    results: &Results,
    shard: Option<Shard>,
    jobs: usize,
) -> Result<BTreeMap<usize, Outcome>> {
    let is_program = |number: &usize| {
        !programs.refused.contains(number) && !programs.without_place.contains(number)
    };
    let is_in_shard =
        |number: &usize| shard.is_none_or(|Shard { index, of }| number % of == index - 1);
    let numbers = (0..mutants.len()).filter(is_program).filter(is_in_shard);
    let tried: Vec<(usize, &Mutant)> = numbers
        .filter_map(|number| Some((number, mutants.get(number)?)))
        .collect();
    let start = Instant::now();
    let outcomes = trial::in_parallel(jobs, &tried, |_, (number, mutant)| {
        if let Some(outcome) = results.known(*number) {
            return Ok((*number, outcome));
        }
        let start = Instant::now();
        let (outcome, killer) = tests.run(&mutant.file, *number)?;
        results.add(*number, mutant, outcome, start.elapsed(), killer)?;
        Ok((*number, outcome))
    });
    let outcomes = outcomes.into_iter().collect::<Result<BTreeMap<_, _>>>()?;
    println!(
        "{} mutants tried in {:.0} s",
        tried.len(),
        start.elapsed().as_secs_f64()
    );
    Ok(outcomes)
}

fn tell(mutants: &[Mutant], programs: &Programs, outcomes: &BTreeMap<usize, Outcome>) {
    let count = |wanted| {
        outcomes
            .values()
            .filter(|outcome| **outcome == wanted)
            .count()
    };
    println!(
        "{} killed, {} not ended, {} survive, {} are reached by no test; {} the compiler refuses, \
        {} have no place beside others",
        count(Outcome::Killed),
        count(Outcome::TimedOut),
        count(Outcome::Survived),
        count(Outcome::NotReached),
        programs.refused.len(),
        programs.without_place.len()
    );
    for number in &programs.without_place {
        if let Some(mutant) = mutants.get(*number) {
            println!("no place: {mutant}");
        }
    }
}

fn judge(
    workspace: &Workspace,
    mutants: &[Mutant],
    outcomes: &BTreeMap<usize, Outcome>,
    options: &Options,
) -> Result<ExitCode> {
    let survivors: Vec<_> = outcomes
        .iter()
        .filter(|(_, outcome)| matches!(outcome, Outcome::Survived | Outcome::NotReached))
        .filter_map(|(number, _)| mutants.get(*number))
        .collect();
    let mut equivalent: Vec<Equivalent> = list::read(&workspace.root, EQUIVALENT)?;
    if options.shard.is_some() {
        // Those of other shards are not known.
        let is_survivor = |row: &Equivalent| {
            survivors
                .iter()
                .any(|mutant| mutant.file == row.file && mutant.change == row.change)
        };
        equivalent.retain(is_survivor);
    }
    let text_of = |file: &str| read(&workspace.root, file);
    let faults = list::faults(mutants, &survivors, &equivalent, text_of);
    if options.update {
        let mut clean = BTreeMap::new();
        let tried = outcomes.keys().filter_map(|number| mutants.get(*number));
        for mutant in tried.filter(|mutant| !faults.contains_key(&mutant.file)) {
            *clean.entry(mutant.file.clone()).or_default() += 1;
        }
        list::update(&workspace.root, &clean)?;
    }
    if faults.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    let texts: Vec<_> = faults.into_values().flatten().collect();
    eprintln!(
        "xtask: {EQUIVALENT} is not what was found:\n{}",
        texts.join("\n")
    );
    Ok(ExitCode::from(CHECK_FAILED))
}

fn read(root: &Path, file: &str) -> String {
    fs::read_to_string(root.join(file)).unwrap_or_default()
}
