//! Unfinished files.

mod hidden;
#[cfg(target_os = "linux")]
mod unnamed;

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use hidden::HiddenFile;
#[cfg(unix)]
pub(crate) use hidden::{handled as handled_signals, leave_signals_to_the_program};

/// A file that is being written: it has its name once it is complete, and is removed otherwise.
///
/// It has no name until then where the system can do that, which is on Linux with `O_TMPFILE`: then
/// nothing is left of it, even if the program is killed. Elsewhere it has a hidden name, and is
/// removed when SIGINT, SIGTERM or SIGHUP ends a program that has asked for it
/// ([`remove_on_signals`]). It is locked as long as it is written, so that what a killed program
/// has left can be told from what another one is writing, and the next program that writes into
/// the folder removes it.
#[derive(Debug)]
pub struct Part {
    file: PartFile,
    path: PathBuf,
}

#[derive(Debug)]
enum PartFile {
    #[cfg(target_os = "linux")]
    Unnamed(File),
    Hidden(HiddenFile<File>),
}

impl Part {
    /// Creates a file that will be `path`.
    ///
    /// # Errors
    /// Those of the file system, without the name of the unfinished file, which means nothing to
    /// the user.
    pub fn create(path: PathBuf) -> io::Result<Self> {
        let folder = folder(&path);
        remove_abandoned_once(folder);
        #[cfg(target_os = "linux")]
        if let Some(file) = unnamed::create(folder) {
            return Self::of(PartFile::Unnamed(file), path);
        }
        Self::hidden(path)
    }

    /// Creates a file that has a hidden name until it is complete.
    fn hidden(path: PathBuf) -> io::Result<Self> {
        let mut options = File::options();
        options.read(true).write(true).create_new(true);
        let file = loop {
            let made = HiddenFile::create(folder(&path), |name| options.open(name))?;
            // Some network file systems have no locks; there an unfinished file is never removed
            // by another program.
            let _ = made.file().lock();
            // Another program may have removed it before it was locked.
            if made.path().exists() {
                break made;
            }
        };
        Self::of(PartFile::Hidden(file), path)
    }

    fn of(file: PartFile, path: PathBuf) -> io::Result<Self> {
        let mut part = Self { file, path };
        if let Ok(existing) = fs::metadata(&part.path) {
            part.file_mut().set_permissions(existing.permissions())?;
        }
        Ok(part)
    }

    /// The file, for reading and for writing at any place.
    pub fn file_mut(&mut self) -> &mut File {
        match &mut self.file {
            #[cfg(target_os = "linux")]
            PartFile::Unnamed(file) => file,
            PartFile::Hidden(hidden) => hidden.file_mut(),
        }
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// Those of the file system; a full disk may be reported only here.
    pub fn complete(mut self) -> io::Result<()> {
        self.file_mut().sync_all()?;
        match self.file {
            #[cfg(target_os = "linux")]
            PartFile::Unnamed(file) => match unnamed::link(&file, &self.path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    // A name cannot be given in place of another file; it can be moved there.
                    let _ = file.lock();
                    let link = |name: &Path| unnamed::link(&file, name);
                    HiddenFile::create(folder(&self.path), link)?.persist(&self.path)
                }
                linked => linked,
            },
            PartFile::Hidden(hidden) => hidden.persist(&self.path),
        }
    }
}

impl Write for Part {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file_mut().flush()
    }
}

