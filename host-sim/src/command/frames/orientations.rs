//! Exterior orientations of the frames, from the trajectory of the flight.

use std::io::Write;
use std::path::Path;

use fmc_camera::flight::utc::UtcTime;
use fmc_frames::trajectory::{Coordinates, ImageOrientation, Trajectory, Unavailable};

use super::FlightFile;
use crate::cli::{OffTrajectoryName, TrajectoryArgs};
use crate::command::point_stream::progress;
use crate::failure::{Failure, note};
use crate::formats::orientation::OrientationTable;
use crate::formats::output::{self, Stopped};

/// The trajectory of a flight, and the exposures that it does not cover.
pub(in crate::command) struct Orientations<'a> {
    args: &'a TrajectoryArgs,
    trajectory: Trajectory,
    found: u64,
    missing: u64,
    first_missing: Option<(u32, Unavailable)>,
}

impl<'a> Orientations<'a> {
    /// Opens the trajectory that is asked for, for a table with x, y and z or for a list.
    ///
    /// # Errors
    /// [`Failure`] of the trajectory, and for an origin that does not go with it.
    pub(in crate::command) fn open(
        args: &'a TrajectoryArgs,
        path: &Path,
        is_for_a_table: bool,
    ) -> Result<Self, Failure> {
        let bytes = std::fs::metadata(path).ok().map(|metadata| metadata.len());
        let bar = progress(bytes, true);
        let trajectory = Trajectory::open(path, &args.options(), |bytes| bar.set_position(bytes));
        bar.finish_and_clear();
        let trajectory = trajectory?;
        let is_geographic = trajectory.coordinates() == Coordinates::Geographic;
        match args.origin {
            None if is_geographic && is_for_a_table => {
                return Err(Failure::bad_input(format!(
                    "--trajectory: {} has geographic coordinates; --origin LAT,LON,H is missing, about which x, y \
                     and z of the table are east, north and up",
                    path.display()
                )));
            }
            Some(_) if !is_geographic => {
                return Err(Failure::bad_input(format!(
                    "--origin: {} has the coordinates x_m, y_m and z_m already",
                    path.display()
                )));
            }
            _ => {}
        }
        if !trajectory.has_week() {
            note(format_args!(
                "note: {} states no week; its times are taken for the week of the exposures",
                path.display()
            ));
        }
        Ok(Self {
            args,
            trajectory,
            found: 0,
            missing: 0,
            first_missing: None,
        })
    }

    /// Returns the orientation of an exposure, about the origin if there is one; or why it has
    /// none, where that is no error.
    ///
    /// # Errors
    /// [`Failure`] naming the frame.
    pub(in crate::command) fn of(
        &mut self,
        sequence: u32,
        centroid: Option<UtcTime>,
    ) -> Result<Result<ImageOrientation, Unavailable>, Failure> {
        let found = self.as_given(sequence, centroid)?;
        Ok(found.map(|orientation| self.about_origin(&orientation)))
    }

    /// Returns an orientation about the origin, if there is one.
    pub(in crate::command) fn about_origin(
        &self,
        orientation: &ImageOrientation,
    ) -> ImageOrientation {
        let origin = self.args.origin.as_ref();
        origin.map_or(*orientation, |origin| orientation.about(origin))
    }

    /// As [`of`](Self::of), in the coordinates of the trajectory.
    ///
    /// # Errors
    /// [`Failure`] naming the frame.
    pub(in crate::command) fn as_given(
        &mut self,
        sequence: u32,
        centroid: Option<UtcTime>,
    ) -> Result<Result<ImageOrientation, Unavailable>, Failure> {
        let found = self.trajectory.at(centroid)?;
        match found {
            Ok(orientation) => {
                self.found += 1;
                Ok(Ok(orientation))
            }
            Err(reason) if self.args.off_trajectory == OffTrajectoryName::Error => Err(
                Failure::bad_input(format!("--trajectory: frame {sequence}: {reason}"))
                    .with_help("--off-trajectory skip goes on without its orientation"),
            ),
            Err(reason) => {
                self.missing += 1;
                self.first_missing.get_or_insert((sequence, reason));
                Ok(Err(reason))
            }
        }
    }

    /// Writes the table of the exposures that `exposures` hands on: sequence number, name of the
    /// image, and centroid.
    ///
    /// # Errors
    /// [`Failure`] of an exposure, of `exposures` or of the sink.
    pub(in crate::command) fn write(
        &mut self,
        sink: &mut dyn Write,
        exposures: impl FnOnce(
            &mut dyn FnMut(u32, &str, Option<UtcTime>) -> Result<(), Stopped>,
        ) -> Result<(), Stopped>,
    ) -> Result<(), Stopped> {
        let mut table = OrientationTable::new(sink);
        exposures(&mut |sequence, image, centroid| {
            if let Ok(orientation) = self.of(sequence, centroid)? {
                table.write(image, &orientation)?;
            }
            Ok(())
        })?;
        Ok(table.end()?)
    }

    /// Says which exposures have no orientation, and forgets them.
    ///
    /// # Errors
    /// [`Failure`] if none has one.
    pub(in crate::command) fn conclude(&mut self) -> Result<(), Failure> {
        let [found, missing] = [&mut self.found, &mut self.missing].map(std::mem::take);
        let Some((sequence, reason)) = self.first_missing.take() else {
            return Ok(());
        };
        if found == 0 {
            return Err(Failure::bad_input(format!(
                "--trajectory: no exposure has an orientation; frame {sequence}: {reason}"
            )));
        }
        note(format_args!(
            "note: {missing} of {} exposures have no orientation; the first is frame {sequence}: {reason}",
            missing + found
        ));
        Ok(())
    }

    /// Writes the table that is asked for, of all exposures of a flight.
    ///
    /// # Errors
    /// [`Failure`] of the trajectory, the frames and the table.
    pub(super) fn write_table(&mut self, flight: &FlightFile) -> Result<(), Failure> {
        let Some(table) = &self.args.orientation else {
            return Ok(());
        };
        flight.check_out(Some(table))?;
        output::stream(Some(table), |sink| {
            self.write(sink, |each| {
                flight.read(|frame| match frame.exposed() {
                    Some(exposed) => {
                        let number = frame.sequence.to_string();
                        let image = frame.image.as_deref().unwrap_or(&number);
                        each(frame.sequence, image, exposed.centroid_utc)
                    }
                    None => Ok(()),
                })
            })?;
            Ok(self.conclude()?)
        })
    }
}
