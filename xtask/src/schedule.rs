//! Order of the steps of `test`: two lanes side by side, one for the PC and one for the target,
//! because a compiler that works on one large crate leaves cores idle. Each step is a separate
//! process with a separate log, so that the output of the lanes does not mix.

use std::{
    collections::BTreeSet,
    env,
    fs::{self, File},
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
    sync::{Mutex, PoisonError},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result};
use clap::ValueEnum as _;

use crate::{
    CHECK_FAILED, NOT_CHECKED, NOT_STARTED,
    checks::{self, Step},
    equipment::{Equipment, Need},
    workspace::Workspace,
};

/// Lanes of steps. The target's ends with the steps that use programs of the host.
const LANES: [&[Step]; 2] = [
    &[
        Step::Format,
        Step::Supply,
        Step::HostLints,
        Step::HostTests,
        Step::Verify,
        Step::Mutants,
        Step::Rounding,
        Step::Exchange,
        Step::Python,
        Step::Web,
        Step::Docs,
        Step::Site,
        Step::HilLints,
    ],
    &[
        Step::TargetLints,
        Step::TargetBuild,
        Step::NoPanic,
        Step::Overflow,
        Step::FirmwareLints,
        Step::FirmwareNoPanic,
        Step::Board,
        Step::C,
        Step::Firmware,
        Step::BoardFlight,
        Step::Skips,
        Step::Costs,
        Step::Campaign,
    ],
];

/// Outcome of a step.
#[derive(Clone, Debug, PartialEq)]
enum Outcome {
    Passed,
    Failed,
    /// Not run, with what it lacked.
    NotRun(String),
}

/// State that the lanes share.
#[derive(Debug)]
struct Run {
    /// Copy of this program, because cargo may replace the original while it builds.
    program: PathBuf,
    logs: PathBuf,
    ended: Mutex<Ended>,
}

/// Steps that have ended.
#[derive(Debug, Default)]
struct Ended {
    /// Steps in the order in which they ended.
    steps: Vec<(Step, Outcome)>,
    /// Checks that steps left out although they passed.
    left_out: BTreeSet<String>,
}

/// Runs all steps whose needs are met.
///
/// If one fails, those in progress are completed and no other is started.
///
/// # Errors
/// An error if the steps cannot be started.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    let start = Instant::now();
    let logs = workspace.target_dir.join("steps");
    let _lock = Workspace::lock(&logs, "runs the steps")?;
    let program = logs.join(format!("xtask{}", env::consts::EXE_SUFFIX));
    let this = env::current_exe().context("path of xtask")?;
    fs::copy(&this, &program).with_context(|| program.display().to_string())?;

    // The set-up comes before the lanes, so that shared tools are fetched once and missing ones are
    // reported at the beginning.
    let needs = [Need::Compiler, Need::Clippy, Need::Qemu, Need::Gappa];
    let equipment = Equipment::for_needs(workspace, &needs);
    let lacks: Vec<Option<String>> = Step::value_variants()
        .iter()
        .map(|step| equipment.lack(step.needs()))
        .collect();
    let lack = |step: Step| {
        let index = Step::value_variants().iter().position(|one| *one == step);
        lacks.get(index?)?.clone()
    };
    for (step, lack) in Step::value_variants().iter().zip(&lacks) {
        if let Some(lack) = lack {
            eprintln!("xtask: step {} cannot be run: {lack}", step.name());
        }
    }

    let run = Run {
        program,
        logs,
        ended: Mutex::default(),
    };
    thread::scope(|scope| {
        for lane in LANES {
            scope.spawn(|| run.lane(lane, &lack));
        }
    });
    let ended = run
        .ended
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    Ok(ExitCode::from(verdict(&ended, start.elapsed())))
}

impl Run {
    fn lane(&self, steps: &[Step], lack: &(impl Fn(Step) -> Option<String> + Sync)) {
        for &step in steps {
            if self.has_failed() {
                return;
            }
            let outcome = match lack(step) {
                Some(lack) => Outcome::NotRun(lack),
                None => self.step(step),
            };
            self.with_ended(|ended| ended.steps.push((step, outcome)));
        }
    }

