//! Functions whose addresses an image keeps: whatever is called by a pointer is one of them.

use std::collections::{BTreeMap, BTreeSet};

use super::{image::Code, instruction::Instruction};

/// Returns the functions whose addresses are in the image: as words of its data, or in the two
/// halves of which instructions make an address.
///
/// A number that happens to be the address of a function is one more.
pub(super) fn kept(code: &Code) -> BTreeSet<u32> {
    let mut values: BTreeSet<u32> = code.words().collect();
    for (start, end) in code.ranges() {
        values.extend(made(code, start, end));
    }
    let is_function = |value: &u32| value & 1 == 1 && code.function(value & !1).is_some();
    let functions = values.into_iter().filter(is_function);
    functions.map(|value| value & !1).collect()
}

/// Returns the values that instructions MOVW and MOVT put into a register; MOVW without a MOVT puts
/// those below 65,536. More than one MOVT may follow, which keep the lower half.
fn made(code: &Code, start: u32, end: u32) -> Vec<u32> {
    let mut lows: BTreeMap<u16, Low> = BTreeMap::new();
    let mut found = Vec::new();
    for (_, first, second) in code.instructions(start, end) {
        match Instruction::half(first, second) {
            Some((register, half, false)) => {
                let is_alone = true;
                let before = lows.insert(register, Low { half, is_alone });
                found.extend(before.and_then(Low::alone));
            }
            Some((register, high, true)) => {
                if let Some(low) = lows.get_mut(&register) {
                    low.is_alone = false;
                    found.push(u32::from(high) << 16 | u32::from(low.half));
                }
            }
            None => {}
        }
    }
    found.extend(lows.into_values().filter_map(Low::alone));
    found
}

/// Lower half of a register.
struct Low {
    half: u16,
    /// True until an upper half is put above it.
    is_alone: bool,
}

impl Low {
    fn alone(self) -> Option<u32> {
        self.is_alone.then(|| self.half.into())
    }
}
