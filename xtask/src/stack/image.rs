//! Code of a linked image: its functions, its instructions and its vectors.

use std::{
    collections::{BTreeMap, BTreeSet},
    iter,
    ops::Range,
};

use anyhow::{Context as _, Result, ensure};
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SectionKind, SymbolKind};

use super::{instruction::Instruction, memory::Memory};
use crate::board::path_of;

/// Image as the linker made it.
#[derive(Debug)]
pub(super) struct Code {
    /// Names and ends of the functions, by address.
    functions: BTreeMap<u32, (u32, String)>,
    /// Bytes of the sections that the processor reads, by address.
    sections: BTreeMap<u32, Section>,
    /// Ranges of data between instructions.
    data: Vec<Range<u32>>,
    /// Words of the vector table, without the first, which is the stack pointer's.
    vectors: Vec<u32>,
    memory: Memory,
}

/// Section of an image.
#[derive(Debug)]
struct Section {
    bytes: Vec<u8>,
    is_code: bool,
    is_vectors: bool,
}

impl Code {
    /// Reads an ELF.
    ///
    /// # Errors
    /// An error if it is not one of a microcontroller with vectors and a stack.
    pub(super) fn read(elf: &[u8]) -> Result<Self> {
        let file = object::File::parse(elf)?;
        let address = |address: u64| u32::try_from(address).context("address over 32 bits");
        let mut functions = BTreeMap::new();
        let mut marks = BTreeMap::new();
        for symbol in file.symbols() {
            let name = symbol.name()?;
            let at = address(symbol.address())?;
            match name.get(..2) {
                // Symbols that the ABI of Arm puts between instructions and data.
                Some("$t") => drop(marks.insert(at, false)),
                Some("$d") if symbol.section_index().is_some() => drop(marks.insert(at, true)),
                _ => {}
            }
            if symbol.kind() == SymbolKind::Text && symbol.size() > 0 {
                // Bit 0 of a function's address marks Thumb code.
                let end = address(symbol.address() - symbol.address() % 2 + symbol.size())?;
                functions.insert(at & !1, (end, path_of(name)));
            }
        }
        let mut sections = BTreeMap::new();
        let mut vectors = Vec::new();
        for section in file.sections() {
            let is_read = matches!(
                section.kind(),
                SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::Data
            );
            if is_read && section.size() > 0 {
                let bytes = section.data()?.to_vec();
                let is_vectors = section.name()? == ".vector_table";
                if is_vectors {
                    let words = bytes
                        .as_chunks()
                        .0
                        .iter()
                        .map(|word| u32::from_le_bytes(*word));
                    vectors = words.skip(1).collect();
                }
                let is_code = section.kind() == SectionKind::Text;
                let section_address = address(section.address())?;
                let section = Section {
                    bytes,
                    is_code,
                    is_vectors,
                };
                sections.insert(section_address, section);
            }
        }
        ensure!(!vectors.is_empty(), "the image has no vectors");
        let ends = marks.keys().skip(1).copied().chain([u32::MAX]);
        let data = marks
            .iter()
            .zip(ends)
            .filter(|((_, is_data), _)| **is_data)
            .map(|((start, _), end)| *start..end)
            .collect();
        Ok(Self {
            functions,
            sections,
            data,
            vectors,
            memory: Memory::read(&file)?,
        })
    }

    /// Makes code of functions `f0`, `f1` and so on, of which the first is that of the reset, with
    /// 212 bytes for the stack.
    #[cfg(test)]
    pub(super) fn of_functions(start: u32, spacing: u32, functions: &[&[u16]]) -> Self {
        let mut code = Self {
            functions: BTreeMap::new(),
            sections: BTreeMap::new(),
            data: vec![],
            vectors: vec![start | 1],
            memory: Memory {
                guard: Some(0x2000_0000..0x2000_0020),
                stack: 0x2000_0020..0x2000_00f4,
                statics: vec![],
            },
        };
        for ((index, halfwords), address) in functions
            .iter()
            .enumerate()
            .zip((start..).step_by(spacing as usize))
        {
            let bytes: Vec<u8> = halfwords.iter().flat_map(|one| one.to_le_bytes()).collect();
            let end = address + u32::try_from(bytes.len()).unwrap();
            code.functions.insert(address, (end, format!("f{index}")));
            let section = Section {
                bytes,
                is_code: true,
                is_vectors: false,
            };
            code.sections.insert(address, section);
        }
        code
    }

