//! `calibrate dlt3d`: one image of a spatial test field.

use fmc_adjustment::calibration::dlt3d::{Dlt3dRequest, dlt3d};
use fmc_report::calibration::dlt3d::of_method;
use fmc_report::calibration::result::of_method::PageTable;

use super::held_grids::HeldGrids;
use super::report::{self, Prepared};
use crate::cli::Dlt3dArgs;
use crate::failure::Failure;
use crate::formats::calibration_points;

/// Runs `calibrate dlt3d`.
pub(in crate::command) fn run(args: &Dlt3dArgs) -> Result<(), Failure> {
    report::check_date(&args.common.files)?;
    let (camera, held) = HeldGrids::read(&args.common.files.camera)?;
    let file = calibration_points::field_points(&args.points, &camera)?;
    let mut found = dlt3d(&Dlt3dRequest {
        input: file.input,
        has_sigma: file.has_sigma,
        points: &file.points,
        camera: &camera,
        grids: held.splines(),
        is_estimated: args.estimate.0,
        keeps_all: args.common.keep_all,
    })?;
    let of_method = of_method(&found);
    let tables: Vec<String> = of_method.tables.iter().map(PageTable::text).collect();
    let prepared = Prepared::of(
        &mut found.result,
        of_method,
        &held,
        &args.common.files,
        &[&args.points],
        args.common.files.out.as_deref(),
    )?;
    report::print(&found.result, &tables)?;
    prepared.write()
}
