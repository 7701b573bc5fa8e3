//! QEMU: the one on the search path if it is new enough, otherwise that of the project's tools.

use std::{
    env,
    ffi::OsString,
    io::Read as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use anyhow::{Context as _, Result, bail};
use wait_timeout::ChildExt as _;
use xshell::{Shell, cmd};

use crate::{
    machine::on_path,
    missing::Missing,
    tools::{Tool, Toolbox},
    version::Version,
    workspace::Workspace,
};

/// Name of the program.
const PROGRAM: &str = "qemu-system-arm";

/// A QEMU that is new enough.
#[derive(Clone, Debug)]
pub(crate) struct Emulator {
    program: PathBuf,
    /// Directory of the program, unless it is on the search path.
    directory: Option<PathBuf>,
}

impl Emulator {
    /// Finds or fetches QEMU, and prints which one is used.
    ///
    /// # Errors
    /// [`Missing`] if there is none and none can be fetched.
    pub(crate) fn set_up(workspace: &Workspace, toolbox: &Toolbox<'_>) -> Result<Self, Missing> {
        let found = on_path(PROGRAM).map(|program| {
            let serves = serves(&workspace.shell, &program);
            serves.map(|version| (program, version))
        });
        let unusable = match found {
            Some(Ok((program, version))) => {
                workspace.tell(&format!("QEMU {version} on the search path"));
                return Ok(Self {
                    program,
                    directory: None,
                });
            }
            Some(Err(fault)) => format!("that on the search path does not serve: {fault:#}"),
            None => "none is on the search path".to_owned(),
        };
        let tool = toolbox.provide(Tool::Qemu);
        let tool = tool.map_err(|missing| missing.after(&unusable))?;
        workspace.tell(&format!("QEMU of {}", tool.bin().display()));
        Ok(Self {
            program: tool.program(PROGRAM),
            directory: Some(tool.bin()),
        })
    }

    /// Returns the search path for programs that start QEMU by its name.
    ///
    /// # Errors
    /// An error if a directory cannot be part of a search path.
    pub(crate) fn search_path(&self) -> Result<OsString> {
        let path = env::var_os("PATH").unwrap_or_default();
        let Some(directory) = &self.directory else {
            return Ok(path);
        };
        let others = env::split_paths(&path).filter(|one| one.is_absolute());
        env::join_paths([directory.clone()].into_iter().chain(others))
            .with_context(|| directory.display().to_string())
    }

    /// Runs a program on a machine to its end, without a display, and returns what it prints by
    /// semihosting.
    ///
    /// # Errors
    /// An error if it ends with a failure, or not within `limit`.
    pub(crate) fn run(
        &self,
        machine: &str,
        arguments: &[&str],
        image: &Path,
        limit: Duration,
    ) -> Result<String> {
        let mut command = Command::new(&self.program);
        command
            .args(["-M", machine, "-display", "none", "-monitor", "none"])
            .args(["-serial", "none"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(arguments)
            .arg("-kernel")
            .arg(image)
            .stdin(Stdio::null())
            .stdout(Stdio::piped());
        let mut child = command
            .spawn()
            .with_context(|| self.program.display().to_string())?;
        let mut pipe = child.stdout.take().context("QEMU's standard output")?;
        let reader = thread::spawn(move || {
            let mut text = String::new();
            pipe.read_to_string(&mut text).map(|_| text)
        });
        let waited = child.wait_timeout(limit);
        if !matches!(waited, Ok(Some(_))) {
            child.kill()?;
            child.wait()?;
        }
        let status = waited?;
        let printed = reader.join().ok().context("QEMU's standard output")??;
        match status {
            Some(status) if status.success() => Ok(printed),
            Some(status) => bail!("{machine} ended with {status}\n{printed}"),
            None => bail!(
                "{machine} did not end within {} s\n{printed}",
                limit.as_secs()
            ),
        }
    }
}

/// Returns the version of a QEMU that is new enough.
fn serves(shell: &Shell, program: &Path) -> Result<Version> {
    let answer = cmd!(shell, "{program} --version").quiet().ignore_status();
    let answer = answer.output()?;
    let text = String::from_utf8_lossy(&answer.stdout);
    let fault = String::from_utf8_lossy(&answer.stderr);
    let version = Version::find(&text).filter(|_| answer.status.success());
    let Some(version) = version else {
        let first = fault.lines().chain(text.lines()).next();
        bail!("it does not start ({})", first.unwrap_or("it says nothing"));
    };
    match Tool::Qemu.oldest() {
        Some(oldest) if version < oldest => {
            bail!("it is {version}, and {oldest} or later is needed")
        }
        _ => Ok(version),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::{fs, os::unix::fs::PermissionsExt as _};

    use super::*;

    #[test]
    fn qemu_that_is_too_old_or_does_not_start_does_not_serve() {
        let shell = Shell::new().unwrap();
        let folder = shell.create_temp_dir().unwrap();
        let program = folder.path().join(PROGRAM);
        let ask = |script: &str, mode: u32| {
            // Each run has a new file, because one that was just run may still be busy.
            let _ = fs::remove_file(&program);
            fs::write(&program, script).unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(mode)).unwrap();
            serves(&shell, &program).map_err(|fault| format!("{fault:#}"))
        };
        let says = |version: &str| format!("#!/bin/sh\necho 'QEMU emulator version {version}'\n");
        assert_eq!(ask(&says("7.2.22"), 0o755), Ok(Version::new(7, 2)));
        assert_eq!(ask(&says("10.0.2"), 0o755), Ok(Version::new(10, 0)));
        let old = ask(&says("6.2.0"), 0o755).unwrap_err();
        assert_eq!(old, "it is 6.2, and 7.2 or later is needed");
        let broken = ask(
            "#!/bin/sh\necho 'libfdt.so.1: cannot open' >&2\nexit 127\n",
            0o755,
        );
        assert_eq!(
            broken.unwrap_err(),
            "it does not start (libfdt.so.1: cannot open)"
        );
        assert!(ask(&says("7.2"), 0o644).is_err());
    }

    #[test]
    fn program_that_does_not_end_is_ended() {
        let shell = Shell::new().unwrap();
        let folder = shell.create_temp_dir().unwrap();
        let program = folder.path().join(PROGRAM);
        fs::write(&program, "#!/bin/sh\necho begun\nexec sleep 600\n").unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        let emulator = Emulator {
            program,
            directory: Some(folder.path().to_owned()),
        };
        let path = emulator.search_path().unwrap();
        assert_eq!(env::split_paths(&path).next().unwrap(), folder.path());
        let run = emulator.run("mps2", &[], Path::new("x"), Duration::from_millis(300));
        let text = run.unwrap_err().to_string();
        assert!(text.starts_with("mps2 did not end within 0 s"), "{text}");
    }
}
