//! `cargo xtask verify`: builds the firmware and `host-sim`, and runs `host-sim verify`.

use std::{
    ffi::{OsStr, OsString},
    path::PathBuf,
    process::{Command, ExitCode},
};

use anyhow::{Context as _, Result, ensure};

use crate::{checks::TESTED, firmware, missing::Missing, workspace::Workspace};

/// Exit code if the program was ended by a signal and returned none.
const ENDED_BY_SIGNAL: u8 = 3;

/// Builds the firmware if it is needed, and `host-sim`, runs `host-sim verify` with `arguments` in
/// the user's directory and returns its exit code. If no device is named and the firmware or QEMU
/// is not available, `host-sim` verifies without it, and reports the reason.
///
/// # Errors
/// An error if the firmware was requested and cannot be built, or if `host-sim` cannot be built or
/// started.
pub(crate) fn run(workspace: &Workspace, arguments: Vec<OsString>) -> Result<ExitCode> {
    let mut build = Command::from(workspace.cargo("build --release --locked --package host-sim"));
    let build = build.spawn().context("start cargo")?;
    // The set-up runs beside the build, because a core would be idle while packages are downloaded
    // and one large crate is compiled.
    let firmware = firmware_for(&arguments);
    let set_up = (firmware != Firmware::NotUsed).then(|| firmware::set_up(workspace));
    let built = build.wait_with_output().context("cargo")?.status;
    ensure!(built.success(), "host-sim was not built");

    let mut verify = workspace
        .shell
        .cmd(workspace.host_sim("release"))
        .arg("verify");
    verify = match set_up {
        None => verify,
        Some(Ok(emulator)) => verify.env("PATH", emulator.search_path()?),
        // A firmware that does not compile is an error of the sources, not of this machine.
        Some(Err(error)) if firmware == Firmware::Optional && error.is::<Missing>() => {
            verify.arg("--not-in-qemu").arg(in_one_line(&error))
        }
        Some(Err(error)) => return Err(error),
    };
    if !names_out(&arguments) {
        verify = verify.arg("--out").arg(default_out(workspace));
    }
    let status = Command::from(verify.args(arguments))
        .status()
        .context("start host-sim")?;
    let code = status.code().map_or(ENDED_BY_SIGNAL, |code| {
        u8::try_from(code).unwrap_or(u8::MAX)
    });
    Ok(ExitCode::from(code))
}

/// Returns `host-sim` as the tests build it, which takes a fraction of the time of a release build.
///
/// # Errors
/// An error if the build fails.
pub(crate) fn tested_host_sim(workspace: &Workspace) -> Result<PathBuf> {
    // A build of the program alone would select other features of its dependencies and compile them
    // again.
    let build = workspace.cargo(&format!("test {TESTED} --locked --no-run --test main"));
    build.run()?;
    Ok(workspace.host_sim("debug"))
}

/// Returns the default directory of the report: `verify` in the target directory, relative to the
/// user's directory.
pub(crate) fn default_out(workspace: &Workspace) -> OsString {
    let out = workspace.target_dir.join("verify");
    let from_here = out
        .strip_prefix(workspace.shell.current_dir())
        .unwrap_or(&out);
    from_here.as_os_str().to_owned()
}

/// Need of the firmware according to the arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Firmware {
    /// The arguments name QEMU, or an option for QEMU alone.
    Required,
    /// The arguments name no device.
    Optional,
    /// The arguments name another device, or ask for help.
    NotUsed,
}

/// Returns the need of the firmware with these arguments.
fn firmware_for(arguments: &[OsString]) -> Firmware {
    let is_for_qemu = |argument: &OsString| {
        let text = argument.to_string_lossy();
        text == "--log" || text == "--firmware" || text.starts_with("--firmware=")
    };
    let without_device = if arguments.iter().any(is_for_qemu) {
        Firmware::Required
    } else {
        Firmware::Optional
    };
    let mut texts = arguments.iter().map(|argument| argument.to_string_lossy());
    while let Some(text) = texts.next() {
        let device = match text.split_once('=') {
            Some(("--device", device)) => Some(device.to_owned()),
            _ if text == "--device" => texts.next().map(Into::into),
            _ if text == "--help" || text == "-h" => return Firmware::NotUsed,
            _ => None,
        };
        if let Some(device) = device {
            let is_qemu = device == "qemu" || device.starts_with("qemu:");
            return if is_qemu {
                Firmware::Required
            } else {
                Firmware::NotUsed
            };
        }
    }
    without_device
}

/// Returns the error and its causes without line breaks.
fn in_one_line(error: &anyhow::Error) -> String {
    let text = format!("{error:#}");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns true if the user named the report's directory.
fn names_out(arguments: &[OsString]) -> bool {
    let is_out = |argument: &OsString| {
        argument == OsStr::new("--out") || argument.to_string_lossy().starts_with("--out=")
    };
    arguments.iter().any(is_out)
}

#[cfg(test)]
mod tests {
    use super::{Firmware, firmware_for, in_one_line, names_out};

    #[test]
    fn firmware_runs_unless_another_device_is_named() {
        for (line, expected) in [
            ("", Firmware::Optional),
            ("--camera device.toml", Firmware::Optional),
            ("--device sil", Firmware::NotUsed),
            ("--device=serial:/dev/ttyACM0", Firmware::NotUsed),
            ("--help", Firmware::NotUsed),
            ("--device qemu", Firmware::Required),
            ("--out x --device=qemu:an500", Firmware::Required),
            ("--firmware image.elf", Firmware::Required),
            ("--firmware=image.elf --out x", Firmware::Required),
            ("--log", Firmware::Required),
            ("--log --device sil", Firmware::NotUsed),
        ] {
            let arguments: Vec<_> = line.split_whitespace().map(Into::into).collect();
            assert_eq!(firmware_for(&arguments), expected, "{line:?}");
        }
    }

    #[test]
    fn reason_for_no_firmware_fits_in_a_line() {
        let error = anyhow::anyhow!("Either\n    this\nor that").context("no way");
        assert_eq!(in_one_line(&error), "no way: Either this or that");
    }

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
