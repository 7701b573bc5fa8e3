//! Programs in C: the same files on this PC and in QEMU, with the same output.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

use anyhow::{Context as _, Result, bail, ensure};

use super::{
    compiler::{Compiler, STRICT, option},
    library::{Board, Library, directory},
};
use crate::{emulator::Emulator, no_panic::PANIC_SYMBOL, workspace::Workspace};

/// Programs, from the directory of the crate; each has the output that its file beside it holds.
const PROGRAMS: [&str; 3] = [EXAMPLE, "tests/flight", "tests/refusals"];

/// The program of the guide.
pub(super) const EXAMPLE: &str = "examples/main";

/// Longest time of a program in QEMU; it takes seconds if nothing else runs.
const LIMIT: Duration = Duration::from_mins(5);

/// Libraries that the library for a PC needs.
const LIBRARIES_OF_PC: [&str; 3] = ["-lpthread", "-ldl", "-lm"];

/// Programs of the crate, and where they are built.
#[derive(Debug)]
pub(super) struct Programs<'a> {
    workspace: &'a Workspace,
    out: PathBuf,
}

impl<'a> Programs<'a> {
    pub(super) fn new(workspace: &'a Workspace, out: &Path) -> Self {
        Self {
            workspace,
            out: out.join("programs"),
        }
    }

    /// Compiles and runs every program on this PC, and compares its output with the one that is
    /// kept; returns all outputs.
    ///
    /// # Errors
    /// An error if one does not compile or prints something else.
    pub(super) fn on_host(&self, compiler: &Compiler<'_>, library: &Path) -> Result<Vec<String>> {
        let mut outputs = Vec::new();
        for program in PROGRAMS {
            let path = self.place("host", program)?;
            let compile = compiler
                .command()
                .args(STRICT)
                .arg("-O2")
                .args(self.included())
                .arg(self.source(program))
                .arg(directory(self.workspace, "examples/pc.c"))
                .arg(library)
                .args(LIBRARIES_OF_PC)
                .arg("-o")
                .arg(&path);
            compile.run()?;
            let run = self.workspace.shell.cmd(&path).quiet().ignore_status();
            let output = run.output()?;
            let printed = String::from_utf8_lossy(&output.stdout).into_owned();
            ensure!(
                output.status.success(),
                "{program} on this PC ended with {}\n{printed}",
                output.status
            );
            self.compare(program, "this PC", &printed)?;
            eprintln!(
                "{program} on this PC: {} lines as kept",
                printed.lines().count()
            );
            outputs.push(printed);
        }
        Ok(outputs)
    }

    /// Compiles every program for a library's machine, runs it in QEMU, and compares its output
    /// with the one that is kept and with that of this PC.
    ///
    /// # Errors
    /// An error if one does not link, which also means that it can panic, or prints something else.
    pub(super) fn in_emulator(
        &self,
        compiler: &Compiler<'_>,
        library: &Library,
        emulator: &Emulator,
        of_host: Option<&Vec<String>>,
    ) -> Result<()> {
        let target = library.architecture.target();
        for (index, program) in PROGRAMS.into_iter().enumerate() {
            let image = self.link(compiler, library, program)?;
            let printed = emulated(emulator, library, &image)
                .with_context(|| format!("{program} for {target}"))?;
            let Board { machine, .. } = library.board();
            self.compare(program, target, &printed)?;
            let here = of_host.and_then(|outputs| outputs.get(index));
            ensure!(
                here.is_none_or(|here| *here == printed),
                "{program} prints something else for {target} than on this PC"
            );
            eprintln!(
                "{program} for {target} on {machine}: {} lines as kept",
                printed.lines().count()
            );
        }
        Ok(())
    }

    /// Links a program for a library's machine and returns its image.
    ///
    /// # Errors
    /// An error if it does not compile or link.
    pub(super) fn link(
        &self,
        compiler: &Compiler<'_>,
        library: &Library,
        program: &str,
    ) -> Result<PathBuf> {
        let path = self.place(library.architecture.target(), program)?;
        self.linking(compiler, library, program, &path).run()?;
        Ok(path)
    }

    /// Checks that a program with a panic does not link, for that reason alone.
    ///
    /// # Errors
    /// An error if it links, or fails for another reason.
    pub(super) fn refuses_panic(&self, compiler: &Compiler<'_>, control: &Library) -> Result<()> {
        let program = "tests/can_panic";
        let path = self.place("control", program)?;
        let link = self.linking(compiler, control, program, &path);
        let output = link.ignore_status().output()?;
        let text = String::from_utf8_lossy(&output.stderr);
        if output.status.success() {
            bail!("{program} links although it can panic: the link shows nothing");
        }
        let undefined: Vec<_> = text
            .lines()
            .filter(|line| line.contains("undefined reference"))
            .collect();
        ensure!(
            !undefined.is_empty() && undefined.iter().all(|line| line.contains(PANIC_SYMBOL)),
            "{program} does not link for another reason:\n{text}"
        );
        eprintln!("{program} does not link: undefined reference to {PANIC_SYMBOL}");
        Ok(())
    }

    fn linking<'c>(
        &self,
        compiler: &Compiler<'c>,
        library: &Library,
        program: &str,
        path: &Path,
    ) -> xshell::Cmd<'c> {
        let Board { script, flags, .. } = library.board();
        let examples = directory(self.workspace, "examples");
        let program = self.source(program);
        let start = examples.join("cortex_m.c");
        let gcc = compiler.command();
        let gcc = gcc.args(STRICT).args(["-Os", "-mthumb", "-ffreestanding"]);
        gcc.args(flags)
            .args(self.included())
            .args(["-ffunction-sections", "-fdata-sections", "-nostdlib"])
            .arg(program)
            .arg(start)
            .arg(&library.path)
            .arg("-lgcc")
            .arg(option("L", &examples))
            .arg(option("T", &examples.join(script)))
            .args(["-Wl,--gc-sections", "-Wl,-z,noexecstack", "-o"])
            .arg(path)
    }

    /// Compares the output of a program with the one that is kept.
    pub(super) fn compare(&self, program: &str, on: &str, printed: &str) -> Result<()> {
        let kept = self.source(program).with_extension("txt");
        let expected = fs::read_to_string(&kept).with_context(|| kept.display().to_string())?;
        if printed == expected {
            return Ok(());
        }
        let differs = printed.lines().zip(expected.lines());
        let first = differs.into_iter().find(|(printed, kept)| printed != kept);
        let (printed, kept_line) = first.unwrap_or(("another number of lines", ""));
        bail!(
            "{program} on {on} prints \"{printed}\", and {} says \"{kept_line}\"",
            kept.display()
        );
    }

    fn source(&self, program: &str) -> PathBuf {
        directory(self.workspace, program).with_extension("c")
    }

    /// Returns the options of the directories of headers.
    fn included(&self) -> [String; 2] {
        ["include", "examples"].map(|name| option("I", &directory(self.workspace, name)))
    }

    fn place(&self, on: &str, program: &str) -> Result<PathBuf> {
        let directory = self.out.join(on);
        fs::create_dir_all(&directory).with_context(|| directory.display().to_string())?;
        let name = Path::new(program)
            .file_name()
            .context("name of a program")?;
        Ok(directory.join(name))
    }
}

/// Runs an image on a library's machine in QEMU, and returns what it prints.
///
/// # Errors
/// An error if it ends with one.
pub(super) fn emulated(emulator: &Emulator, library: &Library, image: &Path) -> Result<String> {
    emulator.run(library.board().machine, &[], image, LIMIT)
}
