//! `mesh` for the frames of a flight: a folder each, or the mesh of one of them.

use std::path::PathBuf;

use fmc_camera::flight::camera::Frame;
use fmc_camera_file::InputError;
use fmc_frames::{FlightFrame, Outcome};
use fmc_reference::verification::device::CorrectingDevice;

use super::FlightFile;
use crate::cli::{DirectionName, MeshArgs};
use crate::command::mesh::{self, Layout, MeshFrame};
use crate::device::InProcess;
use crate::failure::{Failure, note};

pub(in crate::command) fn run(args: &MeshArgs) -> Result<(), Failure> {
    mesh::check_spacing(args)?;
    let flight = FlightFile::open(&args.exposure, &args.frames, &args.device)?;
    let layout = Layout::new(args, &flight.file)?;
    let mut device = InProcess::default();
    device
        .load_grids(flight.camera.grid_files())
        .and_then(|()| device.load(&flight.file.parameters()))
        .map_err(|error| args.exposure.refused(&flight.file, &error))?;
    let (mut found, mut refused) = (false, Vec::new());
    flight.read(|frame| {
        if args.sequence.is_some_and(|wanted| wanted != frame.sequence) {
            return Ok(());
        }
        found = true;
        let exposed = match &frame.outcome {
            Outcome::Exposed(exposed) => exposed,
            Outcome::Refused(reason) if args.sequence.is_some() => {
                return Err(Failure::bad_input(format!(
                    "--sequence {}: the trigger was refused ({reason}), there is no exposure ({})",
                    frame.sequence,
                    flight.name()
                )));
            }
            Outcome::Refused(_) => {
                refused.push(frame.sequence.to_string());
                return Ok(());
            }
        };
        let correction = exposed.correction(flight.camera.calibration());
        let correction = correction.ok_or_else(|| {
            InputError::invalid(format!(
                "frame {}: the camera has no [fitted]",
                frame.sequence
            ))
        })?;
        let interior = &exposed.interior;
        device.correct_by(Frame {
            interior: *interior,
            correction,
        });
        let mesh_frame = MeshFrame {
            interior,
            correction: &correction,
            direction: if interior.motion.travel_mm < 0.0 {
                DirectionName::Reverse
            } else {
                DirectionName::Forward
            },
            sequence: Some(frame.sequence),
        };
        let out = folder(args, &frame);
        mesh::write(args, &flight.file, &layout, &mut device, &mesh_frame, &out)
    })?;
    match args.sequence {
        Some(sequence) if !found => Err(Failure::bad_input(format!(
            "--sequence {sequence}: there is no such frame in {}",
            flight.name()
        ))),
        _ => {
            if !refused.is_empty() {
                note(format_args!(
                    "note: no mesh of the refused triggers {}",
                    refused.join(", ")
                ));
            }
            Ok(())
        }
    }
}

/// Returns the folder of a frame's mesh.
fn folder(args: &MeshArgs, frame: &FlightFrame) -> PathBuf {
    match args.sequence {
        Some(_) => args.out.clone(),
        None => args.out.join(format!("{:05}", frame.sequence)),
    }
}
