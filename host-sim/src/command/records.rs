//! `records`: the records of a camera, fetched and stored.

mod following;
mod growing_files;

use std::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use fmc_camera::flight::frame_record::{FrameRecord, Outcome};
use fmc_camera::io::link::after_reset::FlightAfterReset;
use fmc_camera::io::link::message::Status;
use fmc_frames::record_files::{CSV, JSON};
use fmc_report::{camera_status, records};

use super::earlier_records::EarlierRecords;
use crate::cli::RecordsArgs;
use crate::failure::{Failure, note};
use crate::formats::output::{self, OutputFolder};

pub(super) fn run(args: &RecordsArgs) -> Result<(), Failure> {
    // The camera forgets acknowledged records, so these files may hold the only copy.
    for name in [CSV, JSON] {
        let path = args.out.join(name);
        if path.exists() {
            return Err(Failure::bad_input(format!(
                "--out: {} is there already, and the camera may have forgotten what is in it; name another folder",
                path.display()
            )));
        }
    }
    let mut earlier = EarlierRecords::read(&args.earlier)?;
    let mut device = args.device.open_records()?;
    if args.follow {
        return following::run(device.as_mut(), &args.out, earlier);
    }
    let before = device.flight_status()?;
    let mut recorded: Vec<FrameRecord> = Vec::new();
    let (mut next, mut last) = (0, None);
    while let Some(record) = device.fetch(next)? {
        next = record.sequence.saturating_add(1);
        last = Some(record.sequence);
        match earlier.having(&record)? {
            Some(folder) => has_already(folder, &record),
            None => recorded.push(record),
        }
    }
    let status = device.flight_status()?;
    if is_another_flight(&before, &status) {
        return Err(Failure::device_or_io(
            "records: the camera has been prepared for another flight while they were fetched, and keeps its records; fetch them again",
        ));
    }
    earlier.check_before(&status, recorded.first())?;
    let in_doubt = status.in_doubt;
    let (mut csv, mut json) = (Vec::new(), Vec::new());
    let failed = |error: &dyn Display| Failure::device_or_io(format!("records: {error}"));
    records::write_csv(&recorded, &mut csv).map_err(|error| failed(&error))?;
    records::write_json(None, &recorded, in_doubt, &mut json).map_err(|error| failed(&error))?;
    let folder = OutputFolder::create(&args.out)?;
    for (name, bytes) in [(CSV, csv), (JSON, json)] {
        folder.write(name, |sink| sink.write_all(&bytes))?;
    }
    folder.sync()?;
    let marked = match &in_doubt {
        Some(exposures) => earlier.doubt(exposures)?,
        None => Vec::new(),
    };
    // The records are on the disk only from here on.
    if let Some(last) = last {
        device.are_safe(last)?;
    }
    report(&recorded, &status, &earlier, &marked)
}

/// Returns `true` if the camera has been prepared for another flight since.
fn is_another_flight(before: &Status, now: &Status) -> bool {
    now.counts.triggers < before.counts.triggers
        || now.after_reset.flight != before.after_reset.flight
}

/// Tells of a record that is not written again.
fn has_already(folder: &Path, record: &FrameRecord) {
    note(format_args!(
        "note: {}: has record {} already",
        folder.display(),
        record.sequence
    ));
}

/// Prints what has been marked in folders of earlier records.
fn write_marked(sink: &mut dyn Write, marked: &[(PathBuf, usize)]) -> io::Result<()> {
    for (folder, count) in marked {
        writeln!(
            sink,
            "{}: {count} records in doubt, marked",
            folder.display()
        )?;
    }
    Ok(())
}

/// Prints what has been fetched, and what has been marked in folders of earlier records.
fn report(
    recorded: &[FrameRecord],
    status: &Status,
    earlier: &EarlierRecords,
    marked: &[(PathBuf, usize)],
) -> Result<(), Failure> {
    if let Some(exposures) = status.in_doubt
        && let Some((from, through)) = earlier.missing(&exposures, recorded.first())
    {
        note(format!(
            "records {from} to {through} were fetched earlier, and the encoder was {:.2} µm off in them, as the index mark has shown since: name their folder with --earlier, and they are marked",
            1e3 * exposures.off_mm
        ));
    }
    output::write(None, |sink: &mut dyn Write| {
        match recorded {
            [] => writeln!(sink, "no records")?,
            [first, .., last] | [first @ last] => writeln!(
                sink,
                "{} records, of triggers {} to {}, CRC-32 {:08x}",
                recorded.len(),
                first.sequence,
                last.sequence,
                records::crc32(recorded)
            )?,
        }
        write_marked(sink, marked)
    })?;
    let start = &status.after_reset;
    if let Some(time) = camera_status::without_eyes(start.without_eyes) {
        note(format_args!("note: start {}: {time}", start.boot));
    }
    if start.outcome == FlightAfterReset::FromFlash
        && let Some((sequence, unix_us)) = last_utc(recorded)
    {
        note(format_args!(
            "note: it began after centroid_unix_us {unix_us}, that of record {sequence}, and ended before that of the first record of the next flight"
        ));
    }
    Ok(())
}

/// Number and UTC of the last exposure that has it, µs since 1970.
fn last_utc(recorded: &[FrameRecord]) -> Option<(u32, u64)> {
    recorded.iter().rev().find_map(|record| {
        let Outcome::Exposed(frame) = &record.outcome else {
            return None;
        };
        frame.centroid_utc.map(|utc| (record.sequence, utc.unix_us))
    })
}
