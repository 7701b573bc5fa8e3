//! The calibration, or the frames of a flight, as another program's files.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use fmc_camera_file::CameraFile;
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::{self, Choices, GOOD_ENOUGH_PX};
use fmc_exchange::frames::{Flight, FlightExport, ImageNames};
use fmc_exchange::program::{Container, Program};
use fmc_frames::{FlightFrame, FrameCamera, source};
use fmc_output::file_set::FileSet;
use fmc_output::place;
use fmc_reference::residual_splines::ResidualSplines;
use fmc_report::exchange::{ExportSummary, ExportedFlight};
use pyo3::prelude::*;

use crate::error;

/// Files that are to be written, checked.
pub(crate) struct Export {
    pub(crate) text: String,
    pub(crate) file: CameraFile,
    pub(crate) camera: FrameCamera,
    pub(crate) program: Program,
    pub(crate) folder: PathBuf,
    pub(crate) model: Option<String>,
    pub(crate) container: Option<Container>,
    pub(crate) is_binary: bool,
    pub(crate) id: Option<String>,
    pub(crate) max_residual_um: Option<f64>,
    pub(crate) overwrite: bool,
    pub(crate) frames: Option<ExportedFrames>,
}

/// Frames of a flight, with a camera for each.
pub(crate) struct ExportedFrames {
    /// Name of the records in messages and in the statement.
    pub(crate) name: String,
    pub(crate) records: Records,
    pub(crate) images: ImageNames,
    /// Source of the names of the images.
    pub(crate) images_from: String,
}

/// Records of a flight, or a table of exposures.
pub(crate) enum Records {
    /// Path of a file.
    File(PathBuf),
    /// Table in memory, as a file of CSV.
    Table(Vec<u8>),
}

impl Export {
    /// Returns the choices of the program's files.
    pub(crate) fn choices(&self) -> Choices<'_> {
        Choices {
            model: self.model.as_deref(),
            container: self.container,
            is_binary: self.is_binary,
            key: self.id.as_deref(),
        }
    }

    /// Writes the files, which appear together, and returns the statement of what they hold.
    ///
    /// # Errors
    /// `fmc_camera.InvalidFile` for a model that the program does not have or that does not fit the
    /// camera, `fmc_camera.OutOfRange` for a residual that is too large, and `OSError`.
    pub(crate) fn write(&self) -> PyResult<ExportSummary> {
        let grids = self
            .camera
            .grids()
            .map_err(|error| error::of_input(&error))?;
        let splines = ResidualSplines::of(&grids);
        let calibrated = Calibrated::of(&self.file).with_residual(splines);
        match &self.frames {
            None => self.write_camera(&calibrated),
            Some(frames) => self.write_frames(&calibrated, frames),
        }
    }

    fn write_camera(&self, calibrated: &Calibrated) -> PyResult<ExportSummary> {
        let exported = export::export(calibrated, self.program, &self.choices())
            .map_err(|error| error::of_input(&error))?;
        let bytes = self.text.as_bytes();
        let summary = ExportSummary::of(&self.file, bytes, self.program, &exported);
        self.write_files(&summary, |name, sink| {
            let files = exported.files.iter();
            let found = files.filter(|(file, _)| file == name);
            let mut bytes = found.map(|(_, bytes)| bytes);
            bytes.try_for_each(|bytes| sink.write_all(bytes))
        })?;
        Ok(summary)
    }

    fn write_frames(
        &self,
        calibrated: &Calibrated,
        frames: &ExportedFrames,
    ) -> PyResult<ExportSummary> {
        let exit_pupil_mm = self.file.exit_pupil_mm();
        let mut flight = Flight::default();
        let mut push = |frame: FlightFrame| flight.push(&frame, exit_pupil_mm);
        let read = match &frames.records {
            Records::File(path) => source::read(path, &self.camera, &mut push),
            Records::Table(bytes) => {
                source::read_from(&frames.name, bytes.as_slice(), &self.camera, &mut push)
            }
        };
        read.and_then(|()| flight.check(&frames.name))
            .map_err(|error| error::of_input(&error))?;
        let images = &frames.images;
        let export = FlightExport::new(calibrated, &flight, images, self.program, &self.choices())
            .map_err(|error| error::of_input(&error))?;
        let exported = ExportedFlight::of(
            frames.name.clone(),
            frames.images_from.clone(),
            &flight,
            calibrated,
            export.left_out_nm,
        );
        let files = export.files();
        let bytes = self.text.as_bytes();
        let summary = ExportSummary::of(&self.file, bytes, self.program, &export.at_rest)
            .with_frames(self.program, &files, exported);
        self.write_files(&summary, |name, sink| export.write(name, sink))?;
        Ok(summary)
    }

    /// Writes the files of a statement, and the statement.
    fn write_files(
        &self,
        summary: &ExportSummary,
        body: impl Fn(&str, &mut dyn Write) -> io::Result<()>,
    ) -> PyResult<()> {
        self.check_residual(summary)?;
        let folder = &self.folder;
        fs::create_dir_all(folder).map_err(|error| error::of_writing(folder, &error))?;
        let names = summary.files.iter().map(String::as_str);
        for name in names.clone().chain([ExportSummary::FILE]) {
            self.check_place(&folder.join(name))?;
        }
        let mut set = FileSet::default();
        for name in names {
            let path = folder.join(name);
            let written = set.write(&path, |sink| body(name, sink));
            written.map_err(|error| error::of_writing(&path, &error))?;
        }
        let path = folder.join(ExportSummary::FILE);
        let written = set.write(&path, |sink| {
            serde_json::to_writer_pretty(&mut *sink, summary)?;
            writeln!(sink)
        });
        written.map_err(|error: io::Error| error::of_writing(&path, &error))?;
        let completed = set.complete();
        completed.map_err(|file| error::of_writing(&file.path, &file.error))
    }

    /// Refuses to replace the records, and any other file unless that is wanted.
    fn check_place(&self, path: &Path) -> PyResult<()> {
        if !self.overwrite && path.symlink_metadata().is_ok() {
            return Err(error::of_existing(path));
        }
        match self.frames.as_ref().map(|frames| &frames.records) {
            Some(Records::File(input)) if place::is_the_same(path, input) => {
                Err(error::of_text(format!(
                    "folder: {} would be replaced, which is read",
                    input.display()
                )))
            }
            _ => Ok(()),
        }
    }

    fn check_residual(&self, summary: &ExportSummary) -> PyResult<()> {
        match self.max_residual_um {
            Some(limit) if summary.residual_max_um > limit => {
                let text = format!("above max_residual_um = {limit}");
                let value = summary.residual_max_um;
                Err(error::of_number(
                    "residual_max_um",
                    value,
                    [0.0, limit],
                    &text,
                ))
            }
            _ => Ok(()),
        }
    }
}

/// Returns the warning of a large residual.
pub(crate) fn warning(summary: &ExportSummary) -> Option<String> {
    (summary.residual_max_px >= GOOD_ENOUGH_PX).then(|| {
        format!(
            "{} {}: the largest residual is {:.3} px, not below {GOOD_ENOUGH_PX} px",
            summary.format, summary.model, summary.residual_max_px
        )
    })
}
