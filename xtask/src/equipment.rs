//! Equipment of the steps of `test`. Each part is set up separately, so that one that is missing
//! does not affect the others.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow};

use crate::{
    emulator::Emulator,
    machine::on_path,
    missing::Missing,
    target::{Lints, Targets},
    tools::{Tool, Toolbox},
    workspace::Workspace,
};

/// Part of the equipment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Need {
    /// A compiler for the target, its library sources and a linker.
    Compiler,
    /// The compiler's clippy, in addition to [`Self::Compiler`].
    Clippy,
    /// QEMU.
    Qemu,
    /// Gappa, which proves bounds of rounding.
    Gappa,
}

/// Parts that were requested, or the errors of those that are missing.
#[derive(Debug)]
pub(crate) struct Equipment<'a> {
    toolbox: Toolbox<'a>,
    targets: Option<Result<Targets<'a>>>,
    emulator: Option<Result<Emulator>>,
    gappa: Option<Result<PathBuf>>,
}

impl<'a> Equipment<'a> {
    /// Finds or fetches what is needed, and prints what is used.
    pub(crate) fn for_needs(workspace: &'a Workspace, needs: &[Need]) -> Self {
        let toolbox = Toolbox::new(workspace);
        let needs_emulator = needs.contains(&Need::Qemu);
        let lints = if needs.contains(&Need::Clippy) {
            Lints::Wanted
        } else {
            Lints::NotWanted
        };
        let emulator =
            needs_emulator.then(|| Emulator::set_up(workspace, &toolbox).map_err(Into::into));
        let targets = needs
            .contains(&Need::Compiler)
            .then(|| Targets::set_up(workspace, &toolbox, lints));
        let needs_gappa = needs.contains(&Need::Gappa);
        let gappa = needs_gappa.then(|| gappa(&toolbox).map_err(Into::into));
        Self {
            toolbox,
            targets,
            emulator,
            gappa,
        }
    }

    /// Returns in one line everything that is missing for these needs.
    pub(crate) fn lack(&self, needs: &[Need]) -> Option<String> {
        let lacks = needs.iter().filter_map(|need| match need {
            Need::Compiler => Some(format!("{:#}", self.targets().err()?)),
            Need::Clippy => Some(self.targets().ok()?.armv7em.no_clippy()?.to_string()),
            Need::Qemu => Some(format!("{:#}", self.emulator().err()?)),
            Need::Gappa => Some(format!("{:#}", self.gappa().err()?)),
        });
        let lacks: Vec<_> = lacks.collect();
        (!lacks.is_empty()).then(|| lacks.join("; and "))
    }

    /// Returns the targets.
    ///
    /// # Errors
    /// The error of their set-up.
    pub(crate) fn targets(&self) -> Result<&Targets<'a>> {
        part(self.targets.as_ref(), "the targets were")
    }

    /// Returns the emulator.
    ///
    /// # Errors
    /// The error of its set-up.
    pub(crate) fn emulator(&self) -> Result<&Emulator> {
        part(self.emulator.as_ref(), "the emulator was")
    }

    /// Returns the path of Gappa.
    ///
    /// # Errors
    /// The error of its set-up.
    pub(crate) fn gappa(&self) -> Result<&Path> {
        part(self.gappa.as_ref(), "Gappa was").map(PathBuf::as_path)
    }

    /// Returns the toolbox, which can fetch further tools.
    pub(crate) fn toolbox(&self) -> &Toolbox<'a> {
        &self.toolbox
    }
}

/// Finds or fetches Gappa.
fn gappa(toolbox: &Toolbox<'_>) -> Result<PathBuf, Missing> {
    match on_path("gappa") {
        Some(program) => Ok(program),
        None => Ok(toolbox.provide(Tool::Gappa)?.program("gappa")),
    }
}

fn part<'p, T>(part: Option<&'p Result<T>>, name: &str) -> Result<&'p T> {
    match part {
        Some(Ok(part)) => Ok(part),
        Some(Err(error)) => Err(anyhow!("{error:#}")),
        None => Err(anyhow!("{name} not set up")),
    }
}

#[cfg(test)]
mod tests {
    use anyhow::bail;

    use super::*;
    use crate::checks::Step;

    #[test]
    fn step_of_the_rounding_is_not_run_without_gappa() {
        let workspace = Workspace::new().unwrap();
        let with = |gappa| Equipment {
            toolbox: Toolbox::new(&workspace),
            targets: None,
            emulator: None,
            gappa: Some(gappa),
        };
        let needs = Step::Rounding.needs();
        let missing = || bail!("no network");
        assert_eq!(with(missing()).lack(needs), Some("no network".to_owned()));
        assert_eq!(with(Ok("gappa".into())).lack(needs), None);
    }
}