/// From now on, SIGINT, SIGTERM and SIGHUP remove the files that have a hidden name before they end
/// the program, as they do without this. It is for programs: a library must leave the signals to
/// the program that has it, which may go on after them.
pub fn remove_on_signals() {
    hidden::remove_on_signals();
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Removes what killed programs have left in a folder, when this one first writes into it.
fn remove_abandoned_once(folder: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut seen = SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    if seen.insert(folder.to_path_buf()) {
        // A file that cannot be removed does not keep the program from its work.
        let _ = hidden::remove_abandoned(folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Create = fn(PathBuf) -> io::Result<Part>;

    /// Without and with a hidden name, where there are both.
    const BOTH: [Create; 2] = [Part::create, Part::hidden];

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn only_parts_that_nobody_writes_are_removed_by_the_next_program() {
        let folder = tempfile::tempdir().unwrap();
        let mut written = Part::hidden(folder.path().join("a.tif")).unwrap();
        written.write_all(b"half").unwrap();
        let put = |name: &str| fs::write(folder.path().join(name), b"something").unwrap();
        put(".host-sim-left.part");
        put("kept.part");
        let next = Part::create(folder.path().join("b.tif")).unwrap();
        assert!(!folder.path().join(".host-sim-left.part").exists());
        written.complete().unwrap();
        drop(next);
        assert_eq!(names(folder.path()), ["a.tif", "kept.part"]);
        assert_eq!(fs::read(folder.path().join("a.tif")).unwrap(), b"half");
    }

    #[test]
    fn part_that_is_dropped_leaves_nothing_and_an_older_file_whole() {
        for create in BOTH {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.tif");
            drop(create(path.clone()).unwrap());
            assert_eq!(names(folder.path()), Vec::<String>::new());
            fs::write(&path, "old").unwrap();
            create(path.clone()).unwrap().write_all(b"new").unwrap();
            assert_eq!(names(folder.path()), ["a.tif"]);
            assert_eq!(fs::read(&path).unwrap(), b"old");
        }
    }

    #[test]
    fn complete_part_takes_the_place_of_an_older_file_with_its_permissions() {
        for create in BOTH {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.tif");
            for text in ["first", "second"] {
                let mut part = create(path.clone()).unwrap();
                part.write_all(text.as_bytes()).unwrap();
                part.complete().unwrap();
                assert_eq!(names(folder.path()), ["a.tif"]);
                assert_eq!(fs::read_to_string(&path).unwrap(), text);
                #[cfg(unix)]
                {
                    use std::os::unix::fs::PermissionsExt;
                    let private = fs::Permissions::from_mode(0o600);
                    if text == "first" {
                        fs::set_permissions(&path, private).unwrap();
                    } else {
                        let mode = fs::metadata(&path).unwrap().permissions().mode();
                        assert_eq!(mode & 0o777, 0o600);
                    }
                }
            }
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn part_has_no_name_where_the_file_system_can_do_without() {
        let folder = tempfile::tempdir().unwrap();
        let part = Part::create(folder.path().join("a.tif")).unwrap();
        assert_eq!(
            matches!(part.file, PartFile::Unnamed(_)),
            unnamed::create(folder.path()).is_some()
        );
        if matches!(part.file, PartFile::Unnamed(_)) {
            assert_eq!(names(folder.path()), Vec::<String>::new());
        }
    }

    #[cfg(unix)]
    mod interrupted {
        use std::os::unix::process::ExitStatusExt;
        use std::process::{Child, Command, Stdio};
        use std::thread;
        use std::time::{Duration, Instant};

        use rustix::process::{Pid, Signal, kill_process};

        use super::*;
        use crate::interruption::Interruption;

        /// Names the folder of a program.
        const FOLDER: &str = "FMC_OUTPUT_TEST_PART";

        #[test]
        #[ignore = "a program of its own, which the next test starts and interrupts"]
        fn program_that_waits_for_a_signal() {
            let folder = PathBuf::from(std::env::var_os(FOLDER).unwrap());
            remove_on_signals();
            let mut part = Part::hidden(folder.join("a.tif")).unwrap();
            part.write_all(b"half").unwrap();
            thread::sleep(Duration::from_mins(1));
        }

        #[test]
        #[ignore = "a program of its own, which the last test starts and interrupts"]
        fn program_that_replaces_a_file_and_ends_when_it_is_asked() {
            let folder = PathBuf::from(std::env::var_os(FOLDER).unwrap());
            remove_on_signals();
            let interruption = Interruption::listen().unwrap();
            for text in ["first", "second"] {
                let mut part = Part::create(folder.join("a.tif")).unwrap();
                part.write_all(text.as_bytes()).unwrap();
                part.complete().unwrap();
            }
            let mut written = Part::hidden(folder.join("b.tif")).unwrap();
            written.write_all(b"whole").unwrap();
            let until = Instant::now() + Duration::from_mins(1);
            while !interruption.is_asked() && Instant::now() < until {
                thread::sleep(Duration::from_millis(5));
            }
            // Time for another thread to end the program.
            thread::sleep(Duration::from_millis(200));
            written.complete().unwrap();
        }

        /// Starts a test of this module as a program on a folder.
        fn start(test: &str, folder: &Path) -> Child {
            let test = format!("{}::{test}", module_path!()).replacen("fmc_output::", "", 1);
            Command::new(std::env::current_exe().unwrap())
                .args(["--ignored", "--exact", &test])
                .env(FOLDER, folder)
                .stdout(Stdio::null())
                .spawn()
                .unwrap()
        }

        fn wait_for(is_there: impl Fn() -> bool) {
            let until = Instant::now() + Duration::from_secs(30);
            while !is_there() {
                assert!(Instant::now() < until, "the program writes nothing");
                thread::sleep(Duration::from_millis(5));
            }
        }

        #[test]
        fn program_that_is_asked_to_end_ends_by_itself_after_it_has_replaced_a_file() {
            for signal in super::super::handled_signals() {
                let signal = Signal::from_named_raw(signal).unwrap();
                let folder = tempfile::tempdir().unwrap();
                let mut program = start(
                    "program_that_replaces_a_file_and_ends_when_it_is_asked",
                    folder.path(),
                );
                let is_hidden = |name: &String| name.starts_with(".host-sim-");
                wait_for(|| {
                    let names = names(folder.path());
                    names.iter().any(is_hidden)
                        && fs::read(folder.path().join("a.tif")).is_ok_and(|text| text == b"second")
                });
                kill_process(Pid::from_child(&program), signal).unwrap();
                assert_eq!(program.wait().unwrap().code(), Some(0), "{signal:?}");
                assert_eq!(names(folder.path()), ["a.tif", "b.tif"]);
                assert_eq!(fs::read(folder.path().join("b.tif")).unwrap(), b"whole");
            }
        }

        #[test]
        fn hidden_part_is_removed_by_a_signal_that_ends_the_program_as_it_does_others() {
            let signals = super::super::handled_signals();
            assert!(!signals.is_empty());
            for signal in signals.into_iter().filter_map(Signal::from_named_raw) {
                let folder = tempfile::tempdir().unwrap();
                fs::write(folder.path().join("a.tif"), "old").unwrap();
                let mut program = start("program_that_waits_for_a_signal", folder.path());
                wait_for(|| names(folder.path()).len() >= 2);
                kill_process(Pid::from_child(&program), signal).unwrap();
                let status = program.wait().unwrap();
                assert_eq!(status.signal(), Some(signal.as_raw()));
                assert_eq!(names(folder.path()), ["a.tif"]);
                assert_eq!(fs::read(folder.path().join("a.tif")).unwrap(), b"old");
            }
        }
    }
}
