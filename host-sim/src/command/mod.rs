//! The commands.

mod block;
mod bring_up;
mod budget;
mod calibrate;
mod camera;
mod camera_file;
mod camera_store;
mod campaign;
mod certificate;
mod composition;
mod device;
mod earlier_records;
mod export;
mod exposure;
mod frame;
mod frames;
mod images;
mod import;
mod mesh;
mod mission;
mod point_stream;
mod points;
mod records;
mod rectify;
mod reference;
mod serve;
mod sign;
mod smear;
mod statistics;
mod strip;
mod sweep;
mod verify;

use std::path::Path;

use fmc_camera::flight::camera::Camera;
use fmc_camera_file::{CameraFile, GridFiles, MechanismName};

use crate::cli::{CalibrationMethod, Cli, Command, SceneCamera};
use crate::failure::{Failure, note};

/// Runs a command.
///
/// # Errors
/// [`Failure`] with the exit code and the text for the user.
pub fn run(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        Command::Verify(args) => verify::run(&args),
        Command::Correct(args) => points::run(&args, points::Direction::Correct),
        Command::Distort(args) => points::run(&args, points::Direction::Distort),
        Command::Reference(args) => reference::run(&args),
        Command::Frame(args) => frame::run(&args),
        Command::Mesh(args) => mesh::run(&args),
        Command::Rectify(args) => rectify::run(&args),
        Command::Render(args) => images::render::run(&args),
        Command::Compare(args) => images::compare::run(&args),
        Command::Scene(args) => match args.camera {
            SceneCamera::Dmz(args) => composition::scene::run(&args),
        },
        Command::Virtual(args) => composition::virtual_image::run(&args),
        Command::Stereo(args) => composition::stereo::run(&args),
        Command::Dmz(args) => composition::dmz::run(&args),
        Command::Budget(args) => budget::run(&args),
        Command::Calibrate(args) => match args.method {
            CalibrationMethod::Five(args) => calibrate::five(&args),
            CalibrationMethod::Resection(args) => calibrate::network::resection(&args),
            CalibrationMethod::Bundle(args) => calibrate::network::bundle(&args),
            CalibrationMethod::Dlt3d(args) => calibrate::dlt3d::run(&args),
            CalibrationMethod::Dlt2d(args) => calibrate::dlt2d::run(&args),
            CalibrationMethod::Angles(args) => calibrate::angles::run(&args),
            CalibrationMethod::Grid(args) => calibrate::grid::run(&args),
            CalibrationMethod::Radiometry(args) => composition::radiometry::run(&args),
            CalibrationMethod::Rig(args) => composition::rig::run(&args),
        },
        Command::Smear(args) => smear::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Strip(args) => strip::run(&args),
        Command::Block(args) => block::run(&args),
        Command::Mission(args) => mission::run(&args),
        Command::Statistics(args) => statistics::run(&args),
        Command::Campaign(args) => campaign::run(&args),
        Command::Records(args) => records::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Import(args) => import::run(&args),
        Command::Certificate(args) => certificate::run(&args),
        Command::Sign(args) => sign::run(&args),
        Command::Camera(args) => camera::run(&args),
        Command::Serve(args) => serve::run(&args),
        Command::CameraFile(args) => camera_file::run(&args),
    }
}

/// Why the five-coefficient model takes no camera with residual grids.
const FIVE_KNOW_NO_GRIDS: &str = "the five coefficients are fitted to distortions of the polynomial and its motion; those of a grid would bend them";

/// Reads a camera file for a command that has no place for residual grids, and prints a warning if
/// its distortion is hardly believable; `why` says what it has no place for.
///
/// # Errors
/// [`Failure`] of the camera file.
fn read_camera(path: &Path, why: &str) -> Result<(CameraFile, Camera), Failure> {
    let (file, camera) = CameraFile::read_polynomial(path, why)?;
    warn_of_distortion(path, &file);
    Ok((file, camera))
}

/// Reads a camera file with its residual grids, and prints the same warning.
///
/// # Errors
/// [`Failure`] of the camera file or of a grid.
fn read_camera_with_grids(path: &Path) -> Result<(CameraFile, GridFiles), Failure> {
    let (file, _, grids) = CameraFile::read_with_grids(path)?;
    warn_of_distortion(path, &file);
    Ok((file, grids))
}

/// Prints a warning if the distortion of a camera file is hardly believable.
fn warn_of_distortion(path: &Path, file: &CameraFile) {
    if let Some(warning) = file.distortion_warning() {
        note(format_args!("warning: {}: {warning}", path.display()));
    }
}

/// Prints a note if a camera file has a run-up strategy that its mechanism does not use.
fn note_unused_strategy(path: &Path, file: &CameraFile) {
    if file.fmc.mechanism == MechanismName::Tdi && file.fmc.strategy.is_some() {
        note(format_args!(
            "note: {}: strategy has no effect with mechanism = \"tdi\"; the row labels fix the opening offset",
            path.display()
        ));
    }
}
