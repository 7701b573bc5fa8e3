//! `calibrate bundle --export`: the adjusted block for programs that know one camera without
//! distortion.

use std::io;

use fmc_adjustment::bundle::calibration::BundleCalibration;
use fmc_adjustment::bundle::parameters::SharedValues;
use fmc_camera_file::CameraFile;
use fmc_exchange::calibrated::Calibrated;
use fmc_exchange::hand_over::{AdjustedImage, AdjustedPoint, CorrectedPoint, Files, HandOver};

use crate::cli::HandOverFormat;
use crate::failure::Failure;

/// Returns the files of all formats.
pub(super) fn files(
    calibration: &BundleCalibration,
    camera: &CameraFile,
    formats: &[HandOverFormat],
) -> Result<Files, Failure> {
    let mut files = Files::new();
    if formats.is_empty() {
        return Ok(files);
    }
    let block = block(calibration, camera);
    for format in formats {
        files.extend(match format {
            HandOverFormat::Colmap => block.colmap()?,
            HandOverFormat::Csv => block
                .csv()
                .map_err(|error| Failure::writing("lists", &io::Error::other(error)))?,
        });
    }
    Ok(files)
}

/// Returns the adjusted images and points; image points that were rejected stay out.
fn block(calibration: &BundleCalibration, camera: &CameraFile) -> HandOver {
    let (network, solution) = (&calibration.snooped.network, &calibration.snooped.solution);
    let SharedValues {
        interior, stage, ..
    } = &solution.state.parameters;
    let [x0, y0] = interior.principal_point_mm;
    let mut images: Vec<AdjustedImage> = network
        .images
        .iter()
        .zip(&solution.state.poses)
        .map(|(image, pose)| AdjustedImage {
            name: image.name.clone(),
            position_m: pose.position_m,
            ground_from_camera: pose.rotation,
            attitude_deg: pose.orientation().attitude.map(f64::to_degrees),
            points: Vec::new(),
        })
        .collect();
    let used = network.image_points.iter();
    for observed in used.filter(|observed| solution.layout.uses(observed)) {
        let setting = network.images.get(observed.image);
        let setting = setting.and_then(|image| image.stage.as_ref());
        let point = stage.reduced_point(setting, observed.measured_mm);
        let [of_grids_x, of_grids_y] = observed.by_grids_mm;
        let ideal = interior.corrected(point);
        if let Some(image) = images.get_mut(observed.image) {
            image.points.push(CorrectedPoint {
                point: observed.point,
                corrected_mm: [x0 + ideal.x - of_grids_x, y0 + ideal.y - of_grids_y],
                sigma_mm: observed.sigma_mm,
            });
        }
    }
    let points = network
        .points
        .iter()
        .zip(&solution.state.points_m)
        .map(|(point, position)| AdjustedPoint {
            name: point.name.clone(),
            position_m: *position,
        })
        .collect();
    HandOver {
        camera: Calibrated {
            principal_distance_mm: interior.principal_distance_mm,
            principal_point_mm: interior.principal_point_mm,
            ..Calibrated::of(camera)
        },
        images,
        points,
    }
}
