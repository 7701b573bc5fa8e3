//! `calibrate angles`: one line of the sensor on a turntable.

use fmc_adjustment::calibration::angles::angles;
use fmc_adjustment::calibration::angles::budget::Uncertainty;
use fmc_adjustment::calibration::angles::request::{AnglesRequest, LineAxis};
use fmc_camera_file::CameraFile;
use fmc_report::calibration::angles::{of_method, tables};
use fmc_report::calibration::result::of_method::PageTable;

use super::report::{self, Prepared};
use crate::cli::{AlongAxis, AnglesArgs};
use crate::failure::Failure;
use crate::formats::calibration_points;

/// σ of a place without another statement, as a share of a pixel (Li et al., section 2.4).
const PLACE_PX: f64 = 0.1;

/// Runs `calibrate angles`.
pub(in crate::command) fn run(args: &AnglesArgs) -> Result<(), Failure> {
    report::check_date(&args.common)?;
    let (camera, _) = crate::command::read_camera(&args.common.camera)?;
    let (input, observations) = calibration_points::line_angles(&args.angles)?;
    let mut found = angles(&AnglesRequest {
        input,
        observations: &observations,
        camera: &camera,
        along: match args.along {
            AlongAxis::X => LineAxis::X,
            AlongAxis::Y => LineAxis::Y,
        },
        uncertainty: uncertainty(args, &camera),
        keeps_all: args.common.keep_all,
    })?;
    let of_method = of_method(&found).map_err(report::failed)?;
    let texts: Vec<String> = tables(&found).iter().map(PageTable::text).collect();
    let prepared = Prepared::of(
        &mut found.result,
        of_method,
        &args.common,
        &[&args.angles],
        args.common.out.as_deref(),
    )?;
    report::print(&found.result, &texts)?;
    prepared.write()
}

fn uncertainty(args: &AnglesArgs, camera: &CameraFile) -> Uncertainty {
    let place_um = args.sigma_l_um.unwrap_or(PLACE_PX * camera.sensor.pixel_um);
    Uncertainty {
        place_mm: place_um / 1e3,
        angle_rad: (args.sigma_angle_arcsec / 3600.0).to_radians(),
    }
}
