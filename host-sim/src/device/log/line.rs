//! A frame of the firmware's log as a line of text.
//!
//! The numbers, strings, characters and truth values that defmt writes are shown, with the hints
//! for numbers and seconds, and so are structures, enums and arrays of the library
//! (`defmt::Format`, as it is derived). Of a frame with other arguments (slices, bit fields) only
//! the level and the format string are shown.

use defmt_parser::{Fragment, Parameter, ParserMode, Type};

use super::argument::Argument;
use super::table::Table;

/// Largest number of zeros that the encoding adds to a frame.
const MOST_FILLED: usize = 6;

/// Largest number of elements of an array: a format that says more is damaged.
const LONGEST_ARRAY: usize = 1024;

/// Bytes of a frame, whose arguments are taken from the front.
struct Reader<'a> {
    bytes: &'a [u8],
    table: &'a Table,
}

/// Returns the line of a frame, given encoded and without the zeros around it; `None` for a frame
/// that cannot be read.
pub(super) fn decode(table: &Table, frame: &[u8]) -> Option<String> {
    let bytes = rzcobs::decode(frame).ok()?;
    let mut reader = Reader {
        bytes: &bytes,
        table,
    };
    let entry = table.get(u16::from_le_bytes(reader.take()?))?;
    let mut line = String::new();
    if let Some(timestamp) = table.timestamp() {
        line = reader.text(timestamp)? + " ";
    }
    if let Some(level) = entry.level {
        line += level;
        line.push(' ');
    }
    if !is_shown(&entry.text) {
        return Some(format!(
            "{line}{} (with arguments of other kinds)",
            entry.text
        ));
    }
    line += &reader.text(&entry.text)?;
    // The encoding fills a frame up with zeros; other bytes behind it mean that two frames ran
    // together.
    let is_filled = reader.bytes.len() <= MOST_FILLED && reader.bytes.iter().all(|byte| *byte == 0);
    is_filled.then_some(line)
}

/// Returns true if the arguments of a format string are of kinds that are shown here.
pub(super) fn is_shown(format: &str) -> bool {
    let Ok(fragments) = defmt_parser::parse(format, ParserMode::ForwardsCompatible) else {
        return false;
    };
    fragments.iter().all(|fragment| match fragment {
        Fragment::Literal(_) => true,
        Fragment::Parameter(Parameter { ty, .. }) => !matches!(
            ty,
            Type::BitField(_) | Type::FormatSlice | Type::U8Array(_) | Type::U8Slice
        ),
    })
}

impl<'a> Reader<'a> {
    fn take<const COUNT: usize>(&mut self) -> Option<[u8; COUNT]> {
        let (taken, rest) = self.bytes.split_first_chunk()?;
        self.bytes = rest;
        Some(*taken)
    }

    /// Takes the arguments of a format string and inserts them into it.
    fn text(&mut self, format: &str) -> Option<String> {
        let fragments = defmt_parser::parse(format, ParserMode::ForwardsCompatible).ok()?;
        let parameters = fragments.iter().filter_map(|fragment| match fragment {
            Fragment::Parameter(parameter) => Some(parameter),
            Fragment::Literal(_) => None,
        });
        // Arguments are stored in the order of their indices, each once even if it is shown several
        // times.
        let mut parameters: Vec<&Parameter> = parameters.collect();
        parameters.sort_by_key(|parameter| parameter.index);
        parameters.dedup_by_key(|parameter| parameter.index);
        let arguments = parameters
            .into_iter()
            .map(|parameter| self.argument(&parameter.ty))
            .collect::<Option<Vec<Argument>>>()?;
        let mut text = String::new();
        for fragment in fragments {
            match fragment {
                Fragment::Literal(literal) => text += &literal,
                Fragment::Parameter(Parameter { index, hint, .. }) => {
                    arguments.get(index)?.show(hint.as_ref(), &mut text)?;
                }
            }
        }
        Some(text)
    }

