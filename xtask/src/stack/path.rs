//! Deepest path through the calls of an image.

use std::collections::BTreeMap;

use anyhow::{Context as _, Result, bail, ensure};

use super::{function::Frame, image::Code, pointers::PointerCalls};

/// Deepest path from a function on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Deepest {
    /// Bytes, with the function's own.
    bytes: u32,
    /// The function that it calls next on that path, and the depth at that call.
    next: Option<(u32, u32)>,
    /// True if it is that of a stack by which the function replaces that of its caller.
    leaves_stack: bool,
}

/// Deepest paths of the functions of an image, as far as they were asked for.
#[derive(Debug)]
pub(super) struct Paths<'a> {
    code: &'a Code,
    pointers: &'a PointerCalls,
    found: BTreeMap<u32, Deepest>,
}

/// Function of a path and the bytes of stack up to its call of the next one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Station {
    pub(super) name: String,
    pub(super) bytes: u32,
}

impl<'a> Paths<'a> {
    pub(super) fn new(code: &'a Code, pointers: &'a PointerCalls) -> Self {
        Self {
            code,
            pointers,
            found: BTreeMap::new(),
        }
    }

    /// Returns the greatest depth from a function on, bytes.
    ///
    /// # Errors
    /// An error if a function's stack cannot be read, a call by a pointer has no target, or
    /// functions call each other in a circle.
    pub(super) fn deepest(&mut self, start: u32) -> Result<u32> {
        let deepest = self.deepest_behind(start, &mut Vec::new())?;
        Ok(deepest.bytes)
    }

    /// Returns true for a function that was asked for if its stack is another one than its
    /// caller's.
    pub(super) fn leaves_stack(&self, start: u32) -> bool {
        self.found
            .get(&start)
            .is_some_and(|deepest| deepest.leaves_stack)
    }

    fn deepest_behind(&mut self, start: u32, callers: &mut Vec<u32>) -> Result<Deepest> {
        if let Some(found) = self.found.get(&start) {
            return Ok(*found);
        }
        if let Some(first) = callers.iter().position(|caller| *caller == start) {
            let circle = callers.iter().skip(first).chain([&start]);
            let names: Vec<_> = circle.map(|address| self.name(*address)).collect();
            bail!(
                "functions call each other in a circle, so that the stack has no bound:\n    {}",
                names.join("\n    ")
            );
        }
        let frame = Frame::of(self.code, start)?;
        let mut calls: Vec<_> = frame.calls.into_iter().collect();
        if let Some(depth) = frame.by_pointer {
            let targets = self.pointers.targets(self.code, self.name(start))?;
            calls.extend(targets.into_iter().map(|target| (target, depth)));
        }
        let mut deepest = Deepest {
            bytes: frame.depth,
            next: None,
            leaves_stack: frame.leaves_stack,
        };
        callers.push(start);
        for (callee, depth) in calls {
            let behind = self.deepest_behind(callee, callers)?;
            ensure!(
                !behind.leaves_stack,
                "{} calls {}, which replaces the stack",
                self.name(start),
                self.name(callee)
            );
            let bytes = depth.checked_add(behind.bytes).context("over 32 bits")?;
            if bytes > deepest.bytes {
                deepest = Deepest {
                    bytes,
                    next: Some((callee, depth)),
                    ..deepest
                };
            }
        }
        callers.pop();
        self.found.insert(start, deepest);
        Ok(deepest)
    }

    /// Returns the functions of the deepest path from one that was asked for.
    pub(super) fn stations(&self, start: u32) -> Vec<Station> {
        let mut stations = Vec::new();
        let mut at = Some(start);
        while let Some(address) = at {
            let deepest = self.found.get(&address);
            let next = deepest.and_then(|deepest| deepest.next);
            stations.push(Station {
                name: self.name(address).to_owned(),
                bytes: next.map_or(deepest.map_or(0, |last| last.bytes), |(_, depth)| depth),
            });
            at = next.map(|(callee, _)| callee);
        }
        stations
    }

    /// Returns the name of the function that begins at an address.
    pub(super) fn name(&self, address: u32) -> &str {
        self.code.function(address).map_or("?", |(_, name)| name)
    }
}
