//! `records --follow`: the records of a camera that flies, each as soon as its frame is finished.

use std::io::{self, Write};
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, FrameRecord, Outcome};
use fmc_camera::flight::in_doubt::InDoubt;
use fmc_camera::io::link::message::{Refusal, Status};
use fmc_output::interruption::Interruption;

use super::growing_files::GrowingFiles;
use crate::command::earlier_records::EarlierRecords;
use crate::device::link_error::LinkError;
use crate::device::{DeviceError, RecordSource};
use crate::failure::{Failure, note};
use crate::formats::output;

/// Time from one look for a record to the next, while there is none.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// Number of times that a record is fetched again which the camera changes meanwhile.
const FETCHES: u32 = 5;

/// Reason why following has ended well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    /// The user has asked for it.
    Asked,
    /// The camera has been prepared for another flight.
    OtherFlight,
}

/// A flight that is followed.
struct Following<'a> {
    device: &'a mut dyn RecordSource,
    files: GrowingFiles,
    earlier: EarlierRecords,
    /// The camera's status when it was asked last.
    status: Status,
    next: u32,
}

pub(super) fn run(
    device: &mut dyn RecordSource,
    out: &Path,
    earlier: EarlierRecords,
) -> Result<(), Failure> {
    let interruption = Interruption::listen()
        .map_err(|error| Failure::device_or_io(format!("no signal can be caught: {error}")))?;
    follow(device, out, earlier, &interruption)
}

fn follow(
    device: &mut dyn RecordSource,
    out: &Path,
    earlier: EarlierRecords,
    interruption: &Interruption,
) -> Result<(), Failure> {
    let status = device.flight_status()?;
    earlier.check_before(&status, None)?;
    let mut following = Following {
        device,
        files: GrowingFiles::create(out)?,
        earlier,
        status,
        next: 0,
    };
    let ended = following.until_the_end(interruption);
    following.complete(out, ended)
}

