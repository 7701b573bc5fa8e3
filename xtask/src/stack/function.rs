//! Stack of one function: how deep it is at each call, found by following every path through it.
//!
//! Two paths that meet must agree on the depth, and every return must leave none: so an instruction
//! that was read wrongly, or a stack whose size is not constant, is an error, not a wrong number.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, Result, bail, ensure};

use super::{
    image::Code,
    instruction::{Conditions, Effect, Instruction},
};

/// Instruction that does nothing and fills up to the alignment of what follows.
const NOP: u16 = 0xbf00;

/// Function as far as the stack is concerned.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Frame {
    /// Greatest depth, bytes.
    pub(super) depth: u32,
    /// Greatest depth at a call of each function.
    pub(super) calls: BTreeMap<u32, u32>,
    /// Greatest depth at a call by a pointer, if there is one.
    pub(super) by_pointer: Option<u32>,
    /// True if it replaces the stack by another one, to which all of this belongs then.
    pub(super) leaves_stack: bool,
}

/// Instruction that a path has come to.
#[derive(Clone, Copy, Debug)]
struct Step {
    address: u32,
    depth: i64,
    conditions: Conditions,
}

impl Frame {
    /// Follows every path through the function that begins at an address.
    ///
    /// # Errors
    /// An error that names the instruction whose effect on the stack is not known.
    pub(super) fn of(code: &Code, start: u32) -> Result<Self> {
        let (end, name) = code
            .function(start)
            .with_context(|| format!("no function begins at {start:#x}"))?;
        let walk = Walk {
            code,
            start,
            end,
            constants: constants(code, start, end),
            depths: BTreeMap::new(),
            open: vec![Step {
                address: start,
                depth: 0,
                conditions: Conditions::default(),
            }],
            frame: Self::default(),
        };
        walk.complete().with_context(|| name.to_owned())
    }
}

/// Paths through a function that are open.
struct Walk<'a> {
    code: &'a Code,
    start: u32,
    end: u32,
    /// Addresses of constants that the function reads from between its code.
    constants: BTreeSet<u32>,
    /// Depth at each instruction that was reached, with the conditions behind an IT.
    depths: BTreeMap<(u32, Conditions), i64>,
    open: Vec<Step>,
    frame: Frame,
}

