//! The package as build systems use it: the example by `CMake` and by pkg-config, for this PC and
//! for the boards.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result, ensure};
use xshell::{Cmd, cmd};

use super::{
    compiler::{Compiler, STRICT, option},
    library::{Board, Library, directory},
    program::{EXAMPLE, Programs, emulated},
};
use crate::{
    NOT_CHECKED,
    emulator::Emulator,
    machine::on_path,
    tools::{Tool, Toolbox},
    workspace::Workspace,
};

/// Name of the package in the lists of build systems.
const PACKAGE: &str = "fmc_camera";

/// The package, with what its trial needs.
#[derive(Debug)]
pub(super) struct Trial<'a> {
    pub(super) workspace: &'a Workspace,
    pub(super) programs: &'a Programs<'a>,
    pub(super) emulator: &'a Emulator,
    /// Directory of the package.
    pub(super) out: &'a Path,
    pub(super) libraries: &'a [Library],
    pub(super) arm: &'a Compiler<'a>,
    /// The compiler of this PC, if there is one.
    pub(super) host: Option<&'a Compiler<'a>>,
}

impl Trial<'_> {
    /// Builds the example with each build system there is, and compares what it prints.
    ///
    /// # Errors
    /// An error if a build fails, or the example prints something else.
    pub(super) fn run(&self, toolbox: &Toolbox<'_>) -> Result<()> {
        match on_path("pkg-config").or_else(|| on_path("pkgconf")) {
            Some(program) => self.by_pkg_config(&program)?,
            None => eprintln!("{NOT_CHECKED}the .pc files: no pkg-config on the search path"),
        }
        match cmake(toolbox) {
            Ok(program) => self.by_cmake(&program),
            Err(lack) => {
                eprintln!("{NOT_CHECKED}the CMake package: {lack}");
                Ok(())
            }
        }
    }

    fn by_pkg_config(&self, program: &Path) -> Result<()> {
        let flags = |arguments: &[&str]| -> Result<Vec<String>> {
            let ask = cmd!(self.workspace.shell, "{program}").quiet();
            let ask = ask.env("PKG_CONFIG_PATH", self.out.join("pkgconfig"));
            let text = ask.args(arguments).read()?;
            Ok(text.split_whitespace().map(str::to_owned).collect())
        };
        if let Some(compiler) = self.host {
            let package = format!("{PACKAGE}-host");
            let image = self.directory("pkg-config-host")?.join("example");
            let compile = compiler.command().args(STRICT).args(self.sources("pc"));
            let flags = flags(&["--cflags", "--libs", "--static", &package])?;
            let compile = compile.arg(self.examples()).args(flags);
            compile.arg("-o").arg(&image).run()?;
            self.compare_here("pkg-config", &image)?;
        }
        for library in self.libraries {
            let target = library.architecture.target();
            let package = format!("{PACKAGE}-{target}");
            let image = self.directory(&format!("pkg-config-{target}"))?;
            let image = image.join("example");
            let compile = self.arm.command().args(STRICT).args(board_flags(library));
            let compile = compile.args(self.sources("cortex_m")).arg(self.examples());
            let compile = compile.args(flags(&["--cflags", "--libs", &package])?);
            let compile = compile.arg("-lgcc").args(self.linking(library));
            compile.arg("-o").arg(&image).run()?;
            self.compare_in_emulator("pkg-config", library, &image)?;
        }
        Ok(())
    }

    fn by_cmake(&self, program: &Path) -> Result<()> {
        if self.host.is_some() {
            let build = self.directory("cmake-host")?;
            let sources = self.sources("pc");
            self.configure(program, &build, &sources, &[]).run()?;
            self.make(program, &build)?;
            self.compare_here("CMake", &build.join("example"))?;
            // A target without a library is refused by its name, and so is another version.
            for (setting, why) in [
                ("-DFMC_CAMERA_TARGET=none", "no library for none"),
                ("-DVERSION=99.0", "99.0"),
            ] {
                let build = self.directory("cmake-refused")?;
                let setting = setting.to_owned();
                let configure = self.configure(program, &build, &sources, &[setting]);
                let output = configure.ignore_status().output()?;
                let text = String::from_utf8_lossy(&output.stderr);
                ensure!(
                    !output.status.success() && text.contains(why),
                    "CMake takes {why}:\n{text}"
                );
            }
        }
        for library in self.libraries {
            let target = library.architecture.target();
            let build = self.directory(&format!("cmake-{target}"))?;
            let settings = [
                "-DCMAKE_SYSTEM_NAME=Generic".to_owned(),
                // Nothing links before the board's script is known.
                "-DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY".to_owned(),
                format!("-DCMAKE_C_COMPILER={}", self.arm.program().display()),
                format!("-DCMAKE_C_FLAGS={}", board_flags(library).join(" ")),
                format!(
                    "-DCMAKE_EXE_LINKER_FLAGS={}",
                    self.linking(library).join(" ")
                ),
                "-DLIBRARIES=gcc".to_owned(),
            ];
            let sources = self.sources("cortex_m");
            self.configure(program, &build, &sources, &settings).run()?;
            self.make(program, &build)?;
            self.compare_in_emulator("CMake", library, &build.join("example"))?;
        }
        Ok(())
    }

    fn configure(
        &self,
        program: &Path,
        build: &Path,
        sources: &[PathBuf; 2],
        settings: &[String],
    ) -> Cmd<'_> {
        let [main, platform] = sources.each_ref().map(|source| source.display());
        let configure = cmd!(self.workspace.shell, "{program}").quiet();
        configure
            .ignore_stdout()
            .arg("-S")
            .arg(directory(self.workspace, "tests/cmake"))
            .arg("-B")
            .arg(build)
            .arg(format!(
                "-D{PACKAGE}_DIR={}",
                self.out.join("cmake").display()
            ))
            .arg(format!("-DSOURCES={main};{platform}"))
            .args(settings)
    }

    fn make(&self, program: &Path, build: &Path) -> Result<()> {
        let make = cmd!(self.workspace.shell, "{program} --build {build}");
        Ok(make.quiet().ignore_stdout().run()?)
    }

    fn compare_here(&self, by: &str, image: &Path) -> Result<()> {
        let printed = cmd!(self.workspace.shell, "{image}").quiet().output()?;
        let printed = String::from_utf8_lossy(&printed.stdout);
        self.programs.compare(EXAMPLE, "this PC", &printed)?;
        eprintln!("{EXAMPLE} by {by} on this PC: as kept");
        Ok(())
    }

    fn compare_in_emulator(&self, by: &str, library: &Library, image: &Path) -> Result<()> {
        let target = library.architecture.target();
        let printed = emulated(self.emulator, library, image)?;
        self.programs.compare(EXAMPLE, target, &printed)?;
        eprintln!("{EXAMPLE} by {by} for {target}: as kept");
        Ok(())
    }

    /// Returns the sources of the example, as the package and the platform's have them.
    fn sources(&self, platform: &str) -> [PathBuf; 2] {
        let platform = directory(self.workspace, "examples").join(platform);
        let main = self.out.join(EXAMPLE);
        [main, platform].map(|source| source.with_extension("c"))
    }

    /// Returns the option of the directory of the platform's header.
    fn examples(&self) -> String {
        option("I", &directory(self.workspace, "examples"))
    }

    /// Returns the options by which a board's program is linked, with unused functions dropped.
    fn linking(&self, library: &Library) -> [String; 4] {
        let examples = directory(self.workspace, "examples");
        let Board { script, .. } = library.board();
        [
            "-nostdlib".to_owned(),
            option("L", &examples),
            option("T", &examples.join(script)),
            "-Wl,--gc-sections,-z,noexecstack".to_owned(),
        ]
    }

    /// Returns an empty directory.
    fn directory(&self, name: &str) -> Result<PathBuf> {
        let path = self.out.join("programs").join(name);
        if path.exists() {
            fs::remove_dir_all(&path).with_context(|| path.display().to_string())?;
        }
        fs::create_dir_all(&path).with_context(|| path.display().to_string())?;
        Ok(path)
    }
}

/// Returns the options of a board's compiler.
fn board_flags(library: &Library) -> Vec<&'static str> {
    let Board { flags, .. } = library.board();
    let common = ["-Os", "-mthumb", "-ffreestanding", "-ffunction-sections"];
    flags.iter().copied().chain(common).collect()
}

/// Returns `CMake`, on the search path or fetched, or what is missing.
fn cmake(toolbox: &Toolbox<'_>) -> Result<PathBuf, String> {
    if on_path("make").is_none() && on_path("ninja").is_none() {
        return Err("no make and no ninja on the search path".to_owned());
    }
    if let Some(program) = on_path("cmake") {
        return Ok(program);
    }
    let tool = toolbox.provide(Tool::Cmake);
    let tool = tool.map_err(|missing| missing.to_string())?;
    Ok(tool.program("cmake"))
}
