//! Memory for the stack, and the guard below it, by the linker's symbols.

use std::ops::Range;

use anyhow::{Context as _, Result, ensure};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SectionFlags, elf};

/// Places of guard, stack and statics of an image.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    /// Memory that a full stack meets; `None` without the symbol `_stack_guard`.
    pub(super) guard: Option<Range<u32>>,
    pub(super) stack: Range<u32>,
    /// Names and addresses of the sections that the processor writes.
    pub(super) statics: Vec<(String, u32)>,
}

impl Memory {
    /// Reads the places of an ELF.
    ///
    /// # Errors
    /// An error if it has no stack.
    pub(super) fn read(file: &object::File<'_>) -> Result<Self> {
        let address = |address: u64| u32::try_from(address).context("address over 32 bits");
        let symbol = |name: &str| {
            let symbol = file.symbol_by_name(name);
            symbol.map(|symbol| address(symbol.address())).transpose()
        };
        let start = symbol("_stack_start")?.context("no symbol _stack_start")?;
        let end = symbol("_stack_end")?.context("no symbol _stack_end")?;
        ensure!(end <= start, "the stack ends above its start");
        let guard = symbol("_stack_guard")?;
        let mut statics = Vec::new();
        for section in file.sections().filter(|section| section.size() > 0) {
            let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
                continue;
            };
            let flags = elf::SHF_ALLOC | elf::SHF_WRITE;
            if sh_flags & flags == flags {
                statics.push((section.name()?.to_owned(), address(section.address())?));
            }
        }
        Ok(Self {
            guard: guard.map(|guard| guard..end),
            stack: end..start,
            statics,
        })
    }

    /// Returns the bytes for the stack.
    pub(super) fn room(&self) -> u32 {
        self.stack.end - self.stack.start
    }

    /// Checks that a stack that is full meets a guard, that no statics are below it, and that the
    /// guard is large enough for the handler of that fault, whose stack it is.
    pub(super) fn check_guard(&self, own_bytes: u32) -> Result<()> {
        let guard = self.guard.as_ref();
        let guard = guard.context("the image has no guard below its stack (_stack_guard)")?;
        let below = self
            .statics
            .iter()
            .find(|(_, start)| *start < self.stack.end);
        if let Some((name, start)) = below {
            anyhow::bail!("section {name} at {start:#x} is not above the stack");
        }
        ensure!(
            guard.start < guard.end && own_bytes <= guard.end - guard.start,
            "the handler of a full stack needs {own_bytes} bytes, and the guard has {}",
            guard.end.saturating_sub(guard.start)
        );
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::Memory;

    #[test]
    fn stack_without_a_guard_or_above_statics_or_with_a_small_guard_is_refused() {
        let memory = Memory {
            guard: Some(0x2000_0000..0x2000_0400),
            stack: 0x2000_0400..0x2000_8000,
            statics: vec![(".data".to_owned(), 0x2000_8000)],
        };
        assert!(memory.check_guard(1024).is_ok());
        assert!(memory.check_guard(1025).is_err());
        let unguarded = Memory {
            guard: None,
            ..memory.clone()
        };
        let error = unguarded.check_guard(0).unwrap_err().to_string();
        assert!(error.contains("no guard"), "{error}");
        let statics = vec![(".bss".to_owned(), 0x2000_0000)];
        let error = Memory { statics, ..memory }.check_guard(0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "section .bss at 0x20000000 is not above the stack"
        );
    }
}