impl Walk<'_> {
    fn complete(mut self) -> Result<Frame> {
        while let Some(step) = self.open.pop() {
            let key = (step.address, step.conditions);
            match self.depths.insert(key, step.depth) {
                None => self
                    .follow(step)
                    .with_context(|| format!("at {:#x}", step.address))?,
                Some(depth) => ensure!(
                    depth == step.depth,
                    "at {:#x} the stack is {depth} bytes deep by one path and {} by another",
                    step.address,
                    step.depth
                ),
            }
        }
        Ok(self.frame)
    }

    fn follow(&mut self, step: Step) -> Result<()> {
        let read = |address| self.code.halfword(address).context("no such code");
        ensure!(
            self.code.end_of_data(step.address).is_none(),
            "the path leads into data"
        );
        let first = read(step.address)?;
        let second = read(step.address + 2).unwrap_or_default();
        let Instruction { bytes, effect } = Instruction::read(step.address, first, second);
        let (condition, rest) = step.conditions.next();
        let next = Step {
            address: step.address + bytes,
            conditions: rest,
            ..step
        };
        let depth = u32::try_from(step.depth).context("the stack is above its start")?;
        // Both paths are open: the other one does what the instruction says.
        if condition == Some(false) {
            return self.go(next);
        }
        match effect {
            Effect::Next => self.go(next),
            Effect::Deepen(bytes) => {
                let depth = step.depth + bytes;
                self.reach(u32::try_from(depth).context("more leaves the stack than is on it")?);
                self.go(Step { depth, ..next })
            }
            Effect::IfThen(conditions) => {
                let [stated, opposite] = [conditions, conditions.opposite()]
                    .map(|conditions| Step { conditions, ..next });
                self.go(opposite)?;
                self.go(stated)
            }
            Effect::Branch(to) => self.branch(step, to, depth),
            Effect::BranchIf(to) => {
                self.branch(step, to, depth)?;
                self.go(next)
            }
            Effect::Call(to) => {
                self.call(to, depth)?;
                if self.is_code(next.address) {
                    self.go(next)
                } else {
                    // The function that was called does not return.
                    Ok(())
                }
            }
            Effect::CallRegister => {
                self.call_by_pointer(depth);
                self.go(next)
            }
            Effect::BranchRegister => {
                self.call_by_pointer(depth);
                Ok(())
            }
            Effect::Table { halfwords } => self.table(step, halfwords),
            Effect::Return(bytes) => {
                ensure!(
                    bytes == step.depth,
                    "it returns with {} bytes on the stack",
                    step.depth - bytes
                );
                Ok(())
            }
            Effect::LeaveStack => {
                ensure!(
                    self.frame == Frame::default(),
                    "it replaces a stack that it has used"
                );
                self.frame.leaves_stack = true;
                self.go(next)
            }
            Effect::Stop => Ok(()),
            Effect::Unreadable => bail!("the size of the stack is not constant"),
        }
    }

    fn go(&mut self, step: Step) -> Result<()> {
        ensure!(step.address < self.end, "the path leaves the function");
        self.open.push(step);
        Ok(())
    }

    /// Returns true if instructions of the function follow, behind those that fill up.
    fn is_code(&self, mut address: u32) -> bool {
        while self.code.halfword(address) == Some(NOP) {
            address += 2;
        }
        address < self.end && self.code.end_of_data(address).is_none()
    }

    fn reach(&mut self, depth: u32) {
        self.frame.depth = self.frame.depth.max(depth);
    }

    fn call(&mut self, to: u32, depth: u32) -> Result<()> {
        ensure!(
            self.code.function(to).is_some(),
            "it calls {to:#x}, where no function begins"
        );
        let deepest = self.frame.calls.entry(to).or_default();
        *deepest = depth.max(*deepest);
        Ok(())
    }

    fn call_by_pointer(&mut self, depth: u32) {
        self.frame.by_pointer = self.frame.by_pointer.max(Some(depth));
    }

    /// Leads on inside the function, or ends it by another one.
    fn branch(&mut self, step: Step, to: u32, depth: u32) -> Result<()> {
        if (self.start..self.end).contains(&to) {
            // No branch is behind one in a block of conditions.
            self.go(Step {
                address: to,
                conditions: Conditions::default(),
                ..step
            })
        } else {
            self.call(to, depth)
        }
    }

    /// Leads to each target of the table behind TBB or TBH.
    fn table(&mut self, step: Step, halfwords: bool) -> Result<()> {
        let table = step.address + 4;
        let code = self.code.end_of_data(table).context("no table follows")?;
        // Constants may follow the table.
        let constant = self.constants.range(table..code).next();
        let end = constant.copied().unwrap_or(code);
        ensure!(end > table, "no table follows");
        let size = if halfwords { 2 } else { 1 };
        for entry in (table..end).step_by(size) {
            let distance = if halfwords {
                u32::from(self.code.halfword(entry).context("no table follows")?)
            } else {
                let [byte] = self.code.bytes(entry).context("no table follows")?;
                u32::from(byte)
            };
            let address = table + 2 * distance;
            // A table is filled up to what follows it: by zeros, or up to constants by a NOP.
            let is_nop = end - entry == 2 && self.code.halfword(entry) == Some(NOP);
            if (address == table && end - entry < 4) || is_nop {
                break;
            }
            self.go(Step {
                address,
                conditions: Conditions::default(),
                ..step
            })?;
        }
        Ok(())
    }
}

/// Returns the addresses of the constants that a function reads from between its code.
fn constants(code: &Code, start: u32, end: u32) -> BTreeSet<u32> {
    let instructions = code.instructions(start, end);
    let constants = instructions
        .filter_map(|(address, first, second)| Instruction::constant(address, first, second));
    constants.collect()
}