    /// Runs a step and shows its log when it has ended.
    fn step(&self, step: Step) -> Outcome {
        let name = step.name();
        let start = Instant::now();
        let log = self.logs.join(format!("{name}.log"));
        eprintln!("[{name}] {} ...", step.title());
        let outcome = self.process(&name, &log).unwrap_or_else(|error| {
            eprintln!("xtask: step {name}: {error:#}");
            Outcome::Failed
        });
        let seconds = start.elapsed().as_secs_f64();
        // The log of one step is shown at a time.
        self.with_ended(|ended| {
            let count = ended.steps.len() + 1;
            let all = Step::value_variants().len();
            let text = fs::read(&log).unwrap_or_default();
            let lines = String::from_utf8_lossy(&text);
            let left_out = lines
                .lines()
                .filter_map(|line| line.strip_prefix(NOT_CHECKED));
            ended.left_out.extend(left_out.map(str::to_owned));
            let word = match outcome {
                Outcome::Passed => "passed",
                Outcome::Failed => "FAILED",
                Outcome::NotRun(_) => "was not run",
            };
            let mut stderr = std::io::stderr().lock();
            // A failure to write to the terminal does not end the steps.
            let _ = writeln!(stderr, "\n[{count}/{all}] {name}: {}", step.title());
            let _ = stderr.write_all(&text);
            let _ = writeln!(stderr, "[{count}/{all}] {name} {word} in {seconds:.1} s");
        });
        outcome
    }

    /// Runs the step's process and returns its outcome.
    fn process(&self, name: &str, log: &Path) -> Result<Outcome> {
        let file = File::create(log).with_context(|| log.display().to_string())?;
        let status = Command::new(&self.program)
            .args(["test", "--among-others", "--only", name])
            .stdin(Stdio::null())
            .stdout(file.try_clone()?)
            .stderr(file)
            .status()
            .with_context(|| self.program.display().to_string())?;
        Ok(match status.code() {
            Some(0) => Outcome::Passed,
            Some(code) if code == i32::from(NOT_STARTED) => {
                Outcome::NotRun(format!("{} says why", log.display()))
            }
            _ => Outcome::Failed,
        })
    }

    fn has_failed(&self) -> bool {
        self.with_ended(|ended| {
            let mut steps = ended.steps.iter();
            steps.any(|(_, outcome)| *outcome == Outcome::Failed)
        })
    }

    fn with_ended<T>(&self, act: impl FnOnce(&mut Ended) -> T) -> T {
        act(&mut self.ended.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Prints the last lines (what failed, was not run or was left out, or that all passed) and returns
/// the exit code.
fn verdict(ended: &Ended, time: Duration) -> u8 {
    let seconds = time.as_secs_f64();
    let all = Step::value_variants();
    let mut failed = false;
    let mut passed = 0;
    for step in all {
        let outcome = ended.steps.iter().find(|(one, _)| one == step);
        match outcome.map(|(_, outcome)| outcome) {
            Some(Outcome::Passed) => passed += 1,
            Some(Outcome::Failed) => {
                failed = true;
                eprintln!("xtask: {}", checks::failure(*step));
            }
            Some(Outcome::NotRun(lack)) => {
                eprintln!("xtask: step {} was not run: {lack}", step.name());
            }
            None => eprintln!("xtask: step {} was not begun", step.name()),
        }
    }
    for left_out in &ended.left_out {
        eprintln!("{NOT_CHECKED}{left_out}");
    }
    let count = all.len();
    if passed == count {
        println!("xtask test: all {count} steps passed in {seconds:.1} s");
        return 0;
    }
    eprintln!("xtask test: {passed} of {count} steps passed in {seconds:.1} s");
    if failed { CHECK_FAILED } else { NOT_STARTED }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_is_in_one_lane() {
        let mut steps: Vec<_> = LANES.concat().iter().map(|step| step.name()).collect();
        let mut all: Vec<_> = Step::value_variants()
            .iter()
            .map(|step| step.name())
            .collect();
        steps.sort();
        all.sort();
        assert_eq!(steps, all);
    }

    #[test]
    fn run_passes_only_where_every_step_has_passed() {
        let code = |steps: &[(Step, Outcome)]| {
            let ended = Ended {
                steps: steps.to_vec(),
                left_out: BTreeSet::new(),
            };
            verdict(&ended, Duration::ZERO)
        };
        let mut all: Vec<_> = Step::value_variants()
            .iter()
            .map(|step| (*step, Outcome::Passed))
            .collect();
        assert_eq!(code(&all), 0);
        assert_eq!(code(&all[1..]), NOT_STARTED);
        assert_eq!(code(&[]), NOT_STARTED);
        all[3].1 = Outcome::NotRun("no QEMU".to_owned());
        assert_eq!(code(&all), NOT_STARTED);
        all[4].1 = Outcome::Failed;
        assert_eq!(code(&all), CHECK_FAILED);
    }
}
