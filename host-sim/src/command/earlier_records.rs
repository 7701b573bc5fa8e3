//! Records of the same flight that were fetched before: those that are in doubt since are marked.

use std::path::{Path, PathBuf};

use fmc_camera::flight::calibration_id::CalibrationId;
use fmc_camera::flight::frame_record::{FrameRecord, Outcome, Reason};
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::flight::time::Time;
use fmc_camera::io::link::after_reset::FlightAfterReset;
use fmc_camera::io::link::message::Status;
use fmc_frames::record_files::{CSV, JSON, RecordFiles};

use crate::failure::Failure;
use crate::formats::output::OutputFolder;

/// Folders with records that were fetched earlier.
#[derive(Debug)]
pub(super) struct EarlierRecords {
    folders: Vec<(PathBuf, RecordFiles)>,
}

impl EarlierRecords {
    /// Reads the folders.
    pub(super) fn read(folders: &[PathBuf]) -> Result<Self, Failure> {
        let read = |folder: &PathBuf| -> Result<_, Failure> {
            Ok((folder.clone(), RecordFiles::read(folder)?))
        };
        Ok(Self {
            folders: folders.iter().map(read).collect::<Result<_, _>>()?,
        })
    }

    /// Returns the folder that has this record of the camera, as where the link was cut after its
    /// row was written and before the camera could forget it. A folder's row stands for a record
    /// that a reset has damaged.
    ///
    /// # Errors
    /// [`Failure`] naming a folder that has another record of this number.
    pub(super) fn having(&self, record: &FrameRecord) -> Result<Option<&Path>, Failure> {
        for (folder, files) in &self.folders {
            match files.is_same(record) {
                None => {}
                Some(is_same) if is_same || is_damaged(record) => return Ok(Some(folder)),
                Some(_) => {
                    return Err(Failure::bad_input(format!(
                        "--earlier: {}: its record {} is not the one that the camera has; allowed: the same, or none; these are records of another flight",
                        folder.join(CSV).display(),
                        record.sequence
                    )));
                }
            }
        }
        Ok(None)
    }

    /// Checks that all records have the calibration of the camera, or that of the first record that
    /// it has now and no folder has, and come before that record. Times are compared where no reset
    /// can have been among them, as the camera's time begins anew with each start.
    pub(super) fn check_before(
        &self,
        status: &Status,
        first: Option<&FrameRecord>,
    ) -> Result<(), Failure> {
        let crc_of = |id: Option<CalibrationId>| id.map_or(0, |id| id.crc);
        let crc = crc_of(status.calibration);
        // It may have been exchanged since.
        let first_crc = first.map_or(crc, |first| crc_of(first.calibration));
        for (folder, files) in &self.folders {
            let Some((sequence, trigger_us, calibration)) = files.last() else {
                continue;
            };
            let of_another = |what: &str, theirs: &dyn std::fmt::Display, ours: &str| {
                Err(Failure::bad_input(format!(
                    "--earlier: {}: its last record has {what} {theirs}; allowed: {ours}; these are records of another flight",
                    folder.join(CSV).display()
                )))
            };
            let theirs = |crc: &u32| calibration == format!("{crc:08x}");
            if ![crc, first_crc].iter().any(theirs) {
                let ours = format!("{crc:08x}");
                return of_another("the calibration", &calibration, &ours);
            }
            if let Some(first) = first {
                if sequence >= first.sequence {
                    let ours = format!("below {}, the first that the camera has", first.sequence);
                    return of_another("the sequence", &sequence, &ours);
                }
                let is_one_start = status.after_reset.outcome == FlightAfterReset::Nothing;
                if is_one_start && trigger_us >= first.trigger.us() {
                    let ours = format!("before {}", first.trigger.us());
                    return of_another("trigger_us", &trigger_us, &ours);
                }
            }
        }
        Ok(())
    }

    /// Marks exposures in doubt in the files of all folders. Returns the folders with the number of
    /// records that were marked, if there were any.
    pub(super) fn doubt(&mut self, exposures: &InDoubt) -> Result<Vec<(PathBuf, usize)>, Failure> {
        let mut marked = Vec::new();
        for (path, files) in &mut self.folders {
            let count = files.doubt(exposures);
            if count == 0 {
                continue;
            }
            let folder = OutputFolder::create(path)?;
            folder.write(CSV, |sink| files.write_csv(sink).map_err(Into::into))?;
            if files.has_json() {
                folder.write(JSON, |sink| files.write_json(sink))?;
            }
            folder.sync()?;
            marked.push((path.clone(), count));
        }
        Ok(marked)
    }

    /// Returns the first and the last of the exposures in doubt that neither the camera nor a
    /// folder has.
    pub(super) fn missing(
        &self,
        exposures: &InDoubt,
        first: Option<&FrameRecord>,
    ) -> Option<(u32, u32)> {
        let end = first.map_or(u32::MAX, |first| first.sequence);
        let through = exposures.through_sequence().min(end.saturating_sub(1));
        let has = |sequence: u32| {
            let mut folders = self.folders.iter();
            folders.any(|(_, files)| files.has(sequence))
        };
        let mut missing = (exposures.from_sequence.max(1)..=through).filter(|one| !has(*one));
        let from = missing.next()?;
        Some((from, missing.next_back().unwrap_or(from)))
    }
}

/// Returns `true` for the record of a trigger of which a reset has left the number alone.
fn is_damaged(record: &FrameRecord) -> bool {
    record.trigger == Time::START && record.outcome == Outcome::Refused(Reason::Unusable)
}