    /// Adds the vector of a handler.
    #[cfg(test)]
    pub(super) fn with_handler(mut self, address: u32) -> Self {
        self.vectors.push(address | 1);
        self
    }

    /// Makes a range data.
    #[cfg(test)]
    pub(super) fn with_data(mut self, data: Range<u32>) -> Self {
        self.data.push(data);
        self
    }

    /// Returns the functions that the vectors name, without the reset's.
    pub(super) fn handlers(&self) -> BTreeSet<u32> {
        let vectors = self.vectors.iter().skip(1).filter(|vector| **vector != 0);
        vectors.map(|vector| vector & !1).collect()
    }

    /// Returns the function of the reset.
    pub(super) fn reset(&self) -> Option<u32> {
        self.vectors.first().map(|vector| vector & !1)
    }

    /// Returns the handler of the non-maskable interrupt.
    pub(super) fn non_maskable(&self) -> Option<u32> {
        self.vectors.get(1).map(|vector| vector & !1)
    }

    /// Returns the memory for the stack.
    pub(super) fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Returns the end and the name of the function that begins at an address.
    pub(super) fn function(&self, address: u32) -> Option<(u32, &str)> {
        let (end, name) = self.functions.get(&address)?;
        Some((*end, name))
    }

    /// Returns the address and the name of every function.
    pub(super) fn functions(&self) -> impl Iterator<Item = (u32, &str)> {
        self.functions
            .iter()
            .map(|(address, (_, name))| (*address, name.as_str()))
    }

    /// Returns the addresses between which each function is.
    pub(super) fn ranges(&self) -> impl Iterator<Item = (u32, u32)> {
        self.functions
            .iter()
            .map(|(start, (end, _))| (*start, *end))
    }

    /// Returns the instructions between two addresses in their order, without the data between
    /// them: the address of each, its first halfword and the one behind.
    pub(super) fn instructions(
        &self,
        start: u32,
        end: u32,
    ) -> impl Iterator<Item = (u32, u16, u16)> {
        let mut address = start;
        iter::from_fn(move || {
            while let Some(end_of_data) = self.end_of_data(address) {
                address = end_of_data;
            }
            let at = address;
            let first = self.halfword(at).filter(|_| at < end)?;
            let second = self.halfword(at + 2).unwrap_or_default();
            address += Instruction::read(at, first, second).bytes;
            Some((at, first, second))
        })
    }

    /// Returns the words of the image outside its instructions and vectors.
    pub(super) fn words(&self) -> impl Iterator<Item = u32> {
        let sections = self
            .sections
            .iter()
            .filter(|(_, section)| !section.is_vectors);
        let words = sections.flat_map(|(start, section)| {
            let words = section.bytes.as_chunks().0.iter();
            let addresses = (*start..).step_by(4);
            let words = addresses.zip(words.map(|word| u32::from_le_bytes(*word)));
            words.filter(|(address, _)| !section.is_code || self.end_of_data(*address).is_some())
        });
        words.map(|(_, word)| word)
    }

    /// Returns the halfword at an address.
    pub(super) fn halfword(&self, address: u32) -> Option<u16> {
        let [low, high] = self.bytes(address)?;
        Some(u16::from_le_bytes([low, high]))
    }

    /// Returns the end of the data that an address is in.
    pub(super) fn end_of_data(&self, address: u32) -> Option<u32> {
        // Ranges are in the order of their addresses.
        let after = self.data.partition_point(|range| range.start <= address);
        let range = self.data.get(after.checked_sub(1)?)?;
        (address < range.end).then_some(range.end)
    }

    /// Returns bytes of the image.
    pub(super) fn bytes<const N: usize>(&self, address: u32) -> Option<[u8; N]> {
        let (start, section) = self.sections.range(..=address).next_back()?;
        let from = usize::try_from(address - start).ok()?;
        section.bytes.get(from..)?.first_chunk().copied()
    }
}
