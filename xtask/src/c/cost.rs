//! Cost of the library: size, variables, stack, and instructions of a call.

use std::{fmt::Write as _, fs, path::Path, time::Duration};

use anyhow::{Context as _, Result, ensure};
use object::{File, Object as _, ObjectSection as _, SectionKind};

use super::{compiler::Compiler, library::Library, program::Programs};
use crate::{bench::Footprint, emulator::Emulator, target::Target};

/// Row of the table of footprints.
const NAME: &str = "c-library";

/// Most bytes of code and constants of the least program.
const MOST_BYTES: u64 = 20_000;

/// Most instructions of a call of 16 points over the bare correction.
const MOST_OVER_BARE: u64 = 60;

/// Bytes by which the guide may state more than half as much again.
const SPARE_BYTES: u64 = 100;

/// Longest time of the counting.
const LIMIT: Duration = Duration::from_mins(5);

/// Cost of the library on a Cortex-M4F.
#[derive(Debug)]
pub(super) struct Cost {
    pub(super) footprint: Footprint,
    /// Instructions of `fmc_correct` over `correct_slice`.
    pub(super) over_bare: u64,
    /// Functions with the bytes of their stack.
    stacks: Vec<(String, u64)>,
}

impl Cost {
    /// Returns the table of stacks as CSV.
    pub(super) fn stacks(&self) -> String {
        let mut text = "function,stack_bytes\n".to_owned();
        for (function, bytes) in &self.stacks {
            // Text takes everything.
            let _ = writeln!(text, "{function},{bytes}");
        }
        text
    }

    /// Checks that the guide's table has every function, with no fewer bytes than are used and not
    /// many more.
    ///
    /// # Errors
    /// An error that names the function.
    pub(super) fn is_documented(&self, guide: &Path) -> Result<()> {
        let text = fs::read_to_string(guide).with_context(|| guide.display().to_string())?;
        for (function, used) in &self.stacks {
            let begin = format!("| `{function}` | ");
            let row = text.lines().find_map(|line| line.strip_prefix(&begin));
            let stated = row.and_then(|row| row.trim_end_matches(" |").parse::<u64>().ok());
            let stated = stated.with_context(|| {
                format!(
                    "{} has no row of {function}, which uses {used} bytes",
                    guide.display()
                )
            })?;
            ensure!(
                (*used..=used * 3 / 2 + SPARE_BYTES).contains(&stated),
                "{function} uses {used} bytes of stack, and {} says {stated}",
                guide.display()
            );
        }
        Ok(())
    }

    /// Checks the limits that no compiler may exceed.
    ///
    /// # Errors
    /// An error if the least program is too large, there is a variable, or a call takes too many
    /// instructions.
    pub(super) fn is_within_limits(&self) -> Result<()> {
        let bytes = self.footprint.flash_bytes;
        ensure!(
            bytes <= MOST_BYTES,
            "the least program has {bytes} bytes of code and constants, and {MOST_BYTES} are allowed"
        );
        let variables = self.footprint.static_ram_bytes;
        ensure!(
            variables == 0,
            "the library has {variables} bytes of variables"
        );
        let over_bare = self.over_bare;
        ensure!(
            over_bare <= MOST_OVER_BARE,
            "a call takes {over_bare} instructions over correct_slice, and {MOST_OVER_BARE} are allowed"
        );
        Ok(())
    }
}

/// Measures the library.
///
/// # Errors
/// An error if a program does not link or does not run.
pub(super) fn measure(
    programs: &Programs<'_>,
    compiler: &Compiler<'_>,
    control: &Library,
    emulator: &Emulator,
    target: &Target<'_>,
) -> Result<Cost> {
    let image = programs.link(compiler, control, "tests/cost")?;
    let machine = control.board().machine;
    let printed = emulator.run(machine, &["-icount", "shift=0"], &image, LIMIT)?;
    let mut stacks = Vec::new();
    let mut over_bare = None;
    for line in printed.lines() {
        let (name, amount) = line.split_once(',').context(printed.clone())?;
        let amount: u64 = amount.parse().context(printed.clone())?;
        if let Some(function) = name.strip_prefix("stack ") {
            stacks.push((function.to_owned(), amount));
        } else if name == "instructions over correct_slice" {
            over_bare = Some(amount);
        }
    }
    let in_frame = [
        "fmc_camera_init",
        "fmc_frame_init",
        "fmc_correct",
        "fmc_distort",
    ];
    let deepest = stacks
        .iter()
        .filter(|(function, _)| in_frame.contains(&function.as_str()))
        .map(|(_, bytes)| *bytes);
    let stack_used_bytes = deepest.max().context("no stack was measured")?;
    let size = programs.link(compiler, control, "tests/size")?;
    let (flash_bytes, static_ram_bytes) = sizes(&size)?;
    Ok(Cost {
        footprint: Footprint {
            image: NAME.to_owned(),
            flash_bytes,
            static_ram_bytes,
            stack_used_bytes,
            stack_bound_bytes: None,
            compiler: target.compiler()?,
        },
        over_bare: over_bare.context("no call was counted")?,
        stacks,
    })
}

/// Variables of the program itself.
const OF_PROGRAM: [&str; 6] = ["record", "exposure", "camera", "frame", "points", "handle"];

/// Returns the bytes of code and constants of the least program, and those of the variables that
/// are not the program's own.
fn sizes(image: &Path) -> Result<(u64, u64)> {
    use object::ObjectSymbol as _;
    let bytes = fs::read(image).with_context(|| image.display().to_string())?;
    let file = File::parse(&*bytes).with_context(|| image.display().to_string())?;
    let of = |kinds: &[SectionKind]| -> u64 {
        let sections = file
            .sections()
            .filter(|section| kinds.contains(&section.kind()));
        sections.map(|section| section.size()).sum()
    };
    let flash = of(&[
        SectionKind::Text,
        SectionKind::ReadOnlyData,
        SectionKind::Data,
    ]);
    // The compiler numbers the variables of functions.
    let is_of_program = |name: &str| {
        let name = name.split_once('.').map_or(name, |(name, _)| name);
        OF_PROGRAM.contains(&name)
    };
    let in_ram = |symbol: &object::Symbol<'_, '_>| {
        let kind = symbol.section_index().and_then(|index| {
            let section = file.section_by_index(index).ok()?;
            Some(section.kind())
        });
        matches!(
            kind,
            Some(SectionKind::Data | SectionKind::UninitializedData)
        ) && !symbol.name().is_ok_and(is_of_program)
    };
    let variables = file.symbols().filter(in_ram).map(|symbol| symbol.size());
    Ok((flash, variables.sum()))
}
