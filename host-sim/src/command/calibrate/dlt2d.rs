//! `calibrate dlt2d`: distortion tables from a plane target.

use std::path::PathBuf;

use fmc_adjustment::calibration::dlt2d::distortion_table::Dlt2d;
use fmc_adjustment::calibration::dlt2d::dlt2d;
use fmc_adjustment::calibration::dlt2d::request::Dlt2dRequest;
use fmc_adjustment::grid::calibration::GridCalibration;
use fmc_camera::geometry::grid::GridCarrier;
use fmc_camera_file::CameraFile;
use fmc_camera_file::grid_block::without_grids;
use fmc_report::calibration::dlt2d::of_method;
use fmc_report::calibration::grid;
use fmc_report::calibration::result::of_method::PageTable;

use super::held_grids::{HeldGrids, add_files};
use super::report::{self, Prepared};
use crate::cli::{Dlt2dArgs, OneGridPart};
use crate::failure::Failure;
use crate::formats::calibration_points;

/// Runs `calibrate dlt2d`; each focus setting has a folder of its own.
pub(in crate::command) fn run(args: &Dlt2dArgs) -> Result<(), Failure> {
    report::check_date(&args.common.files)?;
    let corners = corners(args)?;
    let path = args.common.files.camera.as_path();
    let (name, text) = (path.display().to_string(), report::camera_text(path)?);
    // With --grid, grids of a former calibration are replaced.
    let (camera, held) = if args.grid {
        let (camera, _) = CameraFile::parse(&name, &without_grids(&name, &text)?)?;
        crate::command::warn_of_distortion(path, &camera);
        (camera, HeldGrids::default())
    } else {
        HeldGrids::read(path)?
    };
    let file = calibration_points::plane_targets(&args.targets, &camera)?;
    if file.settings.is_empty() {
        return Err(Failure::bad_input(format!(
            "{}: there is no target",
            file.input.file
        )));
    }
    let mut prepared = Vec::new();
    for setting in &file.settings {
        let mut found = dlt2d(&Dlt2dRequest {
            input: file.input.clone(),
            has_sigma: file.has_sigma,
            focus: setting.focus.clone(),
            targets: &setting.targets,
            camera: &camera,
            grids: held.splines(),
            corners: corners.as_ref(),
            is_estimated: args.estimate.0,
            keeps_all: args.common.keep_all,
        })?;
        let mut of_method = of_method(&found).map_err(report::failed)?;
        let grid = grid(args, &found)?;
        if let Some(grid) = &grid {
            of_method.join(grid::of_method(grid).map_err(report::failed)?);
            let doubts = grid
                .result
                .warnings
                .iter()
                .map(|warning| format!("grid: {warning}"));
            found.result.warnings.extend(doubts);
        }
        let mut tables: Vec<String> = of_method.tables.iter().map(PageTable::text).collect();
        if let Some(focus) = &setting.focus {
            tables.push(format!("the tables above are those of focus {focus}\n"));
        }
        let folder = folder(args, setting.focus.as_deref(), file.settings.len())?;
        let made = match &grid {
            Some(grid) => super::grid::camera_file(&name, &text, grid),
            None => held.camera_file(&name, &text, &found.result.calibrated),
        };
        held.state(&mut found.result, &mut of_method);
        let grids = made.as_ref().map_or(&[][..], |(_, grids)| grids);
        let former = add_files(&mut of_method, grids);
        let made = made.map(|(text, _)| text);
        let outputs = Prepared::with_camera(
            &mut found.result,
            of_method,
            made,
            &args.common.files,
            &[&args.targets],
            folder.as_deref(),
        )?
        .without(former);
        prepared.push((found, tables, outputs));
    }
    // A setting without a usable camera does not keep the others from their files.
    let mut conclusion = Ok(());
    for (found, tables, outputs) in prepared {
        report::print(&found.result, &tables)?;
        conclusion = conclusion.and(outputs.write());
    }
    conclusion
}

/// Returns the grid that is asked for.
fn grid(args: &Dlt2dArgs, found: &Dlt2d) -> Result<Option<GridCalibration>, Failure> {
    let Some(pitch_mm) = args.pitch_mm else {
        return Ok(None);
    };
    let carrier = match args.frame {
        OneGridPart::Lens => GridCarrier::Lens,
        OneGridPart::Sensor => GridCarrier::Sensor,
    };
    Ok(Some(found.leftover_grid(carrier, pitch_mm)?))
}

fn corners(args: &Dlt2dArgs) -> Result<Option<[String; 4]>, Failure> {
    let Some(names) = &args.corners else {
        return Ok(None);
    };
    let names: Vec<String> = names.iter().map(|name| name.trim().to_owned()).collect();
    let count = names.len();
    names.try_into().map(Some).map_err(|_| {
        Failure::bad_input(format!(
            "--corners: {count} targets; allowed: four, separated by commas"
        ))
    })
}

/// Returns the folder of a focus setting: that of `--out` if there is one setting.
fn folder(
    args: &Dlt2dArgs,
    focus: Option<&str>,
    settings: usize,
) -> Result<Option<PathBuf>, Failure> {
    let Some(out) = &args.common.files.out else {
        return Ok(None);
    };
    let Some(focus) = focus.filter(|_| settings > 1) else {
        return Ok(Some(out.clone()));
    };
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "-_.+".contains(letter);
    if !focus.chars().all(is_plain) || focus.starts_with('.') {
        return Err(Failure::bad_input(format!(
            "{}: focus {focus} cannot be part of the name of a folder; allowed: letters, digits, - _ . +",
            args.targets.display()
        )));
    }
    Ok(Some(out.join(format!("focus-{focus}"))))
}
