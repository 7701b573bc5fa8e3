//! Layout of the rows of an array: where its numbers are.

use super::answers::{FLAG, OutColumns};
use super::csv_header::coordinates;
use super::frame_key::KeyColumn;
use crate::formats::npy_header::{self, Field, NpyHeader};
use crate::formats::points::{CoordinateFrame, Precision};

/// Type of the numbers or texts that name a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum KeyType {
    Unsigned,
    Signed,
    Float,
    Bytes,
    Unicode,
}

/// Places of the numbers in a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct NpyLayout {
    pub(super) row_bytes: usize,
    pub(super) key: KeyColumn,
    pub(super) key_type: KeyType,
    pub(super) key_offset: usize,
    pub(super) key_bytes: usize,
    pub(super) coordinates: [usize; 2],
    pub(super) precision: Precision,
    pub(super) frame: CoordinateFrame,
    /// The fields of a structured type, and the type as the header has it.
    pub(super) fields: Option<(Vec<Field>, String)>,
}

/// Places of the answers in a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct NpyOutLayout {
    /// The type as the header has it; `None` for rows of x, y, dx, dy.
    pub(super) description: Option<String>,
    pub(super) row_bytes: usize,
    pub(super) numbers: Vec<usize>,
    pub(super) flag: Option<usize>,
}

impl NpyLayout {
    /// Returns the layout of a header, and the number of rows.
    ///
    /// # Errors
    /// A description of what is wrong.
    pub(super) fn of(header: &NpyHeader, has_images: bool) -> Result<(Self, u64), String> {
        if header.is_fortran_order && header.shape.len() > 1 && header.shape != [1, 3] {
            return Err("is in Fortran order".to_owned());
        }
        if header.description.starts_with('[') {
            let [count] = *header.shape else {
                return Err(format!("has the shape {:?}, not (N,)", header.shape));
            };
            return Ok((Self::structured(&header.description, has_images)?, count));
        }
        let precision = match header.description.trim_matches(['\'', '"']) {
            "<f4" => Precision::Single,
            "<f8" => Precision::Double,
            other => return Err(format!("is of type {}", npy_header::shown(other))),
        };
        let [count, 3] = *header.shape else {
            let shape = format!("{:?}", header.shape);
            return Err(format!("has the shape {}", npy_header::shown(&shape)));
        };
        let bytes = precision.bytes();
        let layout = Self {
            row_bytes: 3 * bytes,
            key: KeyColumn::Sequence,
            key_type: KeyType::Float,
            key_offset: 0,
            key_bytes: bytes,
            coordinates: [bytes, 2 * bytes],
            precision,
            frame: CoordinateFrame::Sensor,
            fields: None,
        };
        Ok((layout, count))
    }

    fn structured(description: &str, has_images: bool) -> Result<Self, String> {
        let fields = npy_header::fields(description)
            .ok_or_else(|| format!("is of type {}", npy_header::shown(description)))?;
        let names = || fields.iter().map(|field| field.name.as_str());
        let (frame, [first, second]) = coordinates(&names())?;
        let (key, key_place) = KeyColumn::find(names(), has_images)?;
        let [Some(first), Some(second), Some(key_field)] =
            [first, second, key_place].map(|place| fields.get(place))
        else {
            return Err("has no coordinates".to_owned());
        };
        let wrong = |field: &Field, allowed: &str| {
            format!(
                "has the field {} of type {}; it must be {allowed}",
                field.name,
                npy_header::shown(&field.type_name)
            )
        };
        let precision = |field: &Field| match (field.type_name.as_str(), field.count) {
            ("<f4", 1) => Ok(Precision::Single),
            ("<f8", 1) => Ok(Precision::Double),
            _ => Err(wrong(field, "<f4 or <f8")),
        };
        if precision(first)? != precision(second)? {
            return Err(wrong(
                second,
                &format!("{}, as {}", first.type_name, first.name),
            ));
        }
        let mut kind = key_field.type_name.chars();
        let key_type = match (kind.next(), kind.next(), key_field.length, key_field.count) {
            (Some('<'), Some('u'), 2 | 4 | 8, 1) | (Some('|'), Some('u'), 1, 1) => {
                KeyType::Unsigned
            }
            (Some('<'), Some('i'), 2 | 4 | 8, 1) | (Some('|'), Some('i'), 1, 1) => KeyType::Signed,
            (Some('<'), Some('f'), 4 | 8, 1) => KeyType::Float,
            (Some('|'), Some('S'), _, 1) => KeyType::Bytes,
            (Some('<'), Some('U'), _, 1) => KeyType::Unicode,
            _ => return Err(wrong(key_field, "a little-endian number or a text")),
        };
        Ok(Self {
            row_bytes: fields.iter().map(|field| field.length).sum(),
            key,
            key_type,
            key_offset: key_field.offset,
            key_bytes: key_field.length,
            coordinates: [first.offset, second.offset],
            precision: precision(first)?,
            frame,
            fields: Some((fields.clone(), description.to_owned())),
        })
    }

    /// Returns the layout of the answers: rows of x, y, dx, dy, or the fields of the points with
    /// those of the answers behind them.
    ///
    /// # Errors
    /// A description of a field that has the name of an answer's, and another type.
    pub(super) fn answered(&self, out: OutColumns) -> Result<NpyOutLayout, String> {
        let bytes = self.precision.bytes();
        let Some((fields, description)) = &self.fields else {
            return Ok(NpyOutLayout {
                description: None,
                row_bytes: 4 * bytes,
                numbers: vec![2 * bytes, 3 * bytes],
                flag: None,
            });
        };
        let open = description.trim_end().trim_end_matches(']');
        let mut layout = NpyOutLayout {
            description: None,
            row_bytes: self.row_bytes,
            numbers: Vec::new(),
            flag: None,
        };
        let mut description = open.trim_end().trim_end_matches(',').to_owned();
        let mut place = |name: &str, type_name: &str, length: usize| {
            if let Some(field) = fields.iter().find(|field| field.name == name) {
                return if field.type_name == type_name && field.count == 1 {
                    Ok(field.offset)
                } else {
                    Err(format!(
                        "has the field {name} of type {}; it must be {type_name}",
                        npy_header::shown(&field.type_name)
                    ))
                };
            }
            description.extend([", ('", name, "', '", type_name, "')"]);
            layout.row_bytes += length;
            Ok(layout.row_bytes - length)
        };
        for name in out.numbers() {
            layout
                .numbers
                .push(place(name, self.precision.type_name(), bytes)?);
        }
        if out.flag {
            layout.flag = Some(place(FLAG, "|u1", 1)?);
        }
        description.push(']');
        layout.description = Some(description);
        Ok(layout)
    }
}
