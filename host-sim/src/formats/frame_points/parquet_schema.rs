//! Columns of a Parquet file of points.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as PhysicalType};
use parquet::errors::Result;
use parquet::schema::types::{SchemaDescriptor, Type, TypePtr};

use super::answers::{FLAG, OutColumns};
use super::csv_header::coordinates;
use super::frame_key::KeyColumn;
use crate::formats::points::{CoordinateFrame, Precision};

/// Places and types of the columns.
#[derive(Debug, Clone)]
pub(super) struct ParquetSchema {
    root: TypePtr,
    /// `true` for the columns whose rows may have no value.
    pub(super) optional: Vec<bool>,
    pub(super) key: KeyColumn,
    pub(super) key_place: usize,
    pub(super) coordinates: [usize; 2],
    pub(super) precision: Precision,
    pub(super) frame: CoordinateFrame,
}

/// A column of the answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OutColumn {
    /// A column of the points.
    Kept(usize),
    /// A coordinate, by its place in the pair.
    Coordinate(usize),
    /// An added number, by its place among them.
    Number(usize),
    Flag,
}

impl ParquetSchema {
    /// Returns the columns of a file.
    ///
    /// # Errors
    /// A description of what is wrong.
    pub(super) fn of(
        schema: &SchemaDescriptor,
        has_images: bool,
    ) -> std::result::Result<Self, String> {
        if let Some(nested) = schema.columns().iter().find(|column| {
            column.max_rep_level() > 0
                || column.max_def_level() > 1
                || column.path().parts().len() > 1
        }) {
            return Err(format!("column {} is nested", nested.path().string()));
        }
        let names: Vec<&str> = schema
            .columns()
            .iter()
            .map(|column| column.name())
            .collect();
        for (index, name) in names.iter().enumerate() {
            if names.iter().skip(index + 1).any(|other| other == name) {
                return Err(format!("column {} appears twice", name.escape_debug()));
            }
        }
        let all = || names.iter().copied();
        let (frame, [first, second]) = coordinates(&all())?;
        let (key, key_place) = KeyColumn::find(all(), has_images)?;
        let physical = |place: usize| {
            schema
                .columns()
                .get(place)
                .map(|column| column.physical_type())
        };
        let precision = match (physical(first), physical(second)) {
            (Some(PhysicalType::FLOAT), Some(PhysicalType::FLOAT)) => Precision::Single,
            (Some(PhysicalType::DOUBLE), Some(PhysicalType::DOUBLE)) => Precision::Double,
            _ => {
                let [first, second] = frame.columns();
                return Err(format!(
                    "columns {first} and {second} must both be of type FLOAT or both of type DOUBLE"
                ));
            }
        };
        match physical(key_place) {
            Some(PhysicalType::INT32 | PhysicalType::INT64 | PhysicalType::BYTE_ARRAY) => {}
            _ => {
                return Err(format!(
                    "column {} must be of type INT32, INT64 or BYTE_ARRAY",
                    key.name()
                ));
            }
        }
        Ok(Self {
            root: schema.root_schema_ptr(),
            optional: schema
                .columns()
                .iter()
                .map(|column| column.max_def_level() > 0)
                .collect(),
            key,
            key_place,
            coordinates: [first, second],
            precision,
            frame,
        })
    }

    /// Returns the schema of the answers, and the meaning of its columns. A column of an earlier
    /// answer is replaced, the others are added at the end.
    ///
    /// # Errors
    /// Those of the library for names that are not allowed.
    pub(super) fn answered(&self, out: OutColumns) -> Result<(TypePtr, Vec<OutColumn>)> {
        let mut fields = self.root.get_fields().to_vec();
        let mut columns: Vec<OutColumn> = (0..fields.len()).map(OutColumn::Kept).collect();
        for (which, place) in self.coordinates.into_iter().enumerate() {
            if let Some(column) = columns.get_mut(place) {
                *column = OutColumn::Coordinate(which);
            }
        }
        let physical = match self.precision {
            Precision::Single => PhysicalType::FLOAT,
            Precision::Double => PhysicalType::DOUBLE,
        };
        let mut put = |name: &str, field: Type, column: OutColumn| {
            let field = Arc::new(field);
            let there = fields.iter().position(|one| one.name() == name);
            if let Some((one, meaning)) =
                there.and_then(|place| fields.get_mut(place).zip(columns.get_mut(place)))
            {
                (*one, *meaning) = (field, column);
            } else {
                fields.push(field);
                columns.push(column);
            }
        };
        for (place, name) in out.numbers().enumerate() {
            let field = Type::primitive_type_builder(name, physical)
                .with_repetition(Repetition::REQUIRED)
                .build()?;
            put(name, field, OutColumn::Number(place));
        }
        if out.flag {
            let field = Type::primitive_type_builder(FLAG, PhysicalType::BYTE_ARRAY)
                .with_repetition(Repetition::REQUIRED)
                .with_logical_type(Some(LogicalType::String))
                .build()?;
            put(FLAG, field, OutColumn::Flag);
        }
        let root = Type::group_type_builder(self.root.name())
            .with_fields(fields)
            .build()?;
        Ok((Arc::new(root), columns))
    }
}
