//! A pseudo-terminal.

use std::fs::{File, OpenOptions};
use std::os::unix::fs::OpenOptionsExt;

use rustix::fs::OFlags;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

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
}
