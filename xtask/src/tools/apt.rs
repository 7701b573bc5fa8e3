//! Packages of the distribution, fetched by its own programs and with the machine's own settings.
//! Lists and cache are in a directory of the project, because the machine's may be old or absent,
//! and this user may not be allowed to renew them.

use std::{fs, path::PathBuf};

use anyhow::{Context as _, Result, ensure};
use xshell::{Cmd, Shell, cmd};

use super::{
    Tool, Unpacked,
    closure::{self, Package},
};

/// Prefixes of settings that are not taken from the machine: the places of lists and cache, what
/// runs before and after, and what is fetched besides the lists of packages.
const NOT_TAKEN: [&str; 9] = [
    "Acquire::Languages",
    "APT::Sandbox",
    "AptCli",
    "Dir::Cache",
    "Dir::Etc::main",
    "Dir::Etc::parts",
    "Dir::Log",
    "Dir::State",
    "DPkg",
];

/// Settings by which apt gives up a server after these seconds without an answer, after one more
/// try.
const PATIENCE: &str = "Acquire::Retries \"1\";
Acquire::http::Timeout \"20\";
Acquire::https::Timeout \"20\";
";

/// Renewed package lists.
#[derive(Debug)]
pub(super) struct Apt<'a> {
    shell: &'a Shell,
    directory: PathBuf,
    /// dpkg's status file of the machine.
    installed: String,
    /// dpkg's name of the machine's processor.
    architecture: String,
    /// Error of renewing the lists; the lists of some sources may have arrived all the same.
    fault: Option<String>,
}

impl<'a> Apt<'a> {
    /// Fetches the lists of the machine's sources.
    ///
    /// # Errors
    /// An error if the directory cannot be written.
    pub(super) fn renewed(shell: &'a Shell, directory: PathBuf) -> Result<Self> {
        for part in ["lists/partial", "cache/archives/partial", "none"] {
            let part = directory.join(part);
            fs::create_dir_all(&part).with_context(|| part.display().to_string())?;
        }
        let machine = said(cmd!(shell, "apt-config dump"))?;
        let status = value(&machine, "Dir::State::status").context("apt-config names no status")?;
        let installed = fs::read_to_string(status).with_context(|| status.to_owned())?;
        let architecture = value(&machine, "APT::Architecture");
        let architecture = architecture.context("apt-config names no architecture")?;
        let own = directory
            .to_str()
            .context("a path that is not UTF-8 text")?;
        let settings = settings(&machine, own);
        for (name, text) in [("apt.conf", settings.as_str()), ("status", "")] {
            let path = directory.join(name);
            fs::write(&path, text).with_context(|| path.display().to_string())?;
        }
        let mut apt = Self {
            shell,
            directory,
            installed,
            architecture: architecture.to_owned(),
            fault: None,
        };
        eprintln!("xtask: fetching the package lists of this system");
        // A source that fails may not be needed.
        let update = apt.configured(cmd!(shell, "apt-get --quiet update"));
        let answer = update.ignore_status().output()?;
        apt.fault = fault_of_update(&String::from_utf8_lossy(&answer.stderr));
        Ok(apt)
    }

    /// Returns the packages of a tool that are absent on this machine and in the tool on which it
    /// is based.
    ///
    /// # Errors
    /// An error if the lists do not have them.
    pub(super) fn absent(&self, tool: Tool, base: Option<&Unpacked>) -> Result<Vec<Package>> {
        let names = tool.packages();
        let first = names.first().context("a tool without packages")?;
        let shell = self.shell;
        let shown = said(self.configured(cmd!(shell, "apt-cache --no-all-versions show {first}")));
        let shown = shown.map_err(|error| self.with_fault(error))?;
        let source = closure::source_of(&shown).context("a package without a name")?;
        let mut status = closure::status(&self.installed, source);
        // An installed base has no status file of the project.
        let base = base.map(|base| fs::read_to_string(base.status()).unwrap_or_default());
        let base = base.unwrap_or_default();
        status += &base;
        let path = self.directory.join("status");
        fs::write(&path, status).with_context(|| path.display().to_string())?;
        let simulation = said(self.configured(cmd!(
            shell,
            "apt-get --quiet --simulate --no-install-recommends install {names...}"
        )));
        let mut packages = closure::installs(&simulation.map_err(|error| self.with_fault(error))?);
        // apt reinstalls a package without dependencies, because it takes it for a different one
        // from that of the lists.
        packages.retain(|package| {
            let is_there = closure::has(&self.installed, package, &self.architecture)
                || closure::has(&base, package, &self.architecture);
            !is_there || names.contains(&package.name.as_str())
        });
        ensure!(
            packages.iter().any(|package| package.name == *first),
            "apt-get would not install {first}"
        );
        Ok(packages)
    }

