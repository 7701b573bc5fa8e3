//! Records on their way from a file to their user.

use fmc_camera_file::InputError;

use crate::check;
use crate::row::{Names, Row};
use crate::sequences::Sequences;
use crate::{FlightFrame, FrameCamera};

/// Records that are read, checked, and handed on.
pub(super) struct Stream<'a, F> {
    /// Name of the file in messages.
    pub(super) file: &'a str,
    camera: &'a FrameCamera,
    sequences: Sequences,
    /// Number of records so far.
    pub(super) count: u64,
    each: F,
}

impl<'a, F> Stream<'a, F> {
    pub(super) fn new(file: &'a str, camera: &'a FrameCamera, each: F) -> Self {
        Self {
            file,
            camera,
            sequences: Sequences::default(),
            count: 0,
            each,
        }
    }

    /// Checks a record and hands its frame on; `place` names it in messages.
    pub(super) fn push<L: Names, E: From<InputError>>(
        &mut self,
        row: Row<L>,
        place: &str,
    ) -> Result<(), E>
    where
        F: FnMut(FlightFrame) -> Result<(), E>,
    {
        self.count += 1;
        let frame = check::frame(row, place, self.camera)?;
        if !self.sequences.insert(frame.sequence) {
            let text = format!("{place}: sequence {} appears twice", frame.sequence);
            return Err(InputError::invalid(text).into());
        }
        (self.each)(frame)
    }

    /// Checks that there were records.
    pub(super) fn end<E: From<InputError>>(&self) -> Result<(), E> {
        if self.count == 0 {
            return Err(InputError::invalid(format!("{}: it holds no records", self.file)).into());
        }
        Ok(())
    }
}
