//! Places of a linked image where arithmetic is checked for overflow.
//!
//! The compiler calls one function per operation, of the core library, where a check fails, and
//! hands it the address of the place in the sources. Both are read from the instructions.

use std::{
    collections::{BTreeMap, BTreeSet},
    ops::Range,
    path::Path,
};

use anyhow::{Context as _, Result};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SectionKind, SymbolKind};

use crate::{
    board::path_of,
    stack::instruction::{Effect, Instruction},
};

/// Functions that a failed check calls; the operation stands between.
const FAILED: (&str, &str) = ("core::panicking::panic_const::panic_const_", "_overflow");

/// Place in the sources where an operation is checked.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Place {
    /// Path as the compiler had it.
    pub(super) file: String,
    pub(super) line: u32,
    pub(super) column: u32,
    /// `add`, `sub`, `mul`, `neg`, `shl`, `shr`, `div` or `rem`.
    pub(super) operation: String,
}

/// Returns the places of an image, each once however often the compiler has repeated it.
///
/// # Errors
/// An error if it is not an image for Arm, or if it calls one of the functions in a way from which
/// the place cannot be read.
pub(super) fn places(elf: &[u8]) -> Result<BTreeSet<Place>> {
    Image::read(elf)?.places()
}

/// Image as the linker made it.
#[derive(Debug)]
struct Image {
    /// Ranges and names of the functions.
    functions: Vec<(Range<u32>, String)>,
    /// Operations by the address of the function that a failed check calls.
    operations: BTreeMap<u32, String>,
    /// Bytes of the sections that are read, by address.
    sections: BTreeMap<u32, Vec<u8>>,
    /// Ranges of data between instructions, in their order.
    data: Vec<Range<u32>>,
}

