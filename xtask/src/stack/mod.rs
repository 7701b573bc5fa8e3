//! Bound of the stack of an image, from the code that is run.
//!
//! The deepest path of the main loop, and every handler on top of it: more than can happen, since
//! no interrupt of these images has a priority over another one. Nothing is run, so that no
//! request, setting or moment can go deeper. What is measured in QEMU is compared with it
//! ([`crate::bench`]).

mod addresses;
mod function;
mod image;
pub(crate) mod instruction;
mod memory;
mod path;
mod pointers;
#[cfg(test)]
mod specimen;

use std::{fmt, fs, path::Path};

use anyhow::{Context as _, Result, bail, ensure};

use image::Code;
use memory::Memory;
use path::{Paths, Station};
use pointers::{LIST, PointerCalls};

/// Bytes that the processor puts on the stack before a handler: 26 registers, with those of the
/// floating-point unit (ARM DDI 0403, B1.5.6), and one word that aligns them.
pub(crate) const EXCEPTION_FRAME_BYTES: u32 = 4 * (26 + 1);

/// Least part of the memory for the stack that the bound leaves free.
const MARGIN: f64 = 0.25;

/// Least ratio of the stack that was used to the bound: a looser bound tells little.
pub(crate) const TIGHT: f64 = 0.9;

/// Bound of the stack of an image.
#[derive(Debug)]
pub(crate) struct StackBound {
    /// Deepest path of the main loop, from the reset on.
    main: Vec<Station>,
    /// Handlers with the depth of each.
    handlers: Vec<Station>,
    /// Handlers with a stack of their own, which is the guard below the other one, and the depth of
    /// each with the non-maskable interrupt on top.
    on_guard: Vec<Station>,
    memory: Memory,
}

impl StackBound {
    /// Bounds the stack of an image.
    ///
    /// # Errors
    /// An error that names the function if the size of its stack is not constant, if it calls by a
    /// pointer without a listed target, or if functions call each other in a circle.
    pub(crate) fn of(root: &Path, image: &Path) -> Result<Self> {
        Self::with_code(root, image).map(|(bound, _)| bound)
    }

    /// Bounds the stack of an image, and returns its code too.
    fn with_code(root: &Path, image: &Path) -> Result<(Self, Code)> {
        let elf = fs::read(image).with_context(|| image.display().to_string())?;
        let read = || -> Result<_> {
            let code = Code::read(&elf)?;
            let bound = Self::of_code(&code, &PointerCalls::read(root)?)?;
            Ok((bound, code))
        };
        read().with_context(|| format!("stack of {}", image.display()))
    }

    fn of_code(code: &Code, pointers: &PointerCalls) -> Result<Self> {
        let mut paths = Paths::new(code, pointers);
        let reset = code.reset().context("no vector of the reset")?;
        paths.deepest(reset)?;
        ensure!(
            !paths.leaves_stack(reset),
            "the reset replaces the main stack"
        );
        let non_maskable = match code.non_maskable() {
            Some(handler) => paths.deepest(handler)? + EXCEPTION_FRAME_BYTES,
            None => 0,
        };
        let (mut handlers, mut on_guard) = (Vec::new(), Vec::new());
        for handler in code.handlers() {
            let depth = paths.deepest(handler)?;
            let name = || paths.name(handler).to_owned();
            let on_stack = if paths.leaves_stack(handler) {
                on_guard.push(Station {
                    name: name(),
                    bytes: depth + non_maskable,
                });
                0
            } else {
                depth
            };
            handlers.push(Station {
                name: name(),
                bytes: on_stack + EXCEPTION_FRAME_BYTES,
            });
        }
        let unlisted: Vec<_> = addresses::kept(code)
            .into_iter()
            .filter(|address| *address != reset && !code.handlers().contains(address))
            .map(|address| paths.name(address))
            .filter(|name| !pointers.are_to(code, name))
            .collect();
        ensure!(
            unlisted.is_empty(),
            "the image has the addresses of functions that {LIST} does not list as targets:\n    {}",
            unlisted.join("\n    ")
        );
        Ok(Self {
            main: paths.stations(reset),
            handlers,
            on_guard,
            memory: code.memory().clone(),
        })
    }

