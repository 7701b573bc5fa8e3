//! Files with a hidden name, which an interrupted program removes.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

/// Beginning and end of the name.
const NAME: [&str; 2] = [".host-sim-", ".part"];

/// The hidden files that this program has.
static HIDDEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// `true` if signals that end the program are to remove the hidden files.
static IS_ENDED_BY_SIGNALS: AtomicBool = AtomicBool::new(false);

/// `true` once the program itself decides what it does at these signals.
#[cfg(unix)]
static IS_ASKED_BY_SIGNALS: AtomicBool = AtomicBool::new(false);

/// From now on, signals that end the program remove the hidden files.
pub(super) fn remove_on_signals() {
    IS_ENDED_BY_SIGNALS.store(true, Ordering::Relaxed);
}

/// From now on, signals leave program and files as they are: the program ends by itself.
#[cfg(unix)]
pub(crate) fn leave_signals_to_the_program() {
    IS_ASKED_BY_SIGNALS.store(true, Ordering::SeqCst);
}

/// A hidden file, which is removed when it is dropped, and when a signal ends the program.
#[derive(Debug)]
pub(super) struct HiddenFile<F>(NamedTempFile<Listed<F>>);

/// An open file, and its name in [`HIDDEN`].
#[derive(Debug)]
struct Listed<F> {
    file: F,
    // The name goes after the file has gone: until then a signal must find it.
    _entry: Entry,
}

impl<F> HiddenFile<F> {
    /// Makes a file of a new name in a folder.
    pub(super) fn create(
        folder: &Path,
        mut make: impl FnMut(&Path) -> io::Result<F>,
    ) -> io::Result<Self> {
        if IS_ENDED_BY_SIGNALS.load(Ordering::Relaxed) {
            signals::remove_hidden_files();
        }
        let [prefix, suffix] = NAME;
        let mut builder = tempfile::Builder::new();
        let made = builder
            .prefix(prefix)
            .suffix(suffix)
            .make_in(folder, |path| {
                let entry = Entry::new(path);
                Ok(Listed {
                    file: make(path)?,
                    _entry: entry,
                })
            });
        // Without the hidden name, which means nothing to the user.
        made.map(Self)
            .map_err(|error| io::Error::from(error.kind()))
    }

    /// The open file.
    pub(super) fn file(&self) -> &F {
        &self.0.as_file().file
    }

    /// The open file, for writing.
    pub(super) fn file_mut(&mut self) -> &mut F {
        &mut self.0.as_file_mut().file
    }

    /// The hidden name.
    pub(super) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Gives the file its name, in place of any that has it.
    pub(super) fn persist(self, path: &Path) -> io::Result<()> {
        self.0.persist(path)?;
        Ok(())
    }
}

/// A name in [`HIDDEN`].
#[derive(Debug)]
struct Entry(PathBuf);

impl Entry {
    fn new(path: &Path) -> Self {
        hidden().insert(path.to_path_buf());
        Self(path.to_path_buf())
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        hidden().remove(&self.0);
    }
}

fn hidden() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    HIDDEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the hidden files of a folder that no program is writing: those of killed programs.
///
/// # Errors
/// Those of the file system.
pub(super) fn remove_abandoned(folder: &Path) -> io::Result<()> {
    let [prefix, suffix] = NAME;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let is_hidden = name
            .to_str()
            .is_some_and(|name| name.starts_with(prefix) && name.ends_with(suffix));
        if !is_hidden {
            continue;
        }
        // A file that has gone meanwhile was another program's.
        let Ok(file) = File::options().write(true).open(entry.path()) else {
            continue;
        };
        if file.try_lock().is_ok() {
            match fs::remove_file(entry.path()) {
                // Another program has removed it, too.
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
                _ => {}
            }
        }
    }
    Ok(())
}

#[cfg(unix)]
pub(crate) use signals::handled;

#[cfg(unix)]
mod signals {
    //! Signals that end the program.

    use std::fs;
    use std::sync::Once;
    use std::sync::atomic::Ordering;
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    use super::IS_ASKED_BY_SIGNALS;

    /// From the first call on, SIGINT, SIGTERM and SIGHUP remove the hidden files before they end
    /// the program, as they do without this.
    pub(super) fn remove_hidden_files() {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| {
            let Ok(mut signals) = Signals::new(handled()) else {
                return;
            };
            thread::spawn(move || {
                for signal in &mut signals {
                    if IS_ASKED_BY_SIGNALS.load(Ordering::SeqCst) {
                        continue;
                    }
                    // The names stay locked until the end: no file is made after this.
                    let hidden = super::hidden();
                    for path in hidden.iter() {
                        let _ = fs::remove_file(path);
                    }
                    let _ = emulate_default_handler(signal);
                }
            });
        });
    }

    /// Signals that the program's caller has not told it to ignore, as `nohup` does, and a shell
    /// for a command in the background.
    pub(crate) fn handled() -> Vec<i32> {
        let status = fs::read_to_string("/proc/self/status");
        let ignored = status.ok().as_deref().and_then(ignored);
        match ignored {
            Some(ignored) => [SIGINT, SIGTERM, SIGHUP]
                .into_iter()
                .filter(|signal| ignored & (1 << (signal - 1)) == 0)
                .collect(),
            // Elsewhere it is not known what `nohup` has done.
            None => vec![SIGINT, SIGTERM],
        }
    }

    /// Bit `n − 1` is signal `n`, of Linux' list of what a process is and does.
    pub(super) fn ignored(status: &str) -> Option<u64> {
        let mask = status
            .lines()
            .find_map(|line| line.strip_prefix("SigIgn:"))?;
        u64::from_str_radix(mask.trim(), 16).ok()
    }
}

#[cfg(not(unix))]
mod signals {
    //! Elsewhere, the next program removes what an interrupted one has left.

    pub(super) fn remove_hidden_files() {}
}

#[cfg(all(test, unix))]
mod tests {
    use super::signals;

    #[test]
    fn ignored_signals_are_read_from_the_mask_of_linux() {
        let status = "Name:\tcat\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000000003\n";
        assert_eq!(signals::ignored(status), Some(3));
        assert_eq!(signals::ignored("Name:\tcat\n"), None);
    }
}
