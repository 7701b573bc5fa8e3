//! The order of the steps of `test`: two lanes side by side, one for the PC and one for the target, since a compiler
//! that works on one large crate leaves cores waiting. A step is a process of its own with a log of its own, so that
//! what the lanes say does not mix.

use std::{
    env,
    fs::{self, File},
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, ExitCode, Stdio},
    sync::{Mutex, PoisonError},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result, bail};
use clap::ValueEnum as _;

use crate::{
    NOT_STARTED,
    checks::{self, Step},
    equipment::{Equipment, Need},
    workspace::Workspace,
};

/// The lanes. The target's ends with the steps that use programs of the host's.
const LANES: [&[Step]; 2] = [
    &[
        Step::Format,
        Step::HostLints,
        Step::HostTests,
        Step::Verify,
        Step::Docs,
        Step::HilLints,
    ],
    &[
        Step::TargetLints,
        Step::TargetBuild,
        Step::NoPanic,
        Step::FirmwareLints,
        Step::FirmwareNoPanic,
        Step::Board,
        Step::Firmware,
        Step::Costs,
    ],
];

/// How a step went.
#[derive(Clone, Debug, PartialEq)]
enum Outcome {
    Passed,
    Failed,
    /// With what it lacked.
    NotRun(String),
}

/// What the lanes share.
#[derive(Debug)]
struct Run {
    /// A copy of this program: cargo may replace the original while it builds.
    program: PathBuf,
    logs: PathBuf,
    /// In the order in which they ended.
    ended: Mutex<Vec<(Step, Outcome)>>,
}

/// Runs all steps for which there is what they need.
///
/// # Errors
/// Where one fails; those that are under way are ended first, no other is begun.
pub(crate) fn run(workspace: &Workspace) -> Result<ExitCode> {
    let start = Instant::now();
    let logs = workspace.target_dir.join("steps");
    fs::create_dir_all(&logs).with_context(|| logs.display().to_string())?;
    let program = logs.join(format!("xtask{}", env::consts::EXE_SUFFIX));
    let this = env::current_exe().context("path of xtask")?;
    // A new file: the old one may still run in another terminal.
    let _ = fs::remove_file(&program);
    fs::copy(&this, &program).with_context(|| program.display().to_string())?;

    // Here, before the lanes: tools are fetched once, and what cannot be had is said at the beginning.
    let needs = [Need::Compiler, Need::Clippy, Need::Qemu];
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
        ended: Mutex::new(Vec::new()),
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
    verdict(&ended, start.elapsed())
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
            self.with_ended(|ended| ended.push((step, outcome)));
        }
    }

    /// Runs a step and shows its log when it has ended.
    fn step(&self, step: Step) -> Outcome {
        let name = step.name();
        let start = Instant::now();
        let log = self.logs.join(format!("{name}.log"));
        eprintln!("[{name}] {} ...", step.title());
        let passed = self.process(&name, &log);
        let seconds = start.elapsed().as_secs_f64();
        // One step's log at a time.
        self.with_ended(|ended| {
            let count = ended.len() + 1;
            let all = Step::value_variants().len();
            let mut stderr = std::io::stderr().lock();
            let text = fs::read(&log).unwrap_or_default();
            let _ = writeln!(stderr, "\n[{count}/{all}] {name}: {}", step.title());
            let _ = stderr.write_all(&text);
            let (outcome, word) = match &passed {
                Ok(true) => (Outcome::Passed, "passed".to_owned()),
                Ok(false) => (Outcome::Failed, "FAILED".to_owned()),
                Err(error) => (Outcome::Failed, format!("FAILED ({error:#})")),
            };
            let _ = writeln!(stderr, "[{count}/{all}] {name} {word} in {seconds:.1} s");
            outcome
        })
    }

    /// Whether the step's process succeeds.
    fn process(&self, name: &str, log: &Path) -> Result<bool> {
        let file = File::create(log).with_context(|| log.display().to_string())?;
        let status = Command::new(&self.program)
            .args(["test", "--among-others", "--only", name])
            .stdin(Stdio::null())
            .stdout(file.try_clone()?)
            .stderr(file)
            .status()
            .with_context(|| self.program.display().to_string())?;
        Ok(status.success())
    }

    fn has_failed(&self) -> bool {
        self.with_ended(|ended| ended.iter().any(|(_, outcome)| *outcome == Outcome::Failed))
    }

    fn with_ended<T>(&self, act: impl FnOnce(&mut Vec<(Step, Outcome)>) -> T) -> T {
        act(&mut self.ended.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The last lines: what failed, or was not run, or that all is well.
fn verdict(ended: &[(Step, Outcome)], time: Duration) -> Result<ExitCode> {
    let failed: Vec<_> = ended
        .iter()
        .filter(|(_, outcome)| *outcome == Outcome::Failed)
        .map(|(step, _)| checks::failure(*step))
        .collect();
    if !failed.is_empty() {
        bail!("{}", failed.join("\nxtask: "));
    }
    let seconds = time.as_secs_f64();
    let not_run: Vec<_> = ended
        .iter()
        .filter_map(|(step, outcome)| match outcome {
            Outcome::NotRun(lack) => Some((step.name(), lack)),
            Outcome::Passed | Outcome::Failed => None,
        })
        .collect();
    let all = Step::value_variants().len();
    if not_run.is_empty() && ended.len() == all {
        println!("xtask test: all {all} steps passed in {seconds:.1} s");
        return Ok(ExitCode::SUCCESS);
    }
    for (name, lack) in &not_run {
        eprintln!("xtask: step {name} was not run: {lack}");
    }
    eprintln!(
        "xtask test: {} of {all} steps passed in {seconds:.1} s, {} were not run",
        ended.len() - not_run.len(),
        all + not_run.len() - ended.len()
    );
    Ok(ExitCode::from(NOT_STARTED))
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
        let code = |ended: &[(Step, Outcome)]| verdict(ended, Duration::ZERO);
        let success = format!("{:?}", ExitCode::SUCCESS);
        let mut all: Vec<_> = Step::value_variants()
            .iter()
            .map(|step| (*step, Outcome::Passed))
            .collect();
        assert_eq!(format!("{:?}", code(&all).unwrap()), success);
        assert_ne!(format!("{:?}", code(&all[1..]).unwrap()), success);
        assert_ne!(format!("{:?}", code(&[]).unwrap()), success);
        all[3].1 = Outcome::NotRun("no QEMU".to_owned());
        assert_ne!(format!("{:?}", code(&all).unwrap()), success);
        all[4].1 = Outcome::Failed;
        let text = code(&all).unwrap_err().to_string();
        assert!(text.contains("--only host-tests"), "{text}");
    }
}
