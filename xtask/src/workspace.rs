//! Directories of the workspace and the host's cargo.

use std::{
    env::{self, consts::EXE_SUFFIX},
    ffi::OsString,
    fs::{self, File, TryLockError},
    path::{self, Path, PathBuf},
};

use anyhow::{Context as _, Result};
use xshell::{Cmd, Shell};

/// Directories of the workspace, and a shell in the directory of the user.
#[derive(Debug)]
pub(crate) struct Workspace {
    /// Shell that runs commands in the user's directory, so that relative paths mean what the user
    /// meant.
    pub(crate) shell: Shell,
    /// Directory of the root `Cargo.toml`.
    pub(crate) root: PathBuf,
    /// Cargo's target directory, wherever settings place it.
    pub(crate) target_dir: PathBuf,
    tells: bool,
}

impl Workspace {
    /// Finds the directories.
    ///
    /// # Errors
    /// An error if the current directory or this executable cannot be located.
    pub(crate) fn new() -> Result<Self> {
        let shell = Shell::new()?;
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = root.parent().context("xtask has no parent directory")?;
        // Cargo put this program into <target>/debug, by the same settings that hold for what it
        // builds next.
        let xtask = env::current_exe().context("path of xtask")?;
        let target_dir = xtask
            .ancestors()
            .nth(2)
            .context("xtask is not in a target directory")?;
        // A relative setting is relative to the user's directory, but steps run in others.
        if let Some(setting) = env::var_os("CARGO_TARGET_DIR") {
            shell.set_var("CARGO_TARGET_DIR", path::absolute(setting)?);
        }
        Ok(Self {
            shell,
            root: root.to_owned(),
            target_dir: target_dir.to_owned(),
            tells: true,
        })
    }

    /// Returns the same workspace with [`Self::tell`] switched on or off.
    pub(crate) fn telling(self, tells: bool) -> Self {
        Self { tells, ..self }
    }

    /// Prints what is used, unless that is switched off.
    pub(crate) fn tell(&self, text: &str) {
        if self.tells {
            eprintln!("xtask: {text}");
        }
    }

    /// Locks a directory, which is created if it is absent, until the value is dropped. Waits for
    /// another xtask that has the lock, and prints `what` that one does.
    ///
    /// # Errors
    /// An error if the directory cannot be written.
    pub(crate) fn lock(directory: &Path, what: &str) -> Result<File> {
        let path = directory.join(".lock");
        let told = || path.display().to_string();
        fs::create_dir_all(directory).with_context(told)?;
        let file = File::create(&path).with_context(told)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                eprintln!("xtask: waiting for another xtask, which {what}");
                file.lock().with_context(told)?;
            }
            Err(TryLockError::Error(error)) => return Err(error).with_context(told),
        }
        Ok(file)
    }

    /// Returns a command of the cargo that started xtask; the words of `line` are its arguments.
    pub(crate) fn cargo(&self, line: &str) -> Cmd<'_> {
        let cargo = self.shell.cmd(host_cargo()).quiet();
        cargo.args(line.split_whitespace())
    }

    /// Returns the path of `host-sim` in the directory of a profile.
    pub(crate) fn host_sim(&self, profile: &str) -> PathBuf {
        self.target_dir
            .join(profile)
            .join(format!("host-sim{EXE_SUFFIX}"))
    }
}

/// Returns the path of the cargo that started xtask.
pub(crate) fn host_cargo() -> OsString {
    env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}