    /// Returns the bytes of the main loop and of every handler on top.
    pub(crate) fn bytes(&self) -> u32 {
        let stations = self.main.iter().chain(&self.handlers);
        stations.map(|station| station.bytes).sum()
    }

    /// Checks that the memory for the stack is large enough, with a margin.
    fn check_room(&self) -> Result<()> {
        let room = self.memory.room();
        let most = (1.0 - MARGIN) * f64::from(room);
        ensure!(
            f64::from(self.bytes()) <= most,
            "the stack may be {} bytes deep, more than {most:.0} of its {room} bytes of memory:\n{self}",
            self.bytes(),
        );
        Ok(())
    }

    /// Checks that a stack that is full meets a guard, on which a handler of its own goes on.
    fn check_guard(&self) -> Result<()> {
        let needed = self.on_guard.iter().map(|handler| handler.bytes).max();
        let needed = needed.context("no handler has a stack of its own, which a full one needs")?;
        self.memory.check_guard(needed)
    }

    /// Compares the bound with the stack that was used.
    ///
    /// # Errors
    /// An error if more was used than the bound, or much less.
    pub(crate) fn check_used(&self, used: u64) -> Result<()> {
        let bound = u64::from(self.bytes());
        ensure!(
            used <= bound,
            "{used} bytes of stack were used, more than the bound:\n{self}"
        );
        // Of numbers below 2^32 the products are exact.
        let least = TIGHT * f64::from(self.bytes());
        ensure!(
            u32::try_from(used).is_ok_and(|used| f64::from(used) >= least),
            "{used} bytes of stack were used, less than {least:.0}: \
            either the deepest request was not made, or the bound is loose:\n{self}"
        );
        Ok(())
    }
}

impl fmt::Display for StackBound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Station { name, bytes } in &self.main {
            writeln!(f, "    {bytes:6} {name}")?;
        }
        for Station { name, bytes } in &self.handlers {
            writeln!(f, "    {bytes:6} {name} on top")?;
        }
        write!(f, "    {:6} of {} bytes", self.bytes(), self.memory.room())?;
        for Station { name, bytes } in &self.on_guard {
            write!(f, "\n    {bytes:6} {name} on the guard")?;
        }
        Ok(())
    }
}

/// Bounds the stack of an image, and shows that the bound depends on the list of pointers.
///
/// # Errors
/// As [`StackBound::of`], or an error if the stack may leave its memory with less than a quarter of
/// it to spare, or has no guard below it.
pub(crate) fn check(root: &Path, image: &Path) -> Result<()> {
    let (bound, code) = StackBound::with_code(root, image)?;
    eprintln!("stack of {}:\n{bound}", image.display());
    bound.check_room()?;
    bound.check_guard()?;
    ensure!(
        StackBound::of_code(&code, &PointerCalls::NONE).is_err(),
        "the stack has a bound without {LIST}, although the image calls by pointers: the check is blind"
    );
    Ok(())
}

/// Shows that the stack of an image has no bound because of a function that calls itself.
///
/// # Errors
/// An error if it has a bound, or none for another reason.
pub(crate) fn check_recursion(root: &Path, image: &Path, function: &str) -> Result<()> {
    let Err(error) = StackBound::of(root, image) else {
        bail!(
            "the stack of {} has a bound, although {function} calls itself: the check is blind",
            image.display()
        );
    };
    let text = format!("{error:#}");
    let is_found = text.contains("in a circle") && text.ends_with(&format!("    {function}"));
    ensure!(is_found, "{text}");
    eprintln!("{text}\nexpected: the drills overflow the stack");
    Ok(())
}