    /// Downloads packages and unpacks them.
    ///
    /// # Errors
    /// An error if one cannot be downloaded or unpacked completely.
    pub(super) fn unpack(&self, packages: &[Package], new: &Unpacked) -> Result<()> {
        let archives = new.directory.join("archives");
        let root = new.root();
        for directory in [&archives, &root] {
            fs::create_dir_all(directory).with_context(|| directory.display().to_string())?;
        }
        let shell = self.shell;
        let exact = packages
            .iter()
            .map(|package| format!("{}={}", package.name, package.version));
        let download = cmd!(shell, "apt-get --quiet download").args(exact);
        {
            let _archives = shell.push_dir(&archives);
            said(self.configured(download))?;
        }
        let mut status = String::new();
        let files = shell.read_dir(&archives)?;
        ensure!(
            files.len() == packages.len(),
            "{} of {} packages have come",
            files.len(),
            packages.len()
        );
        for file in files {
            said(cmd!(shell, "dpkg-deb --extract {file} {root}"))?;
            let stanza = said(cmd!(shell, "dpkg-deb --field {file}"))?;
            status += &closure::installed(&stanza);
            fs::remove_file(&file).with_context(|| file.display().to_string())?;
        }
        fs::remove_dir(&archives).with_context(|| archives.display().to_string())?;
        fs::write(new.status(), status).with_context(|| new.status().display().to_string())
    }

    fn configured<'c>(&self, command: Cmd<'c>) -> Cmd<'c> {
        command
            .env("APT_CONFIG", self.directory.join("apt.conf"))
            .env("LC_ALL", "C")
            .env("DEBIAN_FRONTEND", "noninteractive")
    }

    /// Adds the error of renewing the lists to a later error.
    fn with_fault(&self, error: anyhow::Error) -> anyhow::Error {
        match &self.fault {
            Some(fault) => error.context(format!("the package lists cannot be renewed: {fault}")),
            None => error,
        }
    }
}

/// Runs a program to its end and returns what it prints.
///
/// # Errors
/// The program's own error message, in one line.
fn said(command: Cmd<'_>) -> Result<String> {
    let name = command.to_string();
    let name = name.split_whitespace().next().unwrap_or_default();
    let answer = command
        .quiet()
        .ignore_status()
        .output()
        .with_context(|| name.to_owned())?;
    if answer.status.success() {
        return Ok(String::from_utf8_lossy(&answer.stdout).into_owned());
    }
    let stderr = String::from_utf8_lossy(&answer.stderr);
    let fault = fault(&stderr).unwrap_or_else(|| format!("it ended with {}", answer.status));
    Err(anyhow::anyhow!("{name}: {fault}"))
}

/// Returns the reason why lists were not renewed, according to apt; other warnings are not reasons.
fn fault_of_update(stderr: &str) -> Option<String> {
    let lines = stderr.lines().filter(|line| {
        line.starts_with("E: ") || line.starts_with("W: Failed") || line.starts_with("W: Some")
    });
    fault(&lines.collect::<Vec<_>>().join("\n"))
}

/// Returns the first error, or else the first warning, that apt or dpkg names.
fn fault(stderr: &str) -> Option<String> {
    let first = |mark: &str| stderr.lines().find_map(|line| line.strip_prefix(mark));
    let other = || stderr.lines().rfind(|line| line.starts_with("dpkg"));
    let fault = first("E: ").or_else(|| first("W: ")).or_else(other)?;
    Some(fault.trim().to_owned())
}

/// Returns the value of a setting in `apt-config dump`.
fn value<'a>(dump: &'a str, key: &str) -> Option<&'a str> {
    let line = dump
        .lines()
        .find_map(|line| line.strip_prefix(key)?.strip_prefix(' '))?;
    Some(line.trim_matches(['"', ';']))
}

