//! Equipment of the steps of `test`. Each part is set up separately, so that one that is missing
//! does not affect the others.

use anyhow::{Result, anyhow};

use crate::{
    emulator::Emulator,
    target::{Lints, Targets},
    tools::Toolbox,
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
}

/// Parts that were requested, or the errors of those that are missing.
#[derive(Debug)]
pub(crate) struct Equipment<'a> {
    toolbox: Toolbox<'a>,
    targets: Option<Result<Targets<'a>>>,
    emulator: Option<Result<Emulator>>,
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
        Self {
            toolbox,
            targets,
            emulator,
        }
    }

    /// Returns in one line everything that is missing for these needs.
    pub(crate) fn lack(&self, needs: &[Need]) -> Option<String> {
        let lacks = needs.iter().filter_map(|need| match need {
            Need::Compiler => Some(format!("{:#}", self.targets().err()?)),
            Need::Clippy => Some(self.targets().ok()?.armv7em.no_clippy()?.to_string()),
            Need::Qemu => Some(format!("{:#}", self.emulator().err()?)),
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

    /// Returns the toolbox, which can fetch further tools.
    pub(crate) fn toolbox(&self) -> &Toolbox<'a> {
        &self.toolbox
    }
}

fn part<'p, T>(part: Option<&'p Result<T>>, name: &str) -> Result<&'p T> {
    match part {
        Some(Ok(part)) => Ok(part),
        Some(Err(error)) => Err(anyhow!("{error:#}")),
        None => Err(anyhow!("{name} not set up")),
    }
}
