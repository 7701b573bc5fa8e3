//! The calibration that a camera has stored, for users and programs.

use std::io::{self, Write};

use fmc_camera::io::link::message::Counters;
use fmc_camera::io::store::{NothingStored, StoredIdentity};
use serde::Serialize;

use crate::calibration_identity::CalibrationIdentity;
use crate::terminal;

/// Columns of the names in the block of lines.
const NAMES: u16 = 13;

/// Writes what is stored as a block of lines.
///
/// # Errors
/// Those of the sink.
pub fn write_text(
    stored: &Result<StoredIdentity, NothingStored>,
    sink: &mut dyn Write,
) -> io::Result<()> {
    let pairs = match stored {
        Ok(record) => {
            let text = |text: &str| match text {
                "" => "not named".to_owned(),
                text => text.to_owned(),
            };
            let other = record.other.map_or_else(
                || "older, or not read".to_owned(),
                |fault| fault.to_string(),
            );
            let seal = if record.is_sealed {
                "written: it stays"
            } else {
                "missing: the store was cut; store it again"
            };
            vec![
                ("calibration", record.id.to_string()),
                ("lens", text(record.origin.lens())),
                ("laboratory", text(record.origin.laboratory())),
                ("date", text(record.origin.date())),
                (
                    "store",
                    format!(
                        "number {}; the highest version so far is {}",
                        record.store, record.highest_version
                    ),
                ),
                ("slot", record.slot.to_string()),
                ("other slot", other),
                ("seal", seal.to_owned()),
            ]
        }
        Err(NothingStored {
            slots: [first, second],
        }) => vec![
            ("calibration", "none is stored that can be used".to_owned()),
            ("slot 0", first.to_string()),
            ("slot 1", second.to_string()),
        ],
    };
    writeln!(sink, "{}", terminal::pairs(NAMES, pairs))
}

/// Writes what is stored as JSON, with the counters of the link.
///
/// # Errors
/// Those of the sink.
pub fn write_json(
    stored: &Result<StoredIdentity, NothingStored>,
    link: Option<Counters>,
    sink: &mut dyn Write,
) -> io::Result<()> {
    let report = StoredReport {
        link,
        ..StoredReport::of(stored)
    };
    serde_json::to_writer_pretty(&mut *sink, &report)?;
    writeln!(sink)
}

/// The stored calibration; without one all but `slot_faults` and `link` are `None`.
#[derive(Debug, Default, Serialize)]
struct StoredReport {
    calibration: Option<CalibrationIdentity>,
    lens: Option<String>,
    laboratory: Option<String>,
    date: Option<String>,
    /// Number of the store: what a permission to store an older version names.
    store: Option<u32>,
    highest_version: Option<u32>,
    slot: Option<u8>,
    is_sealed: Option<bool>,
    /// Fault of either slot; `None` for one that is sound, or was not read.
    slot_faults: [Option<String>; 2],
    /// Counters of the link, as in the `summary.json` of `verify`.
    link: Option<Counters>,
}

impl StoredReport {
    fn of(stored: &Result<StoredIdentity, NothingStored>) -> Self {
        match stored {
            Ok(record) => {
                let text = |text: &str| (!text.is_empty()).then(|| text.to_owned());
                let other = record.other.map(|fault| fault.to_string());
                Self {
                    calibration: Some(CalibrationIdentity::of(&record.id)),
                    lens: text(record.origin.lens()),
                    laboratory: text(record.origin.laboratory()),
                    date: text(record.origin.date()),
                    store: Some(record.store),
                    highest_version: Some(record.highest_version),
                    slot: Some(record.slot),
                    is_sealed: Some(record.is_sealed),
                    slot_faults: if record.slot == 0 {
                        [None, other]
                    } else {
                        [other, None]
                    },
                    link: None,
                }
            }
            Err(nothing) => Self {
                slot_faults: nothing.slots.map(|fault| Some(fault.to_string())),
                ..Self::default()
            },
        }
    }
}