impl Following<'_> {
    /// Takes records until there is a reason to end.
    fn until_the_end(&mut self, interruption: &Interruption) -> Result<End, Failure> {
        self.mark()?;
        while !interruption.is_asked() {
            if !self.look()? {
                return Ok(End::OtherFlight);
            }
            self.mark()?;
            let Some(record) = self.device.fetch(self.next)? else {
                sleep(LOOK_EVERY);
                continue;
            };
            if !self.take(record)? {
                return Ok(End::OtherFlight);
            }
        }
        Ok(End::Asked)
    }

    /// Asks the camera how it is. Returns `false` if it has been prepared for another flight, of
    /// which nothing is kept.
    fn look(&mut self) -> Result<bool, DeviceError> {
        let status = self.device.flight_status()?;
        if super::is_another_flight(&self.status, &status) {
            return Ok(false);
        }
        self.status = status;
        Ok(true)
    }

    /// Puts a record on the disk, and lets the camera forget it. Returns `false` if it may be one
    /// of another flight, whose records the camera must keep.
    fn take(&mut self, fetched: FrameRecord) -> Result<bool, Failure> {
        let sequence = fetched.sequence;
        let Some((mut record, mut known)) = self.settled(fetched)? else {
            return Ok(false);
        };
        let is_new = match self.earlier.having(&record)? {
            Some(folder) => {
                super::has_already(folder, &record);
                false
            }
            None => true,
        };
        if is_new {
            if self.files.is_empty() {
                self.earlier.check_before(&self.status, Some(&record))?;
            }
            self.files.append(record, known)?;
        } else {
            self.mark_earlier()?;
        }
        for _ in 0..FETCHES {
            match self.device.are_safe(sequence) {
                // The camera has put it in doubt since.
                Err(error) if is_not_fetched(&error) => {
                    let again = self.device.fetch(sequence)?;
                    let Some(again) = again.filter(|again| again.sequence == sequence) else {
                        break;
                    };
                    let Some(settled) = self.settled(again)? else {
                        return Ok(false);
                    };
                    (record, known) = settled;
                    if is_new {
                        self.files.replace_last(record, known)?;
                    } else {
                        self.mark_earlier()?;
                    }
                }
                other => {
                    other?;
                    break;
                }
            }
        }
        self.next = sequence.saturating_add(1);
        if is_new {
            say(&line(&record))?;
        }
        Ok(true)
    }

    /// Returns a record that has just been fetched with the exposures in doubt whose σ it holds: it
    /// is fetched again as long as they change. `None` if another flight has been prepared, of
    /// which it may be.
    fn settled(
        &mut self,
        mut record: FrameRecord,
    ) -> Result<Option<(FrameRecord, Option<InDoubt>)>, DeviceError> {
        for _ in 0..FETCHES {
            let before = self.status.in_doubt;
            if !self.look()? {
                return Ok(None);
            }
            if self.status.in_doubt == before {
                return Ok(Some((record, before)));
            }
            let again = self.device.fetch(record.sequence)?;
            if let Some(again) = again.filter(|again| again.sequence == record.sequence) {
                record = again;
            }
        }
        let is_of_this_flight = self.look()?;
        Ok(is_of_this_flight.then_some((record, self.status.in_doubt)))
    }

    /// Marks the records in folders of earlier ones that the camera has put in doubt since.
    fn mark_earlier(&mut self) -> Result<(), Failure> {
        let Some(exposures) = self.status.in_doubt else {
            return Ok(());
        };
        let marked = self.earlier.doubt(&exposures)?;
        output::write(None, |sink: &mut dyn Write| {
            super::write_marked(sink, &marked)
        })
    }

    /// Marks the records on the disk that the camera has put in doubt since.
    fn mark(&mut self) -> Result<(), Failure> {
        let Some(exposures) = self.status.in_doubt else {
            return Ok(());
        };
        let count = self.files.doubt(exposures)?;
        if count > 0 {
            say(&format!(
                "in doubt by {:.2} µm, and marked: {count} of the records before",
                1e3 * exposures.off_mm.abs()
            ))?;
        }
        Ok(())
    }

    /// Completes the files, and says what is in them. What has ended the flight is the failure,
    /// also where the files cannot be completed, which is told before.
    fn complete(self, out: &Path, ended: Result<End, Failure>) -> Result<(), Failure> {
        let written = self.write();
        let out = out.display();
        match ended {
            Ok(End::Asked) => written,
            Ok(End::OtherFlight) => {
                note(
                    "note: the camera has been prepared for another flight: follow it into another folder",
                );
                written
            }
            Err(failure) => {
                match written {
                    Ok(()) => note(format_args!("note: {out}: these records are complete")),
                    Err(failure) => note(format_args!("note: {}", failure.text())),
                }
                note(format_args!(
                    "note: the camera keeps what comes after them until it is fetched: with --earlier {out} into another folder"
                ));
                Err(failure)
            }
        }
    }

    fn write(mut self) -> Result<(), Failure> {
        let recorded = self.files.complete()?;
        let in_doubt = self.status.in_doubt;
        let marked = match &in_doubt {
            Some(exposures) => self.earlier.doubt(exposures)?,
            None => Vec::new(),
        };
        super::report(&recorded, &self.status, &self.earlier, &marked)
    }
}

fn is_not_fetched(error: &DeviceError) -> bool {
    matches!(
        error,
        DeviceError::Link {
            error: LinkError::Refused {
                refusal: Refusal::NotFetched { .. },
                ..
            },
            ..
        }
    )
}

/// Prints a line at once.
fn say(line: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "{line}")
        .and_then(|()| stdout.flush())
        .map_err(|error| Failure::writing("standard output", &error))
}

/// A record in a line.
fn line(record: &FrameRecord) -> String {
    use std::fmt::Write as _;
    let mut line = format!("{} ", record.sequence);
    // A text takes everything.
    let _ = match &record.outcome {
        Outcome::Exposed(frame) => write!(
            line,
            "exposed, {:.6} s, V/H {:.4} 1/s, principal point {:.5} {:.5} mm, σ {:.2} µm, smear {:.2} px",
            frame.interior.exposure_s,
            frame.interior.vh_per_s,
            frame.interior.principal_point.x_mm,
            frame.interior.principal_point.y_mm,
            1e3 * frame.principal_point_sigma.total_mm(),
            frame.smear_px
        ),
        Outcome::Refused(reason) => write!(line, "refused: {reason}"),
    };
    let faults: Vec<&str> = record.faults.iter().map(Fault::name).collect();
    let flags: Vec<&str> = record.flags.iter().map(Flag::name).collect();
    for (what, names) in [("faults", faults), ("flags", flags)] {
        if !names.is_empty() {
            let _ = write!(line, "; {what}: {}", names.join(", "));
        }
    }
    line
}

#[cfg(test)]
mod tests;
