//! Records of a CSV file.

use std::io::BufRead;

use csv::{ReaderBuilder, StringRecord, Trim};
use fmc_camera_file::InputError;

use super::stream::Stream;
use crate::columns::{check_length, csv_error, names};
use crate::row::{NAMES, Row};
use crate::{FlightFrame, Lines};

/// Number of columns that every file of records has; later ones were added.
const FIRST_COLUMNS: usize = 41;

pub(super) fn read<E: From<InputError>>(
    source: impl BufRead,
    mut stream: Stream<'_, impl FnMut(FlightFrame) -> Result<(), E>>,
) -> Result<(), E> {
    let file = stream.file;
    let mut reader = ReaderBuilder::new()
        .flexible(true)
        .trim(Trim::All)
        .from_reader(source);
    let mut record = StringRecord::new();
    let header = reader.headers();
    let header = header
        .map_err(|error| csv_error(file, &[], &record, &error))?
        .clone();
    let names = names(file, &header)?;
    for wanted in NAMES.iter().take(FIRST_COLUMNS) {
        if !names.iter().any(|name| name == wanted) {
            let text = format!("{file}, line 1: column {wanted} is missing");
            return Err(InputError::invalid(text)
                .with_help("records.csv as host-sim records and host-sim mission write it")
                .into());
        }
    }
    let mut lines = Lines::default();
    while reader
        .read_record(&mut record)
        .map_err(|error| csv_error(file, &names, &StringRecord::new(), &error))?
    {
        let line = lines.of(record.position());
        // Errors of a type have the line of the record.
        if let Some(mut position) = record.position().cloned() {
            position.set_line(line);
            record.set_position(Some(position));
        }
        check_length(file, line, &record, &names)?;
        let row: Row<String> = record
            .deserialize(Some(&header))
            .map_err(|error| csv_error(file, &names, &record, &error))?;
        stream.push(row, &format!("{file}, line {line}"))?;
    }
    stream.end()
}
