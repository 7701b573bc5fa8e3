//! Runs of the tests, for one mutant or for none.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering::Relaxed},
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result, ensure};
use serde::{Deserialize, Serialize};
use wait_timeout::ChildExt as _;

/// Longest time of a test without a mutant, s.
const LONGEST_S: u64 = 300;
/// A test that needs this many times its time, and [`PATIENCE`] more, does not end.
const SLOWNESS: u32 = 10;
const PATIENCE: Duration = Duration::from_secs(3);
/// Tests that run in one process at first: so long do they take together at most.
const FIRST_PART: Duration = Duration::from_millis(100);
/// Memory that a process may ask for, KiB.
const MEMORY_KIB: u32 = 4_000_000;

/// A test, and what it does without a mutant.
#[derive(Debug)]
pub(super) struct Test {
    program: PathBuf,
    pub(super) name: String,
    pub(super) duration: Duration,
    /// One byte for each mutant: one for those that it reaches.
    reached: Vec<u8>,
}

/// Outcome of a mutant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) enum Outcome {
    /// A test fails.
    Killed,
    /// A test does not end.
    TimedOut,
    /// All tests pass that reach it.
    Survived,
    /// No test reaches it.
    NotReached,
}

/// Tests that pass without a mutant.
#[derive(Debug)]
pub(super) struct Tests {
    tree: PathBuf,
    all: Vec<Test>,
    /// Numbers of the tests that have killed mutants of a file, the last one first.
    killers: Mutex<BTreeMap<String, Vec<usize>>>,
}

impl Tests {
    /// Runs every test of the programs alone, without a mutant. Tests of the texts of the project
    /// are left out: they read the sources in which the mutants are.
    ///
    /// # Errors
    /// An error if a program cannot be run or if a test fails.
    pub(super) fn run_without_mutant(
        tree: &Path,
        programs: &[PathBuf],
        jobs: usize,
    ) -> Result<Self> {
        let mut names = vec![];
        for program in programs {
            let list = command(tree, program)
                .arg("--list")
                .stdout(Stdio::piped())
                .output()?;
            let list = String::from_utf8_lossy(&list.stdout).into_owned();
            let tests = list.lines().filter_map(|line| line.strip_suffix(": test"));
            let tests = tests.filter(|name| !name.starts_with("conventions::"));
            names.extend(tests.map(|name| (program.clone(), name.to_owned())));
        }
        ensure!(!names.is_empty(), "the programs have no test");
        let all = in_parallel(jobs, &names, |at, (program, name)| {
            let record = tree.with_file_name(format!("reached-{at}"));
            let _ = fs::remove_file(&record);
            let start = Instant::now();
            let mut run = command(tree, program);
            run.arg("--exact").arg(name).env("FMC_MUTANT", "record");
            run.env("FMC_MUTANTS_REACHED", &record);
            let passed = ended(run.spawn()?, Duration::from_secs(LONGEST_S))?;
            ensure!(passed == Some(true), "{name} fails without a mutant");
            let reached = fs::read(&record).with_context(|| record.display().to_string())?;
            let _ = fs::remove_file(&record);
            Ok(Test {
                program: program.clone(),
                name: name.clone(),
                duration: start.elapsed(),
                reached,
            })
        });
        let mut all = all.into_iter().collect::<Result<Vec<_>>>()?;
        all.sort_by_key(|test| test.duration);
        Ok(Self {
            tree: tree.to_owned(),
            all,
            killers: Mutex::default(),
        })
    }

    /// Returns the number of tests, and the time that they take one after the other.
    pub(super) fn effort(&self) -> (usize, Duration) {
        (
            self.all.len(),
            self.all.iter().map(|test| test.duration).sum(),
        )
    }

