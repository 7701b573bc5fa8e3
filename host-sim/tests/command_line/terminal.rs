//! A pseudo-terminal.

use std::fs::{File, OpenOptions};
use std::io::Read as _;
use std::os::unix::fs::OpenOptionsExt;
use std::process::{Command, Stdio};

use rustix::fs::OFlags;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};

/// A pseudo-terminal: a program uses `near` as its terminal, or as a port.
pub(crate) struct Terminal {
    pub(crate) far: File,
    pub(crate) near: File,
    pub(crate) name: String,
}

impl Terminal {
    pub(crate) fn open() -> Self {
        // Programs that the tests start must not hold the far end open.
        let far = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&far).unwrap();
        unlockpt(&far).unwrap();
        let name = ptsname(&far, Vec::new()).unwrap().into_string().unwrap();
        let near = OpenOptions::new()
            .read(true)
            .write(true)
            .custom_flags(OFlags::NOCTTY.bits().cast_signed())
            .open(&name)
            .unwrap();
        Self {
            far: File::from(far),
            near,
            name,
        }
    }

    /// Runs a command with this terminal, of so many columns, as one of its streams; returns what
    /// is shown, and the exit code.
    pub(crate) fn shows(
        self,
        columns: u16,
        mut command: Command,
        stream: fn(&mut Command, Stdio) -> &mut Command,
    ) -> (String, Option<i32>) {
        let Self { mut far, near, .. } = self;
        let size = Winsize {
            ws_row: 24,
            ws_col: columns,
            ws_xpixel: 0,
            ws_ypixel: 0,
        };
        tcsetwinsize(&far, size).unwrap();
        command.env("TERM", "xterm").env_remove("NO_COLOR");
        stream(&mut command, Stdio::from(near));
        let mut child = command.spawn().unwrap();
        // The command keeps the near end open.
        drop(command);
        let mut shown = Vec::new();
        // Reading ends with an error once no process has the terminal open.
        let _ = far.read_to_end(&mut shown);
        let code = child.wait().unwrap().code();
        (String::from_utf8(shown).unwrap(), code)
    }
}
