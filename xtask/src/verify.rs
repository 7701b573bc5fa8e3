//! `cargo xtask verify`: builds `host-sim` and hands over to `host-sim verify`.

use std::{
    ffi::{OsStr, OsString},
    process::{Command, ExitCode},
};

use anyhow::{Context as _, Result};

use crate::workspace::Workspace;

/// Exit code where the program ended by a signal and gave none of its own.
const ENDED_BY_SIGNAL: u8 = 3;

/// Builds `host-sim`, runs `host-sim verify` with `arguments` in the user's directory and passes its exit code on.
///
/// # Errors
/// Where `host-sim` cannot be built or started.
pub(crate) fn run(workspace: &Workspace, mut arguments: Vec<OsString>) -> Result<ExitCode> {
    build_host_sim(workspace)?;
    if !names_out(&arguments) {
        arguments.extend(["--out".into(), default_out(workspace)]);
    }
    let host_sim = workspace
        .shell
        .cmd(workspace.host_sim())
        .arg("verify")
        .args(arguments);
    let status = Command::from(host_sim).status().context("start host-sim")?;
    let code = status.code().map_or(ENDED_BY_SIGNAL, |code| {
        u8::try_from(code).unwrap_or(u8::MAX)
    });
    Ok(ExitCode::from(code))
}

/// Builds `host-sim` in release, with cargo's progress on the terminal.
///
/// # Errors
/// Where the build fails.
pub(crate) fn build_host_sim(workspace: &Workspace) -> Result<()> {
    let build = workspace.cargo("build --release --package host-sim");
    build.run().map_err(Into::into)
}

/// Where the report goes unless the user says otherwise: `verify` in the target directory, seen from the user's.
pub(crate) fn default_out(workspace: &Workspace) -> OsString {
    let out = workspace.target_dir.join("verify");
    let from_here = out
        .strip_prefix(workspace.shell.current_dir())
        .unwrap_or(&out);
    from_here.as_os_str().to_owned()
}

/// Whether the user named the report's directory.
fn names_out(arguments: &[OsString]) -> bool {
    let is_out = |argument: &OsString| {
        argument == OsStr::new("--out") || argument.to_string_lossy().starts_with("--out=")
    };
    arguments.iter().any(is_out)
}

#[cfg(test)]
mod tests {
    use super::names_out;

    #[test]
    fn out_is_found_in_both_spellings_and_not_in_other_options() {
        for (line, expected) in [
            ("", false),
            ("--device sil", false),
            ("--outer x", false),
            ("--device sil --out x", true),
            ("--out=x --device sil", true),
        ] {
            let arguments: Vec<_> = line.split_whitespace().map(Into::into).collect();
            assert_eq!(names_out(&arguments), expected, "{line:?}");
        }
    }
}