    /// Runs the tests that reach a mutant until one fails; returns it.
    ///
    /// # Errors
    /// An error if a program cannot be run.
    pub(super) fn run(&self, file: &str, number: usize) -> Result<(Outcome, Option<&Test>)> {
        let reaches = |test: &Test| test.reached.get(number).is_some_and(|reached| *reached > 0);
        let first = self.killers(file).into_iter().take(5);
        let rest = 0..self.all.len();
        let mut order: Vec<usize> = vec![];
        for at in first.chain(rest) {
            if self.all.get(at).is_some_and(reaches) && !order.contains(&at) {
                order.push(at);
            }
        }
        if order.is_empty() {
            return Ok((Outcome::NotReached, None));
        }
        let mut part = FIRST_PART;
        let mut order = order.into_iter().peekable();
        while order.peek().is_some() {
            let mut group: Vec<usize> = vec![];
            let mut time = Duration::ZERO;
            while let Some(at) = order.peek()
                && let Some(test) = self.all.get(*at)
                && (group.is_empty() || time + test.duration <= part)
                && group.first().is_none_or(|first| {
                    self.all
                        .get(*first)
                        .is_some_and(|first| first.program == test.program)
                })
            {
                time += test.duration;
                group.extend(order.next());
            }
            part *= 2;
            if let Some((outcome, killer)) = self.run_group(&group, number, time)? {
                self.remember(file, killer);
                return Ok((outcome, self.all.get(killer)));
            }
        }
        Ok((Outcome::Survived, None))
    }

    /// Runs tests in one process; returns that which failed.
    fn run_group(
        &self,
        group: &[usize],
        number: usize,
        time: Duration,
    ) -> Result<Option<(Outcome, usize)>> {
        let Some((first, test)) = group.first().and_then(|at| Some((*at, self.all.get(*at)?)))
        else {
            return Ok(None);
        };
        let names = group.iter().filter_map(|at| self.all.get(*at));
        let mut run = command(&self.tree, &test.program);
        run.args(["--exact", "-Z", "unstable-options", "--fail-fast"]);
        run.args(names.map(|test| &test.name));
        run.env("FMC_MUTANT", number.to_string());
        let limit = time * SLOWNESS + PATIENCE;
        // With one failure of several the test is not known; the next mutant begins with the first.
        Ok(match ended(run.spawn()?, limit)? {
            None => Some((Outcome::TimedOut, first)),
            Some(true) => None,
            Some(false) => Some((Outcome::Killed, first)),
        })
    }

    fn killers(&self, file: &str) -> Vec<usize> {
        let killers = self.killers.lock().unwrap_or_else(PoisonError::into_inner);
        killers.get(file).cloned().unwrap_or_default()
    }

    fn remember(&self, file: &str, killer: usize) {
        let mut killers = self.killers.lock().unwrap_or_else(PoisonError::into_inner);
        let of_file = killers.entry(file.to_owned()).or_default();
        of_file.retain(|at| *at != killer);
        of_file.insert(0, killer);
    }
}

/// Returns a run of a test program with the settings of the project's tests.
fn command(tree: &Path, program: &Path) -> Command {
    let mut command = Command::new("sh");
    command
        .arg("-c")
        .arg(format!("ulimit -v {MEMORY_KIB}; exec \"$@\""))
        .arg("sh")
        .arg(program)
        .arg("--test-threads=1")
        .current_dir(tree)
        .env("CARGO_MANIFEST_DIR", tree)
        .env("PROPTEST_RNG_SEED", "1")
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
        .env("RUST_BACKTRACE", "0")
        .env("RUSTC_BOOTSTRAP", "1")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command
}

/// Waits for the end of a process; returns whether it succeeded, or nothing if it had to be ended.
fn ended(mut child: Child, limit: Duration) -> Result<Option<bool>> {
    if let Some(status) = child.wait_timeout(limit)? {
        return Ok(Some(status.success()));
    }
    child.kill()?;
    child.wait()?;
    Ok(None)
}

/// Does a task for every item, several at a time; returns the results in the order of the items.
pub(super) fn in_parallel<T: Sync, R: Send>(
    jobs: usize,
    items: &[T],
    task: impl Fn(usize, &T) -> R + Sync,
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new(BTreeMap::new());
    thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(|| {
                loop {
                    let at = next.fetch_add(1, Relaxed);
                    let Some(item) = items.get(at) else { break };
                    let result = task(at, item);
                    let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
                    done.insert(at, result);
                }
            });
        }
    });
    let done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    done.into_values().collect()
}
