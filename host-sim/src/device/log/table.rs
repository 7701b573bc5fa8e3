//! The format strings of a firmware's log. defmt leaves them in the image, as names of symbols: a
//! symbol's address is the number that stands for its string in a frame.

use std::collections::BTreeMap;

use object::{Object, ObjectSection, ObjectSymbol};
use serde::Deserialize;

/// Versions of defmt's frames that this program reads, as a symbol of the image names them.
const VERSIONS: [&str; 2] = ["3", "4"];

/// Format strings and interned strings, by their numbers.
#[derive(Debug, Default)]
pub(super) struct Table {
    entries: BTreeMap<u64, Entry>,
    timestamp: Option<String>,
}

/// Meaning of a number in a frame.
#[derive(Debug)]
pub(super) struct Entry {
    /// `None` for a line that is printed without a level, and for a part of a line.
    pub(super) level: Option<&'static str>,
    /// `true` if it is the format of a value that formats itself.
    pub(super) is_value: bool,
    /// The format string, or the interned string.
    pub(super) text: String,
}

/// Content of a symbol's name.
#[derive(Deserialize)]
struct Name {
    tag: String,
    data: String,
}

impl Table {
    /// Returns the strings of an image; `None` where it has none, or those of an unknown version or
    /// encoding of frames.
    pub(super) fn parse(elf: &[u8]) -> Option<Self> {
        let elf = object::File::parse(elf).ok()?;
        let section = elf.section_by_name(".defmt")?.index();
        let mut table = Self::default();
        let mut is_understood = [false; 2];
        for symbol in elf.symbols() {
            let Ok(name) = symbol.name() else { continue };
            // LLD keeps the quotes of the linker script.
            let plain = name.trim_matches('"');
            if let Some(version) = plain.strip_prefix("_defmt_version_ = ") {
                is_understood[0] = VERSIONS.contains(&version);
            } else if let Some(encoding) = plain.strip_prefix("_defmt_encoding_ = ") {
                is_understood[1] = encoding == "rzcobs";
            } else if symbol.section_index() == Some(section)
                && let Ok(name) = serde_json::from_str(name)
            {
                table.insert(symbol.address(), name);
            }
        }
        (is_understood == [true; 2]).then_some(table)
    }

    fn insert(&mut self, number: u64, Name { tag, data }: Name) {
        let level = match &*tag {
            "defmt_timestamp" => {
                self.timestamp = Some(data);
                return;
            }
            "defmt_trace" => Some("TRACE"),
            "defmt_debug" => Some("DEBUG"),
            "defmt_info" => Some("INFO"),
            "defmt_warn" => Some("WARN"),
            "defmt_error" => Some("ERROR"),
            _ => None,
        };
        let is_value = matches!(&*tag, "defmt_derived" | "defmt_prim");
        let entry = Entry {
            level,
            is_value,
            text: data,
        };
        self.entries.insert(number, entry);
    }

    /// Returns the entry of a number.
    pub(super) fn get(&self, number: u16) -> Option<&Entry> {
        self.entries.get(&number.into())
    }

    /// Returns the format strings of lines, of values in them and of the time, without the strings
    /// that are parts of some.
    pub(super) fn formats(&self) -> impl Iterator<Item = &str> {
        let entries = self.entries.values();
        entries
            .filter(|entry| entry.level.is_some() || entry.is_value)
            .map(|entry| entry.text.as_str())
            .chain(self.timestamp())
    }

