//! `cargo xtask bench`: what the camera's work costs on the targets, counted in QEMU.

use std::{fs, path::Path, process::ExitCode};

use anyhow::{Context as _, Result, ensure};
use object::{File, Object as _, ObjectSegment as _};
use serde::Deserialize;
use xshell::cmd;

use crate::{
    cost::{self, Footprint, Instructions},
    firmware::{self, Image},
    load,
    route::{Architecture, Need, QEMU},
    target::{Target, Targets},
    verify,
    workspace::Workspace,
};

/// The committed tables.
const INSTRUCTIONS: &str = "docs/instructions.csv";
const FOOTPRINT: &str = "docs/footprint.csv";

/// A core, and the emulated machine that has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core {
    pub(crate) name: &'static str,
    pub(crate) machine: &'static str,
    pub(crate) architecture: Architecture,
}

/// The cores.
pub(crate) const CORES: [Core; 3] = [
    Core {
        name: "cortex-m4f",
        machine: "mps2-an386",
        architecture: Architecture::Armv7em,
    },
    Core {
        name: "cortex-m7",
        machine: "mps2-an500",
        architecture: Architecture::Armv7em,
    },
    Core {
        name: "cortex-m55",
        machine: "mps3-an547",
        architecture: Architecture::Helium,
    },
];

/// Where the memory of variables begins on every Cortex-M.
const RAM: u64 = 0x2000_0000;

/// A line of the counting program.
#[derive(Debug, Deserialize)]
struct Counted {
    kernel: String,
    unit: String,
    repetitions: f64,
    instructions: f64,
}

/// Prints the instruction counts as CSV and the images' footprint on the error stream; with `update` writes both tables.
///
/// # Errors
/// Where the set-up, a build or QEMU fails.
pub(crate) fn run(workspace: &Workspace, update: bool) -> Result<ExitCode> {
    let targets = Targets::set_up(workspace, Need::ToolchainAndQemu)?;
    let instructions = count(workspace, &targets)?;
    print!("{}", cost::text(&instructions)?);
    for load in load::loads(&instructions) {
        eprintln!("{load}");
    }
    let footprint = vec![footprint(workspace, &targets.armv7em)?];
    eprint!("\n{}", cost::text(&footprint)?);
    if update {
        cost::replace(&workspace.root.join(INSTRUCTIONS), instructions)?;
        cost::replace(&workspace.root.join(FOOTPRINT), footprint)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Compares what is counted with the committed tables.
///
/// # Errors
/// Where something costs more than its table or its limit says.
pub(crate) fn check(workspace: &Workspace, targets: &Targets<'_>) -> Result<()> {
    let instructions = cost::read::<Instructions>(&workspace.root.join(INSTRUCTIONS))?;
    let footprint_table = cost::read::<Footprint>(&workspace.root.join(FOOTPRINT))?;
    let counted = count(workspace, targets)?;
    for (compiler, core) in cost::new_groups(&instructions, &counted) {
        eprintln!(
            "note: {INSTRUCTIONS} has no rows of {core} by {compiler}: only the limits are checked; `cargo xtask bench --update` adds them"
        );
    }
    for load in load::loads(&counted) {
        eprintln!("{load}");
        ensure!(
            load.is_allowed(),
            "{:.0} % must be left at least, and a round must end before the next at a usual clock",
            100.0 * load::LEAST_IDLE
        );
    }
    let mut findings = cost::compare(&instructions, &counted);
    findings.extend(cost::compare(
        &footprint_table,
        &[footprint(workspace, &targets.armv7em)?],
    ));
    let text: Vec<_> = findings
        .iter()
        .map(|finding| format!("\n    {finding}"))
        .collect();
    ensure!(
        findings.is_empty(),
        "costs have changed; if that is right, `cargo xtask bench --update` writes the tables:{}",
        text.concat()
    );
    Ok(())
}

/// Counts on every core that is built for.
fn count(workspace: &Workspace, targets: &Targets<'_>) -> Result<Vec<Instructions>> {
    let _root = workspace.shell.push_dir(&workspace.root);
    let mut rows = Vec::new();
    for Core {
        name: core,
        machine,
        architecture,
    } in CORES
    {
        let Some(target) = targets.of(architecture) else {
            continue;
        };
        let build = target.cargo("build --release -p instruction-count");
        eprintln!("$ {build}");
        build.run()?;
        let image = target.programs().join("instruction-count");
        let compiler = target.compiler()?;
        // One instruction takes one nanosecond of the emulated time.
        let qemu = cmd!(
            workspace.shell,
            "timeout 60 {QEMU} -M {machine} -display none -monitor none -serial none -icount shift=0 -semihosting-config enable=on,target=native -kernel {image}"
        );
        let counted = qemu
            .quiet()
            .read()
            .with_context(|| format!("count on {machine}"))?;
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(counted.as_bytes());
        for line in reader.deserialize() {
            let Counted {
                kernel,
                unit,
                repetitions,
                instructions,
            } = line?;
            rows.push(Instructions {
                core: core.to_owned(),
                kernel,
                count: (100.0 * instructions / repetitions).round() / 100.0,
                unit,
                compiler: compiler.clone(),
            });
        }
    }
    ensure!(!rows.is_empty(), "the counting program printed nothing");
    Ok(rows)
}

/// What the report of `host-sim verify` says of the camera's end of the link.
#[derive(Debug, Deserialize)]
struct Summary {
    link: LinkSummary,
}

#[derive(Debug, Deserialize)]
struct LinkSummary {
    stack_used_bytes: u64,
}

/// Bytes of flash and of static RAM that an image takes.
fn sizes(image: &Path) -> Result<(u64, u64)> {
    let bytes = fs::read(image)?;
    let file = File::parse(&*bytes).with_context(|| format!("{}", image.display()))?;
    // What is writable and not zero at the start is in both: copied from flash to RAM.
    let flash = file.segments().map(|segment| segment.file_range().1).sum();
    let in_ram = file.segments().filter(|segment| segment.address() >= RAM);
    let ram = in_ram.map(|segment| segment.size()).sum();
    Ok((flash, ram))
}

/// Sizes of the flight image, and its stack over a verification of one camera.
fn footprint(workspace: &Workspace, target: &Target<'_>) -> Result<Footprint> {
    let image = firmware::build(workspace, target, Image::Mps2)?;
    let (flash_bytes, static_ram_bytes) = sizes(&image)?;
    let host_sim = verify::tested_host_sim(workspace)?;
    let out = workspace.target_dir.join("bench-verify");
    let camera = workspace.root.join("host-sim/cameras/rc30-5324.toml");
    let host_sim = workspace.shell.cmd(host_sim).quiet();
    host_sim
        .args(["verify", "--device", "qemu", "--camera"])
        .arg(camera)
        .arg("--out")
        .arg(&out)
        .ignore_stdout()
        .run()?;
    let summary = fs::read_to_string(out.join("summary.json"))?;
    let Summary { link } = serde_json::from_str(&summary).context("summary.json of verify")?;
    Ok(Footprint {
        image: Image::Mps2.to_string(),
        flash_bytes,
        static_ram_bytes,
        stack_used_bytes: link.stack_used_bytes,
        compiler: target.compiler()?,
    })
}