/// Returns the machine's settings, some of them replaced by the project's own.
fn settings(machine: &str, own: &str) -> String {
    let is_taken = |line: &&str| {
        let key = line.split_whitespace().next().unwrap_or_default();
        let is_list = key.starts_with("Acquire::IndexTargets") && !key.contains("::Packages");
        !is_list && !key.contains("Invoke") && !NOT_TAKEN.iter().any(|start| key.starts_with(start))
    };
    let taken: Vec<_> = machine.lines().filter(is_taken).collect();
    format!(
        "{}
Acquire::Languages \"none\";
APT::Sandbox::User \"root\";
{PATIENCE}Dir::Cache \"{own}/cache\";
Dir::Cache::srcpkgcache \"\";
Dir::Etc::main \"{own}/none/apt.conf\";
Dir::Etc::parts \"{own}/none\";
Dir::Log \"{own}\";
Dir::State \"{own}\";
Dir::State::status \"{own}/status\";
",
        taken.join("\n")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: &str = "APT \"\";
APT::Update::Post-Invoke \"\";
APT::Update::Post-Invoke:: \"rm -f /var/cache/apt/archives/*.deb\";
APT::NeverAutoRemove:: \"^linux-.*\";
Acquire::http::Proxy \"http://proxy:3142\";
Acquire::Languages:: \"de\";
Acquire::IndexTargets::deb::Packages::MetaKey \"main/binary/Packages\";
Acquire::IndexTargets::deb::DEP-11::MetaKey \"main/dep11/Components\";
DPkg::Post-Invoke:: \"true\";
Dir \"/\";
Dir::State \"var/lib/apt\";
Dir::State::status \"/var/lib/dpkg/status\";
Dir::Cache::pkgcache \"var/cache/pkgcache.bin\";
Dir::Etc::parts \"apt.conf.d\";
Dir::Etc::sourceparts \"sources.list.d\";
";

    #[test]
    fn sources_and_proxies_are_the_machines_and_directories_and_hooks_are_not() {
        let settings = settings(MACHINE, "/p/target/tools/apt");
        for taken in [
            "Acquire::http::Proxy \"http://proxy:3142\";",
            "APT::NeverAutoRemove:: \"^linux-.*\";",
            "Dir::Etc::sourceparts \"sources.list.d\";",
            "Packages::MetaKey",
        ] {
            assert!(settings.contains(taken), "{taken}");
        }
        for other in ["Invoke", "dep11", "var/lib", "\"de\"", "apt.conf.d"] {
            assert!(!settings.contains(other), "{other}");
        }
        for key in ["Dir::State", "Dir::State::status", "Dir::Cache", "Dir::Log"] {
            let path = value(&settings, key).unwrap();
            assert!(path.starts_with("/p/target/tools/apt"), "{key}: {path}");
        }
    }

    #[test]
    fn fault_is_the_first_error_else_the_first_warning() {
        let text = "W: Failed to fetch http://a\nE: Unable to locate package rustc-web\nE: more\n";
        assert_eq!(fault(text).unwrap(), "Unable to locate package rustc-web");
        assert_eq!(
            fault("Ign:1 x\nW: Failed to fetch http://a\n").unwrap(),
            "Failed to fetch http://a"
        );
        assert_eq!(
            fault("dpkg-deb: error: no space left on device\n").unwrap(),
            "dpkg-deb: error: no space left on device"
        );
        assert_eq!(fault("all is well\n"), None);
    }

    #[test]
    fn warning_that_keeps_no_list_away_is_no_fault() {
        let warning = "W: http://deb: Key is stored in legacy trusted.gpg keyring\n";
        assert_eq!(fault_of_update(warning), None);
        let text = format!("{warning}W: Failed to fetch http://a\n");
        assert_eq!(fault_of_update(&text).unwrap(), "Failed to fetch http://a");
    }

    #[test]
    fn program_that_fails_is_told_in_a_line() {
        let shell = Shell::new().unwrap();
        let text = said(cmd!(shell, "cargo no-such-command")).unwrap_err();
        assert!(text.to_string().contains("cargo"), "{text}");
        assert_eq!(text.to_string().lines().count(), 1);
        assert!(said(cmd!(shell, "no-such-program")).is_err());
    }
}