    /// Returns the format of the time that begins every frame, if there is one.
    pub(super) fn timestamp(&self) -> Option<&str> {
        self.timestamp.as_deref()
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Returns a table of these symbols, each with its tag and data.
    pub(in crate::device::log) fn table(symbols: &[(u64, &str, &str)]) -> Table {
        Table::parse(&image(symbols, ["4", "rzcobs"])).unwrap()
    }

    /// Returns a little-endian ELF of 32 bits with a section `.defmt` and symbols in it.
    pub(in crate::device::log) fn image(
        symbols: &[(u64, &str, &str)],
        [version, encoding]: [&str; 2],
    ) -> Vec<u8> {
        const HEADER: usize = 52;
        const DEFMT: u16 = 1;
        const ABSOLUTE: u16 = 0xfff1;
        let name = |tag: &str, data: &str| {
            serde_json::json!({"package": "p", "tag": tag, "data": data, "disambiguator": "1"})
                .to_string()
        };
        let mut names = vec![
            (0, format!("\"_defmt_version_ = {version}\""), ABSOLUTE),
            (0, format!("_defmt_encoding_ = {encoding}"), ABSOLUTE),
            (7, "main".to_owned(), ABSOLUTE),
        ];
        names.extend(
            symbols
                .iter()
                .map(|(at, tag, data)| (*at, name(tag, data), DEFMT)),
        );
        let word = |value: usize| u32::try_from(value).unwrap().to_le_bytes();
        let mut strings = b"\0.defmt\0.symtab\0.strtab\0".to_vec();
        let mut table = vec![0; 16];
        for (address, name, section) in names {
            table.extend(word(strings.len()));
            table.extend(u32::try_from(address).unwrap().to_le_bytes());
            table.extend([0; 4]);
            table.extend([0x11, 0]);
            table.extend(section.to_le_bytes());
            strings.extend(name.as_bytes());
            strings.push(0);
        }
        strings.resize(strings.len().next_multiple_of(4), 0);
        // Name, type, offset, size and link of each section.
        let sections = [
            [0; 5],
            [1, 1, HEADER, 0, 0],
            [8, 2, HEADER, table.len(), 3],
            [16, 3, HEADER + table.len(), strings.len(), 0],
        ];
        let mut elf = b"\x7fELF\x01\x01\x01".to_vec();
        elf.resize(16, 0);
        elf.extend([2, 0, 40, 0, 1, 0, 0, 0]);
        elf.extend(
            [
                word(0),
                word(0),
                word(HEADER + table.len() + strings.len()),
                word(0),
            ]
            .concat(),
        );
        elf.extend([52, 0, 0, 0, 0, 0, 40, 0, 4, 0, 3, 0]);
        assert_eq!(elf.len(), HEADER);
        elf.extend(table);
        elf.extend(strings);
        for [name, kind, offset, size, link] in sections {
            let entry = if kind == 2 { 16 } else { 0 };
            let fields = [name, kind, 0, 0, offset, size, link, 0, 1, entry];
            elf.extend(fields.map(word).concat());
        }
        elf
    }

    #[test]
    fn symbols_of_the_section_are_found_by_their_addresses() {
        let table = table(&[
            (1, "defmt_info", "started"),
            (2, "defmt_str", "name"),
            (3, "defmt_println", "plain"),
            (9, "defmt_timestamp", "{=u32:us}"),
        ]);
        for (number, level, text) in [
            (1, Some("INFO"), "started"),
            (2, None, "name"),
            (3, None, "plain"),
        ] {
            let entry = table.get(number).unwrap();
            assert_eq!((entry.level, &*entry.text), (level, text));
        }
        assert!(table.get(7).is_none() && table.get(9).is_none());
        assert_eq!(table.timestamp(), Some("{=u32:us}"));
    }

    #[test]
    fn image_of_another_version_or_encoding_has_no_table() {
        let symbols = [(1, "defmt_info", "started")];
        assert!(Table::parse(&image(&symbols, ["3", "rzcobs"])).is_some());
        assert!(Table::parse(&image(&symbols, ["5", "rzcobs"])).is_none());
        assert!(Table::parse(&image(&symbols, ["4", "raw"])).is_none());
        let image = image(&symbols, ["4", "rzcobs"]);
        for length in 0..image.len() {
            assert!(Table::parse(&image[..length]).is_none(), "{length}");
        }
    }
}
