//! LLVM's tools: its disassembler, and its model of a processor, by which compilers schedule.

use std::{
    env, fs,
    ops::Range,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};
use serde::Deserialize;
use xshell::{Shell, cmd};

use crate::{
    NOT_CHECKED,
    tools::{Tool, Toolbox},
};

/// First version whose models were tried; 14 has none for the Cortex-M55.
const OLDEST: u32 = 19;

/// Number of modelled rounds of a loop, so large that the start until full speed is negligible.
const ROUNDS: u32 = 500;

/// Both tools, in one version.
#[derive(Debug)]
pub(super) struct Llvm<'a> {
    shell: &'a Shell,
    directory: PathBuf,
    /// End of the tools' names: empty, or `-19`.
    suffix: String,
}

/// Part of the model's report that is used.
#[derive(Debug, Deserialize)]
struct Report {
    #[serde(rename = "CodeRegions")]
    regions: Vec<Region>,
}

#[derive(Debug, Deserialize)]
struct Region {
    #[serde(rename = "SummaryView")]
    summary: Summary,
}

#[derive(Debug, Deserialize)]
struct Summary {
    #[serde(rename = "TotalCycles")]
    cycles: u32,
}

impl<'a> Llvm<'a> {
    /// Finds the tools on the search path or fetches them; if they are not available, prints that
    /// no cycles are modelled.
    pub(super) fn set_up(shell: &'a Shell, toolbox: &Toolbox<'_>) -> Option<Self> {
        let found = env::var_os("PATH").and_then(|path| Self::find(shell, env::split_paths(&path)));
        found.or_else(|| match toolbox.provide(Tool::Llvm) {
            Ok(tool) => Self::find(shell, [tool.bin()]),
            Err(missing) => {
                eprintln!("{NOT_CHECKED}modelled cycles: {missing}");
                None
            }
        })
    }

    /// Finds the newest tools in these directories that are not too old.
    fn find(shell: &'a Shell, directories: impl IntoIterator<Item = PathBuf>) -> Option<Self> {
        let tools = directories.into_iter().flat_map(|directory| {
            let names = fs::read_dir(&directory).into_iter().flatten().flatten();
            let names = names.filter_map(|entry| entry.file_name().into_string().ok());
            let suffixes =
                names.filter_map(|name| name.strip_prefix("llvm-mca").map(str::to_owned));
            let tools = suffixes.map(|suffix| Self {
                shell,
                directory: directory.clone(),
                suffix,
            });
            tools.collect::<Vec<_>>()
        });
        let usable = tools.filter(|tools| tools.program("llvm-objdump").is_file());
        let numbered = usable.filter_map(|tools| {
            let major = major(&tools.number().ok()?)?;
            (major >= OLDEST).then_some((major, tools))
        });
        numbered
            .max_by_key(|(major, _)| *major)
            .map(|(_, tools)| tools)
    }

    fn program(&self, name: &str) -> PathBuf {
        self.directory.join(format!("{name}{}", self.suffix))
    }

    /// Returns name and number of the model.
    ///
    /// # Errors
    /// An error if the tool does not answer.
    pub(super) fn version(&self) -> Result<String> {
        Ok(format!("llvm-mca {}", self.number()?))
    }

    fn number(&self) -> Result<String> {
        let mca = self.program("llvm-mca");
        let text = cmd!(self.shell, "{mca} --version").quiet().read()?;
        let number = text
            .split_once("version ")
            .and_then(|(_, number)| number.split_whitespace().next());
        number
            .map(str::to_owned)
            .context("llvm-mca --version names none")
    }

    /// Disassembles a function; each line has address, colon, mnemonic and operands.
    ///
    /// # Errors
    /// An error if the tool fails.
    pub(super) fn disassembly(&self, image: &Path, addresses: Range<u64>) -> Result<String> {
        let objdump = self.program("llvm-objdump");
        let start = format!("--start-address={}", addresses.start);
        let stop = format!("--stop-address={}", addresses.end);
        let text = cmd!(
            self.shell,
            "{objdump} --disassemble --no-show-raw-insn --mattr=+mve.fp {start} {stop} {image}"
        );
        text.quiet()
            .read()
            .with_context(|| format!("disassembly of {}", image.display()))
    }

    /// Returns the cycles that a processor takes for one round of a loop.
    ///
    /// # Errors
    /// An error if the tool has no such processor, or does not know an instruction.
    pub(super) fn cycles(&self, triple: &str, processor: &str, round: &str) -> Result<f64> {
        let mca = self.program("llvm-mca");
        let rounds = ROUNDS.to_string();
        let text = cmd!(
            self.shell,
            "{mca} --json -mtriple={triple} -mcpu={processor} -iterations={rounds}"
        )
        .quiet()
        .ignore_stderr()
        .stdin(round)
        .read()
        .with_context(|| format!("model of {processor}"))?;
        let report: Report = serde_json::from_str(&text).context("report of llvm-mca")?;
        let region = report
            .regions
            .first()
            .context("llvm-mca modelled nothing")?;
        Ok(f64::from(region.summary.cycles) / f64::from(ROUNDS))
    }
}

/// Returns the first number of a version.
fn major(number: &str) -> Option<u32> {
    number.split('.').next()?.parse().ok()
}
