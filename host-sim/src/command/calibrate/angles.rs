//! `calibrate angles`: one line of the sensor, or an area with its stage, on a turntable.

use fmc_adjustment::calibration::angles::angles;
use fmc_adjustment::calibration::angles::budget::Uncertainty;
use fmc_adjustment::calibration::angles::request::{AngleObservation, AnglesRequest, LineAxis};
use fmc_adjustment::calibration::result::{CalibrationResult, InputFile};
use fmc_adjustment::field_angles::{FieldAnglesRequest, field_angles};
use fmc_camera_file::CameraFile;
use fmc_report::calibration::angles::{of_method, tables};
use fmc_report::calibration::field_angles as area;
use fmc_report::calibration::result::of_method::{OfMethod, PageTable};

use super::held_grids::HeldGrids;
use super::report::{self, Prepared};
use crate::cli::{AlongAxis, AnglesArgs};
use crate::failure::Failure;
use crate::formats::calibration_points::{self, FieldDirections, TurntableAngles};

/// σ of a place without another statement, as a share of a pixel (Li et al., section 2.4).
const PLACE_PX: f64 = 0.1;

/// Runs `calibrate angles`: the header of the observations says which of the two it is.
pub(in crate::command) fn run(args: &AnglesArgs) -> Result<(), Failure> {
    report::check_date(&args.common.files)?;
    let (camera, held) = HeldGrids::read(&args.common.files.camera)?;
    match calibration_points::turntable_angles(&args.angles, &camera)? {
        TurntableAngles::Line(..) if !held.is_empty() => Err(Failure::bad_input(format!(
            "{}: [grid]: residual grids are not used with one line of the sensor, {}: they are of an area, across the line, too",
            args.common.files.camera.display(),
            args.angles.display()
        ))
        .with_help("for the polynomial alone, take [grid] out of a copy of the file")),
        TurntableAngles::Line(input, observations) => line(args, &camera, input, &observations),
        TurntableAngles::Area(file) => of_area(args, &camera, &held, file),
    }
}

fn line(
    args: &AnglesArgs,
    camera: &CameraFile,
    input: InputFile,
    observations: &[AngleObservation],
) -> Result<(), Failure> {
    if args.estimate.is_some() {
        return Err(Failure::bad_input(format!(
            "--estimate: {} is of one line of the sensor, of which the same five unknowns are always estimated",
            args.angles.display()
        )));
    }
    let mut found = angles(&AnglesRequest {
        input,
        observations,
        camera,
        along: match args.along.unwrap_or(AlongAxis::X) {
            AlongAxis::X => LineAxis::X,
            AlongAxis::Y => LineAxis::Y,
        },
        uncertainty: uncertainty(args, camera),
        keeps_all: args.common.keep_all,
    })?;
    let of_method = of_method(&found).map_err(report::failed)?;
    let texts: Vec<String> = tables(&found).iter().map(PageTable::text).collect();
    let held = HeldGrids::default();
    written(args, &mut found.result, of_method, &held, &texts)
}

fn of_area(
    args: &AnglesArgs,
    camera: &CameraFile,
    held: &HeldGrids,
    file: FieldDirections,
) -> Result<(), Failure> {
    let name = args.angles.display();
    if args.along.is_some() {
        return Err(Failure::bad_input(format!(
            "--along: {name} is of an area, not of one line of the sensor"
        )));
    }
    if args.sigma_l_um.is_some() && file.has_sigma {
        return Err(Failure::bad_input(format!(
            "--sigma-l-um: {name} has a column of σ; leave one of them out"
        )));
    }
    let Uncertainty {
        place_mm,
        angle_rad,
    } = uncertainty(args, camera);
    let mut directions = file.directions;
    if !file.has_sigma {
        for one in &mut directions {
            one.sigma_mm = place_mm;
        }
    }
    let estimated = args.estimate.clone().unwrap_or_default();
    let mut found = field_angles(&FieldAnglesRequest {
        input: file.input,
        observations: &directions,
        has_stage: file.has_stage,
        camera,
        grids: held.splines(),
        estimated: &estimated.0,
        sigma_angle_rad: angle_rad,
        keeps_all: args.common.keep_all,
    })?;
    let of_method = area::of_method(&found);
    let texts: Vec<String> = of_method.tables.iter().map(PageTable::text).collect();
    written(args, &mut found.result, of_method, held, &texts)
}

fn written(
    args: &AnglesArgs,
    result: &mut CalibrationResult,
    of_method: OfMethod,
    held: &HeldGrids,
    texts: &[String],
) -> Result<(), Failure> {
    let prepared = Prepared::of(
        result,
        of_method,
        held,
        &args.common.files,
        &[&args.angles],
        args.common.files.out.as_deref(),
    )?;
    report::print(result, texts)?;
    prepared.write()
}

fn uncertainty(args: &AnglesArgs, camera: &CameraFile) -> Uncertainty {
    let place_um = args.sigma_l_um.unwrap_or(PLACE_PX * camera.sensor.pixel_um);
    Uncertainty {
        place_mm: place_um / 1e3,
        angle_rad: (args.sigma_angle_arcsec / 3600.0).to_radians(),
    }
}
