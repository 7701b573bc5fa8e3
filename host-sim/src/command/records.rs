//! `records`: the records of a camera, fetched and stored.

use std::io::Write;

use fmc_camera::flight::frame_record::FrameRecord;
use fmc_report::records;

use crate::cli::RecordsArgs;
use crate::failure::Failure;
use crate::formats::output::{self, OutputFolder};

/// Names of the files.
const FILES: [&str; 2] = ["records.csv", "records.json"];

pub(super) fn run(args: &RecordsArgs) -> Result<(), Failure> {
    // The camera forgets acknowledged records, so these files may hold the only copy.
    for name in FILES {
        let path = args.out.join(name);
        if path.exists() {
            return Err(Failure::bad_input(format!(
                "--out: {} is there already, and the camera may have forgotten what is in it; name another folder",
                path.display()
            )));
        }
    }
    let mut device = args.device.open_records()?;
    let mut recorded: Vec<FrameRecord> = Vec::new();
    let mut next = 0;
    while let Some(record) = device.fetch(next)? {
        next = record.sequence.saturating_add(1);
        recorded.push(record);
    }
    let (mut csv, mut json) = (Vec::new(), Vec::new());
    let failed = |error: &dyn std::fmt::Display| Failure::device_or_io(format!("records: {error}"));
    records::write_csv(&recorded, &mut csv).map_err(|error| failed(&error))?;
    records::write_json(None, &recorded, &mut json).map_err(|error| failed(&error))?;
    let folder = OutputFolder::create(&args.out)?;
    for (name, bytes) in FILES.into_iter().zip([csv, json]) {
        folder.write(name, |sink| sink.write_all(&bytes))?;
    }
    folder.sync()?;
    // The records are on the disk only from here on.
    if let Some(last) = recorded.last() {
        device.are_safe(last.sequence)?;
    }
    output::write(None, |sink: &mut dyn Write| match recorded.as_slice() {
        [] => writeln!(sink, "no records"),
        [first, ..] => writeln!(
            sink,
            "{} records, of triggers {} to {}, CRC-32 {:08x}",
            recorded.len(),
            first.sequence,
            next - 1,
            records::crc32(&recorded)
        ),
    })
}