impl Image {
    fn read(elf: &[u8]) -> Result<Self> {
        let file = object::File::parse(elf)?;
        let address = |address: u64| u32::try_from(address).context("address over 32 bits");
        let (mut functions, mut operations) = (vec![], BTreeMap::new());
        let mut marks = BTreeMap::new();
        for symbol in file.symbols() {
            let (name, at) = (symbol.name()?, address(symbol.address())?);
            match name.get(..2) {
                // Symbols that the ABI of Arm puts between instructions and data.
                Some("$t") => drop(marks.insert(at, false)),
                Some("$d") if symbol.section_index().is_some() => drop(marks.insert(at, true)),
                _ => {}
            }
            if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
                // Bit 0 of a function's address marks Thumb code.
                let (start, name) = (at & !1, path_of(name));
                if let Some(operation) = operation(&name) {
                    operations.insert(start, operation.to_owned());
                }
                functions.push((start..start + address(symbol.size())?, name));
            }
        }
        let mut sections = BTreeMap::new();
        for section in file.sections() {
            let kind = section.kind();
            let is_read = matches!(
                kind,
                SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::ReadOnlyString
            );
            // The log's texts lie in a section that is not in the image.
            if is_read && section.name()? != ".defmt" {
                sections.insert(address(section.address())?, section.data()?.to_vec());
            }
        }
        let ends = marks.keys().skip(1).copied().chain([u32::MAX]);
        let data = marks.iter().zip(ends).filter(|((_, is_data), _)| **is_data);
        Ok(Self {
            functions,
            operations,
            sections,
            data: data.map(|((start, _), end)| *start..end).collect(),
        })
    }

    fn places(&self) -> Result<BTreeSet<Place>> {
        let mut places = BTreeSet::new();
        for (range, name) in &self.functions {
            self.add_places(range, &mut places)
                .with_context(|| format!("{name}: a check whose place is not read"))?;
        }
        Ok(places)
    }

    /// Follows the instructions of a function in their order, and what they put into registers.
    fn add_places(&self, range: &Range<u32>, places: &mut BTreeSet<Place>) -> Result<()> {
        let instructions = self.instructions(range);
        let targets: BTreeSet<u32> = instructions
            .iter()
            .filter_map(|(_, _, _, instruction)| match instruction.effect {
                Effect::Branch(to) | Effect::BranchIf(to) => Some(to),
                _ => None,
            })
            .collect();
        let mut registers = Registers::default();
        for (address, first, second, instruction) in instructions {
            if let Effect::Call(callee) | Effect::Branch(callee) = instruction.effect
                && let Some(operation) = self.operations.get(&callee)
            {
                let place = registers.0.first().copied().flatten().and_then(|constant| {
                    // Others must not come by another way, with a place of their own.
                    let mut ways = targets.range(constant.since + 1..=address);
                    let is_only = ways.next().is_none();
                    self.place(constant.value, operation).filter(|_| is_only)
                });
                places.insert(place.with_context(|| format!("at {address:#x}"))?);
            }
            match instruction.effect {
                // Behind a call, its arguments are gone; behind a branch, another way begins.
                Effect::Call(_) | Effect::CallRegister => registers.forget_arguments(),
                Effect::Branch(_)
                | Effect::BranchRegister
                | Effect::Return(_)
                | Effect::Stop
                | Effect::Table { .. } => registers = Registers::default(),
                _ => {
                    let constant = Instruction::constant(address, first, second);
                    let constant = constant.and_then(|at| self.word(at));
                    registers.follow(address, first, second, constant);
                }
            }
        }
        Ok(())
    }

    /// Returns the instructions of a function in their order, without the data between them.
    fn instructions(&self, range: &Range<u32>) -> Vec<(u32, u16, u16, Instruction)> {
        let mut instructions = vec![];
        let mut address = range.start;
        while address < range.end {
            if let Some(end) = self.end_of_data(address) {
                address = end;
                continue;
            }
            let Some(first) = self.halfword(address) else {
                break;
            };
            let second = self.halfword(address + 2).unwrap_or_default();
            let instruction = Instruction::read(address, first, second);
            instructions.push((address, first, second, instruction));
            address += instruction.bytes;
        }
        instructions
    }

    /// Reads a `core::panic::Location`: the address and the length of the file's name, line and
    /// column.
    fn place(&self, address: u32, operation: &str) -> Option<Place> {
        let [name, length, line, column] =
            [0, 4, 8, 12].map(|offset| address.checked_add(offset).and_then(|at| self.word(at)));
        let file = self.bytes(name?)?.get(..usize::try_from(length?).ok()?)?;
        let file = std::str::from_utf8(file).ok()?;
        let is_source = Path::new(file).extension().is_some_and(|end| end == "rs");
        is_source.then_some(Place {
            file: file.to_owned(),
            line: line?,
            column: column?,
            operation: operation.to_owned(),
        })
    }

    fn end_of_data(&self, address: u32) -> Option<u32> {
        let after = self.data.partition_point(|range| range.start <= address);
        let range = self.data.get(after.checked_sub(1)?)?;
        (address < range.end).then_some(range.end)
    }

    fn halfword(&self, address: u32) -> Option<u16> {
        let bytes = self.bytes(address)?.first_chunk()?;
        Some(u16::from_le_bytes(*bytes))
    }

    fn word(&self, address: u32) -> Option<u32> {
        let bytes = self.bytes(address)?.first_chunk()?;
        Some(u32::from_le_bytes(*bytes))
    }

    /// Returns the bytes of the image from an address on.
    fn bytes(&self, address: u32) -> Option<&[u8]> {
        let (start, bytes) = self.sections.range(..=address).next_back()?;
        bytes.get(usize::try_from(address - start).ok()?..)
    }
}

/// Constant in a register.
#[derive(Clone, Copy, Debug)]
struct Constant {
    value: u32,
    /// Address of the instruction that has made it, or begun to.
    since: u32,
}

/// Constants in the registers.
#[derive(Debug, Default)]
struct Registers([Option<Constant>; 16]);

impl Registers {
    /// Follows an instruction; `constant` is the word between the code that it reads.
    fn follow(&mut self, address: u32, first: u16, second: u16, constant: Option<u32>) {
        let new = |value| Constant {
            value,
            since: address,
        };
        let (register, constant) =
            if let Some((register, half, is_upper)) = Instruction::half(first, second) {
                let (half, low) = (u32::from(half), self.get(register));
                let whole = |low: Constant| Constant {
                    value: half << 16 | low.value & 0xffff,
                    ..low
                };
                (
                    register,
                    if is_upper {
                        low.map(whole)
                    } else {
                        Some(new(half))
                    },
                )
            } else if first & 0xff00 == 0x4600 {
                // MOV between registers.
                (first & 7 | first >> 4 & 8, self.get(first >> 3 & 15))
            } else if first & 0xf800 == 0x4800 {
                // LDR of a constant between the code.
                (first >> 8 & 7, constant.map(new))
            } else {
                return;
            };
        if let Some(place) = self.0.get_mut(usize::from(register)) {
            *place = constant;
        }
    }

