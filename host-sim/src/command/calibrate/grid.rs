//! `calibrate grid`: polynomial and residual grids from a distortion table.

use std::path::Path;

use fmc_adjustment::grid::calibration::{GridCalibration, grid_calibration};
use fmc_adjustment::grid::request::GridCalibrationRequest;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::grid_block::{NamedFiles, without_grids};
use fmc_camera_file::{CameraFile, GridFiles, InputError};
use fmc_report::calibration::grid::of_method;
use fmc_report::calibration::result::of_method::PageTable;

use super::held_grids::{add_files, with_grids};
use super::report::{self, Prepared};
use crate::cli::{GridArgs, GridPart};
use crate::failure::Failure;
use crate::formats::calibration_points;

/// Runs `calibrate grid`.
pub(in crate::command) fn run(args: &GridArgs) -> Result<(), Failure> {
    report::check_date(&args.files)?;
    let path = args.files.camera.as_path();
    let name = path.display().to_string();
    // Grids of a former calibration are replaced.
    let text = without_grids(&name, &report::camera_text(path)?)?;
    let (camera, _) = CameraFile::parse(&name, &text)?;
    crate::command::warn_of_distortion(path, &camera);
    let table = calibration_points::distortion_table(&args.table, &camera)?;
    let mut found = grid_calibration(&GridCalibrationRequest {
        input: table.input,
        observations: &table.observations,
        camera: &camera,
        carriers: match args.frame {
            GridPart::Lens => &[GridCarrier::Lens],
            GridPart::Sensor => &[GridCarrier::Sensor],
            GridPart::Both => &[GridCarrier::Lens, GridCarrier::Sensor],
        },
        pitch_mm: args.pitch_mm,
        is_estimated: args.estimate.0,
    })?;
    if table.has_sigma {
        let note = "σ of the file is not used: all rows of a table weigh the same";
        found.result.notes.push(note.to_owned());
    }
    let mut of_method = of_method(&found).map_err(report::failed)?;
    let tables: Vec<String> = of_method.tables.iter().map(PageTable::text).collect();
    let made = camera_file(&name, &text, &found);
    let grids = made.as_ref().map_or(&[][..], |(_, grids)| grids);
    let former = add_files(&mut of_method, grids);
    let made = made.map(|(text, _)| text);
    let inputs: [&Path; 1] = [&args.table];
    let folder = args.files.out.as_deref();
    let result = &mut found.result;
    let outputs = Prepared::with_camera(result, of_method, made, &args.files, &inputs, folder)?;
    report::print(&found.result, &tables)?;
    outputs.without(former).write()
}

/// Returns the text of the camera file with polynomial and grids, which a camera accepts, and the
/// files of the grids.
pub(super) fn camera_file(
    name: &str,
    text: &str,
    found: &GridCalibration,
) -> Result<(String, NamedFiles), InputError> {
    let bytes = |carrier: GridCarrier| {
        let grid = found.grids.iter().find(|grid| grid.carrier == carrier);
        grid.map(|grid| grid.bytes.clone())
    };
    let grids = GridFiles::new(bytes(GridCarrier::Lens), bytes(GridCarrier::Sensor));
    with_grids(name, text, &found.result.calibrated, &grids)
}
