//! The fields of a structured type.

use super::dictionary::{DictionaryError, Reader};

/// A field of a structured type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name as the header has it; empty for padding.
    pub name: String,
    /// Type as the header has it, without quotes: `<f4`.
    pub type_name: String,
    /// First byte of the field in a row.
    pub offset: usize,
    /// Number of its bytes.
    pub length: usize,
    /// Number of values: 1, or those of an array in each row.
    pub count: usize,
}

/// Largest length of a row, bytes.
const LONGEST_ROW: usize = 1 << 16;

/// Returns the fields of a structured type, as Python writes it; `None` if the type is not a list
/// of fields with types of fixed length.
#[must_use]
pub fn fields(description: &str) -> Option<Vec<Field>> {
    let mut fields = Vec::new();
    read(description, &mut fields)
        .ok()
        .flatten()
        .map(|()| fields)
}

/// Reads the fields; `None` for a type that has no fixed length.
fn read(description: &str, fields: &mut Vec<Field>) -> Result<Option<()>, DictionaryError> {
    let mut reader = Reader::new(description);
    let mut offset = 0;
    reader.expect('[', "[")?;
    while !reader.take(']') {
        reader.expect('(', "(")?;
        let name = reader.string()?.to_owned();
        reader.expect(',', "a comma")?;
        let type_name = reader.string()?.to_owned();
        let mut count = Some(1_usize);
        if !reader.take(')') {
            reader.expect(',', "a comma")?;
            if !reader.take(')') {
                for axis in reader.shape()? {
                    let axis = usize::try_from(axis).ok();
                    count = count
                        .zip(axis)
                        .and_then(|(count, axis)| count.checked_mul(axis));
                }
                reader.expect(')', ")")?;
            }
        }
        reader.separate(']')?;
        let length = bytes(&type_name).zip(count);
        let length = length.and_then(|(bytes, count)| bytes.checked_mul(count));
        let (Some(length), Some(count)) = (length.filter(|length| *length <= LONGEST_ROW), count)
        else {
            return Ok(None);
        };
        if offset + length > LONGEST_ROW {
            return Ok(None);
        }
        fields.push(Field {
            name,
            type_name,
            offset,
            length,
            count,
        });
        offset += length;
    }
    Ok((reader.is_at_end() && offset > 0).then_some(()))
}

/// Returns the length of a value, bytes; `None` for a type without one.
fn bytes(type_name: &str) -> Option<usize> {
    let text = type_name.trim_start_matches(['<', '>', '|', '=']);
    let kind = text.chars().next()?;
    // Dates have their unit behind the length.
    let digits = text.get(kind.len_utf8()..)?.split('[').next()?;
    let length: usize = digits.parse().ok()?;
    match kind {
        'b' | 'i' | 'u' | 'f' | 'c' | 'S' | 'a' | 'V' | 'M' | 'm' => Some(length),
        // Characters of four bytes.
        'U' => length.checked_mul(4),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_have_their_places_in_a_row() {
        let found = fields(
            "[('sequence', '<u4'), ('x_mm', '<f8'), ('tag', '<U3'), ('', '|V4'), ('m', '<f4', (2, 3)), ('t', '<M8[us]')]",
        );
        let found = found.unwrap();
        let places: Vec<_> = found
            .iter()
            .map(|field| (field.name.as_str(), field.offset, field.length, field.count))
            .collect();
        let expected = [
            ("sequence", 0, 4, 1),
            ("x_mm", 4, 8, 1),
            ("tag", 12, 12, 1),
            ("", 24, 4, 1),
            ("m", 28, 24, 6),
            ("t", 52, 8, 1),
        ];
        assert_eq!(places, expected);
    }

    #[test]
    fn types_without_fields_or_length_have_none() {
        for description in [
            "'<f4'",
            "[]",
            "[('x', 'O')]",
            "[('x', '|O8')]",
            "[('x', [('y', '<f4')])]",
            "[(('title', 'x'), '<f4')]",
            "[('x', '<f4', (70000,))]",
            "[('x', '<f4', (4294967296, 4294967296, 4294967296))]",
            "[('x', '<U40000')]",
            "[('x', '<f')]",
            "[('x', '<f4')",
        ] {
            assert_eq!(fields(description), None, "{description}");
        }
    }
}