    /// Of the format of an enum that of its variant, which the next byte names; else the format
    /// itself.
    fn variant<'format>(&mut self, format: &'format str) -> Option<&'format str> {
        // An enum of one variant has no byte.
        if !format.contains('|') {
            return Some(format);
        }
        let [number] = self.take()?;
        format.split('|').nth(number.into())
    }

    fn argument(&mut self, kind: &Type) -> Option<Argument<'a>> {
        Some(match kind {
            Type::U8 => Argument::Unsigned(u8::from_le_bytes(self.take()?).into()),
            Type::U16 => Argument::Unsigned(u16::from_le_bytes(self.take()?).into()),
            // The firmware's pointers have 32 bits.
            Type::U32 | Type::Usize => Argument::Unsigned(u32::from_le_bytes(self.take()?).into()),
            Type::U64 => Argument::Unsigned(u64::from_le_bytes(self.take()?).into()),
            Type::U128 => Argument::Unsigned(u128::from_le_bytes(self.take()?)),
            Type::I8 => Argument::Signed(i8::from_le_bytes(self.take()?).into(), 8),
            Type::I16 => Argument::Signed(i16::from_le_bytes(self.take()?).into(), 16),
            Type::I32 | Type::Isize => {
                Argument::Signed(i32::from_le_bytes(self.take()?).into(), 32)
            }
            Type::I64 => Argument::Signed(i64::from_le_bytes(self.take()?).into(), 64),
            Type::I128 => Argument::Signed(i128::from_le_bytes(self.take()?), 128),
            Type::F32 => Argument::Single(f32::from_le_bytes(self.take()?)),
            Type::F64 => Argument::Double(f64::from_le_bytes(self.take()?)),
            Type::Bool => match self.take()? {
                [0] => Argument::Truth(false),
                [1] => Argument::Truth(true),
                _ => return None,
            },
            Type::Char => Argument::Character(char::from_u32(u32::from_le_bytes(self.take()?))?),
            Type::Str => {
                let length = usize::try_from(u32::from_le_bytes(self.take()?)).ok()?;
                let (text, rest) = self.bytes.split_at_checked(length)?;
                self.bytes = rest;
                Argument::Text(str::from_utf8(text).ok()?)
            }
            Type::IStr => {
                let entry = self.table.get(u16::from_le_bytes(self.take()?))?;
                Argument::Text(&entry.text)
            }
            // Text that the firmware formatted itself; 0xff ends it, as it is not a byte of UTF-8.
            Type::Debug | Type::Display => {
                let end = self.bytes.iter().position(|byte| *byte == 0xff)?;
                let (text, rest) = self.bytes.split_at_checked(end)?;
                self.bytes = rest.get(1..)?;
                Argument::Text(str::from_utf8(text).ok()?)
            }
            Type::Format => {
                let entry = self.table.get(u16::from_le_bytes(self.take()?))?;
                let format = self.variant(entry.is_value.then_some(&*entry.text)?)?;
                Argument::Value(self.text(format)?)
            }
            // The format of all elements, then each of them.
            Type::FormatArray(length) => {
                if *length > LONGEST_ARRAY {
                    return None;
                }
                let entry = self.table.get(u16::from_le_bytes(self.take()?))?;
                let format = entry.is_value.then_some(&*entry.text)?;
                let mut elements = Vec::new();
                for _ in 0..*length {
                    let format = self.variant(format)?;
                    elements.push(self.text(format)?);
                }
                Argument::Value(format!("[{}]", elements.join(", ")))
            }
            // Formats one after the other, each with its arguments, and a zero.
            Type::FormatSequence => {
                let mut text = String::new();
                loop {
                    let index = u16::from_le_bytes(self.take()?);
                    if index == 0 {
                        break;
                    }
                    let entry = self.table.get(index)?;
                    text += &self.text(&entry.text)?;
                }
                Argument::Value(text)
            }
            Type::BitField(_) | Type::FormatSlice | Type::U8Array(_) | Type::U8Slice => {
                return None;
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::tests::table;
    use super::*;

    /// Returns the line of a frame with one format string and these bytes of arguments.
    fn line(format: &str, arguments: &[u8]) -> Option<String> {
        let table = table(&[(0x102, "defmt_warn", format), (3, "defmt_str", "interned")]);
        decode(&table, &rzcobs::encode(&[&[2, 1], arguments].concat()))
    }

    #[test]
    fn numbers_are_shown_as_their_hints_say() {
        for (format, bytes, expected) in [
            ("{=u8} {=u16}", &[200, 1, 2][..], "200 513"),
            ("{=u32:#010x}", &[0xef, 0xbe, 0, 0], "0x0000beef"),
            ("{=u32:X} {0=u32:#X}", &[0xef, 0xbe, 0, 0], "BEEF 0xBEEF"),
            ("{=u8:b} {0=u8:#b} {0=u8:08b}", &[5], "101 0b101 00000101"),
            ("{=u8:o} {0=u8:#o}", &[8], "10 0o10"),
            ("{=u16:05} {0=u16:?} {0=u16:a}", &[7, 0], "00007 7 7"),
            (
                "{=i8} {=i16} {=i32}",
                &[255, 254, 255, 253, 255, 255, 255],
                "-1 -2 -3",
            ),
            (
                "{=i16:x} {0=i16:#b}",
                &[0xff, 0xff],
                "ffff 0b1111111111111111",
            ),
            ("{=i128:x}", &[0xff; 16], "ffffffffffffffffffffffffffffffff"),
            ("{=i8:04}", &[251], "-005"),
            (
                "{=usize} {=isize}",
                &[1, 0, 0, 0, 255, 255, 255, 255],
                "1 -1",
            ),
            ("{=u64:ms}", &[57, 48, 0, 0, 0, 0, 0, 0], "12.345"),
            ("{=u32:us}", &[64, 66, 15, 0], "1.000000"),
            (
                "{=u128}",
                &[255; 16],
                "340282366920938463463374607431768211455",
            ),
            ("{=i64}", &[255; 8], "-1"),
            (
                "{=f32} {=f64}",
                &[0, 0, 192, 63, 0, 0, 0, 0, 0, 0, 4, 64],
                "1.5 2.5",
            ),
        ] {
            let expected = format!("WARN {expected}");
            assert_eq!(line(format, bytes).as_ref(), Some(&expected), "{format}");
        }
    }

    #[test]
    fn text_characters_and_truth_values_are_shown() {
        assert_eq!(line("{{plain}}", &[]).unwrap(), "WARN {plain}");
        let bytes = [2, 0, 0, 0, 0xc2, 0xb5, 3, 0, 1, 0xb5, 0, 0, 0];
        let shown = line("{=str} {=istr} {=bool} {=char}", &bytes).unwrap();
        assert_eq!(shown, "WARN µ interned true µ");
        assert_eq!(
            line("{=str:?}", &[1, 0, 0, 0, b'"']).unwrap(),
            "WARN \"\\\"\""
        );
        let formatted = line("{=__internal_Display} {=u8}", b"abc\xff\x07").unwrap();
        assert_eq!(formatted, "WARN abc 7");
        // Arguments are read in the order of indices, not of the text.
        assert_eq!(line("{1=u8} {0=u8} {1=u8}", &[1, 2]).unwrap(), "WARN 2 1 2");
    }

    #[test]
    fn structures_and_enums_are_shown_with_their_fields() {
        let table = table(&[
            (1, "defmt_warn", "refused: {}"),
            (2, "defmt_derived", "Lost|Setting({=?})|Storage({=?})"),
            (
                3,
                "defmt_derived",
                "OutOfRange {{ name: {=?}, value: {=f32} }}",
            ),
            (4, "defmt_derived", "MaxDuty|Gain"),
            (5, "defmt_derived", "Volatile"),
            (6, "defmt_prim", "{=u8}"),
            (7, "defmt_str", "interned"),
            (8, "defmt_prim", "{=[?;2]}"),
            (9, "defmt_prim", "{=f32}"),
            (10, "defmt_prim", "{=[?;65536]}"),
            (12, "defmt_prim", "{=__internal_FormatSequence}"),
            (13, "defmt_write", "serial {=str}"),
            (14, "defmt_write", ", {=u8}"),
        ]);
        let line = |argument: &[u8]| decode(&table, &rzcobs::encode(&[&[1, 0], argument].concat()));
        assert_eq!(line(&[2, 0, 0]).unwrap(), "WARN refused: Lost");
        let setting = [2, 0, 1, 3, 0, 4, 0, 1, 0, 0, 192, 63];
        assert_eq!(
            line(&setting).unwrap(),
            "WARN refused: Setting(OutOfRange { name: Gain, value: 1.5 })"
        );
        assert_eq!(
            line(&[2, 0, 2, 5, 0]).unwrap(),
            "WARN refused: Storage(Volatile)"
        );
        assert_eq!(line(&[6, 0, 9]).unwrap(), "WARN refused: 9");
        let numbers = [8, 0, 9, 0, 0, 0, 192, 63, 0, 0, 0, 64];
        assert_eq!(line(&numbers).unwrap(), "WARN refused: [1.5, 2.0]");
        let sequence = [12, 0, 13, 0, 2, 0, 0, 0, b'A', b'7', 14, 0, 9, 0, 0];
        assert_eq!(line(&sequence).unwrap(), "WARN refused: serial A7, 9");
        let variants = [8, 0, 4, 0, 1, 0];
        assert_eq!(line(&variants).unwrap(), "WARN refused: [Gain, MaxDuty]");
        // An unknown variant, an unknown part of a sequence, an unknown format, a string that is
        // not the format of a value, no argument at all, an array that is cut short, and one that
        // is too long.
        let cut = &numbers[..4];
        for wrong in [
            &[2, 0, 3][..],
            &[12, 0, 15, 0, 0, 0],
            &[11, 0],
            &[7, 0, 1],
            &[],
            cut,
            &[10, 0, 5, 0],
        ] {
            assert!(line(wrong).is_none(), "{wrong:?}");
        }
    }

    #[test]
    fn arguments_of_other_kinds_leave_level_and_format() {
        for format in ["{=[?]}", "{=[u8]}", "{=[u8; 1]}", "{=0..3}", "{=u8"] {
            let expected = format!("WARN {format} (with arguments of other kinds)");
            assert_eq!(line(format, &[1, 0]), Some(expected));
        }
    }

    #[test]
    fn time_begins_the_line_and_a_line_without_level_has_none() {
        let table = table(&[
            (1, "defmt_println", "{=u8}"),
            (9, "defmt_timestamp", "{=u32:us}"),
        ]);
        let frame = rzcobs::encode(&[1, 0, 0x40, 0x42, 0x0f, 0, 5]);
        assert_eq!(decode(&table, &frame).unwrap(), "1.000000 5");
    }

    #[test]
    fn frame_that_is_cut_short_or_holds_something_else_is_unreadable() {
        let table = table(&[(1, "defmt_info", "{=u32} {=str}")]);
        let text = [b'a'; 20];
        let whole = [&[1, 0, 7, 0, 0, 0, 20, 0, 0, 0][..], &text].concat();
        let lines = |frame: &[u8]| decode(&table, &rzcobs::encode(frame));
        let expected = format!("INFO 7 {}", "a".repeat(20));
        assert_eq!(lines(&whole), Some(expected));
        // The encoding fills a frame up with zeros, six at most.
        for length in 0..whole.len() - 6 {
            assert!(lines(&whole[..length]).is_none(), "{length}");
        }
        assert!(lines(&[2, 0]).is_none());
        assert!(decode(&table, b"\x80").is_none());
        for (format, bytes) in [
            ("{=bool}", &[2][..]),
            ("{=char}", &[0, 0xd8, 0, 0]),
            ("{=str}", &[1, 0, 0, 0, 0xff]),
            ("{=str}", &[255, 255, 255, 255, b'a']),
            ("{=istr}", &[4, 0]),
            ("{=u8:0200}", &[1]),
            ("{=u8:#0200x}", &[1]),
            // Two frames that ran together.
            ("{=u8}", &[1, 2, 1, 1]),
            ("{=u8}", &[1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]),
            ("{=u32:tus}", &[0; 4]),
        ] {
            assert!(line(format, bytes).is_none(), "{format}");
        }
    }
}
