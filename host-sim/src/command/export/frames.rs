//! Frames of a flight, from its records.

use std::path::Path;

use fmc_camera_file::{CameraFile, GridFiles};
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::export::Choices;
use fmc_exchange::frames::{Flight, FlightExport, ImageNames, ImagePose};
use fmc_exchange::program::Program;
use fmc_frames::{FrameCamera, ImageMap, records};
use fmc_reference::residual_splines::ResidualSplines;
use fmc_report::exchange::{ExportSummary, ExportedFlight};

use crate::cli::ExportArgs;
use crate::command::frames::frame_file;
use crate::command::frames::orientations::Orientations;
use crate::failure::Failure;
use crate::formats::output::{self, OutputFolder, OutputSet};

/// Name of the table of exterior orientations.
const ORIENTATION: &str = "orientation.csv";

pub(super) fn run(
    args: &ExportArgs,
    path: &Path,
    (camera, grids): (&CameraFile, GridFiles),
    camera_bytes: &[u8],
    choices: &Choices<'_>,
) -> Result<(), Failure> {
    let name = args.camera.display().to_string();
    let frame_camera = FrameCamera::with_grids(&name, camera, grids)?;
    let mut flight = read(path, &frame_camera, camera)?;
    let trajectory = args.trajectory.trajectory.as_deref();
    let mut orientations = trajectory
        .map(|path| Orientations::open(&args.trajectory, path, true))
        .transpose()?;
    if let Some(orientations) = &mut orientations {
        add_poses(args, &mut flight, orientations, camera.fmc.axis.unit())?;
    }
    let (images, images_from) = match &args.images {
        Some(map) => (
            ImageNames::Map(ImageMap::read(map)?),
            map.display().to_string(),
        ),
        None => (
            ImageNames::Pattern(args.image_name.clone()),
            args.image_name.text().to_owned(),
        ),
    };
    let splines = ResidualSplines::of(&frame_camera.grids()?);
    let calibrated = Calibrated::of(camera).with_residual(splines);
    let export = FlightExport::new(&calibrated, &flight, &images, args.format, choices)?;
    let files = export.files();
    let frames = ExportedFlight::of(
        path.display().to_string(),
        images_from,
        &flight,
        &calibrated,
        export.left_out_nm,
    );
    let summary = ExportSummary::of(camera, camera_bytes, args.format, &export.at_rest)
        .with_frames(args.format, &files, frames);
    super::check_residual(args, &summary)?;
    let folder = OutputFolder::create(&args.out)?;
    for name in files.iter().chain(&[ExportSummary::FILE, ORIENTATION]) {
        let file = folder.path().join(name);
        let inputs = [
            Some(path),
            Some(&args.camera),
            args.images.as_deref(),
            trajectory,
            args.trajectory.trajectory_accuracy.as_deref(),
        ];
        for input in inputs {
            input.map_or(Ok(()), |input| output::check_not_an_input(&file, input))?;
        }
    }
    let mut set = OutputSet::new(&folder);
    for name in files {
        set.write(name, |sink| export.write(name, sink))?;
    }
    if let Some(orientations) = &mut orientations {
        set.stream(ORIENTATION, |sink| {
            orientations.write(sink, |each| {
                images.each(&flight.frames, |frame, image| {
                    each(frame.sequence, image, frame.centroid_utc)
                })
            })
        })?;
    }
    super::conclude(set, &summary)
}

/// Adds the poses of the exposures, for a program that has a place for them, and says which
/// exposures have none.
fn add_poses(
    args: &ExportArgs,
    flight: &mut Flight,
    orientations: &mut Orientations<'_>,
    axis: [f64; 2],
) -> Result<(), Failure> {
    let mut poses = Vec::new();
    for frame in &flight.frames {
        if let Ok(given) = orientations.as_given(frame.sequence, frame.centroid_utc)? {
            let orientation = match args.format {
                // They take geographic places, with angles against east, north and up there.
                Program::Metashape | Program::OpenSfm => given,
                _ => orientations.about_origin(&given),
            };
            poses.push((frame.sequence, ImagePose::of(&orientation, axis)));
        }
    }
    orientations.conclude()?;
    poses.sort_by_key(|(sequence, _)| *sequence);
    if Program::WITH_POSES.contains(&args.format) {
        flight.poses = Some(poses);
    }
    Ok(())
}

/// Reads the records of a flight, and keeps of each what a program needs.
fn read(path: &Path, frame_camera: &FrameCamera, camera: &CameraFile) -> Result<Flight, Failure> {
    let exit_pupil_mm = camera.exit_pupil_mm();
    let mut flight = Flight::default();
    frame_file::with_bar(path, true, |name, source| {
        records::read_from(name, source, frame_camera, |frame| {
            flight.push(&frame, exit_pupil_mm)
        })
    })?;
    flight.check(&path.display().to_string())?;
    Ok(flight)
}