    fn get(&self, register: u16) -> Option<Constant> {
        self.0.get(usize::from(register)).copied().flatten()
    }

    fn forget_arguments(&mut self) {
        for constant in self.0.iter_mut().take(4) {
            *constant = None;
        }
    }
}

fn operation(function: &str) -> Option<&str> {
    function.strip_prefix(FAILED.0)?.strip_suffix(FAILED.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Address of the function that a failed sum calls, and of two places in the sources.
    const FAILED_ADD: u32 = 0x200;
    const LOCATIONS: [u32; 2] = [0x300, 0x310];

    /// Image of one function at 0x100, whose data are two places in `a.rs`.
    fn image(function: &[u16]) -> Image {
        let bytes =
            |halfwords: &[u16]| halfwords.iter().flat_map(|one| one.to_le_bytes()).collect();
        let words = [0x400, 4, 7, 9, 0x400, 4, 8, 13].map(u32::to_le_bytes);
        let end = 0x100 + 2 * u32::try_from(function.len()).unwrap();
        Image {
            functions: vec![(0x100..end, "f".to_owned())],
            operations: [(FAILED_ADD, "add".to_owned())].into(),
            sections: [
                (0x100, bytes(function)),
                (LOCATIONS[0], words.concat()),
                (0x400, b"a.rs".to_vec()),
            ]
            .into(),
            data: vec![],
        }
    }

    fn lines(function: &[u16]) -> Result<Vec<u32>> {
        let places = image(function).places()?;
        assert!(
            places
                .iter()
                .all(|place| place.file == "a.rs" && place.operation == "add")
        );
        Ok(places.iter().map(|place| place.line).collect())
    }

    /// Call of [`FAILED_ADD`] from an address: BL with a distance below 2^12.
    fn call(from: u32) -> [u16; 2] {
        let distance = u16::try_from((FAILED_ADD - from - 4) / 2).unwrap();
        [0xf000, 0xf800 | distance]
    }

    #[test]
    fn each_call_has_its_place() {
        // movw r0, #0x300; bl; movw r1, #0x310; mov r0, r1; bl
        let [[a, b], [c, d]] = [call(0x104), call(0x10e)];
        let both = [0xf240, 0x3000, a, b, 0xf240, 0x3110, 0x4608, c, d];
        assert_eq!(lines(&both).unwrap(), [7, 8]);
        // The same place twice.
        let [[a, b], [c, d]] = [call(0x104), call(0x10c)];
        let twice = [0xf240, 0x3000, a, b, 0xf240, 0x3000, c, d];
        assert_eq!(lines(&twice).unwrap(), [7]);
        assert_eq!(lines(&[0x4770]).unwrap(), [0; 0]);
    }

    #[test]
    fn call_whose_place_is_not_certain_is_an_error() {
        let error = |function: &[u16]| format!("{:#}", lines(function).unwrap_err());
        // bl, without a place
        let [a, b] = call(0x100);
        assert_eq!(
            error(&[a, b]),
            "f: a check whose place is not read: at 0x100"
        );
        // movw r0, #0x304, which is none
        let [a, b] = call(0x104);
        assert!(error(&[0xf240, 0x3004, a, b]).contains("0x104"));
        // movw r0, #0x300; bl; bl: the first has used it up.
        let [[a, b], [c, d]] = [call(0x104), call(0x108)];
        assert!(error(&[0xf240, 0x3000, a, b, c, d]).contains("0x108"));
        // movw r0, #0x310; b 0x10a; movw r0, #0x300; bl, to which both lead
        let [a, b] = call(0x10a);
        let two_ways = [0xf240, 0x3010, 0xe001, 0xf240, 0x3000, a, b];
        assert!(error(&two_ways).contains("0x10a"));
    }
}
