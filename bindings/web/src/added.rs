//! What the motion of an exposure adds to the distortion, over the sensor.

use fmc::flight::camera::Camera;
use fmc::geometry::frame_correction::FrameCorrection;
use fmc_camera_c::{
    FMC_ERROR_NULL, FMC_OK, Refusal, fmc_camera_record, fmc_error, fmc_exposure, fmc_status,
};

use crate::distortion::{SIDE_POINTS, difference, points};

/// Points over the sensor.
pub const POINTS: usize = (SIDE_POINTS as usize) * (SIDE_POINTS as usize);

/// What the motion adds at a point.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Added {
    /// Measured point, sensor frame, mm.
    pub x_mm: f32,
    /// Measured point, sensor frame, mm.
    pub y_mm: f32,
    /// To the right, mm.
    pub dx_mm: f32,
    /// Upwards, mm.
    pub dy_mm: f32,
}

/// Computes what the motion of an exposure adds to the distortion at 21 x 21 points, row after row
/// from the lower left corner, edges included.
///
/// # Model
/// Distortion of the frame less that of the static calibration, both measured - ideal, at the same
/// measured point: what software adds to its corrected coordinates that does not know the motion.
///
/// # Units and frames
/// Sensor frame, mm.
///
/// # Errors
/// As `fmc_camera_init` for the record and `fmc_frame_init` for the exposure; `added` is then as
/// before.
#[unsafe(no_mangle)]
pub extern "C" fn fmc_web_added(
    record: Option<&fmc_camera_record>,
    exposure: Option<&fmc_exposure>,
    added: Option<&mut [Added; POINTS]>,
    error: Option<&mut fmc_error>,
) -> fmc_status {
    let (Some(record), Some(exposure), Some(added)) = (record, exposure, added) else {
        return FMC_ERROR_NULL;
    };
    match fill(record, exposure, added) {
        Ok(()) => FMC_OK,
        Err(refusal) => {
            let refusal = fmc_error::from(refusal);
            if let Some(error) = error {
                *error = refusal;
            }
            refusal.status
        }
    }
}

fn fill(
    record: &fmc_camera_record,
    exposure: &fmc_exposure,
    added: &mut [Added; POINTS],
) -> Result<(), Refusal> {
    let camera = Camera::new(record.parameters()?)?;
    let frame = camera.frame(&exposure.exposure()?)?;
    let still = FrameCorrection::without_motion(camera.calibration());
    for (place, point) in added.iter_mut().zip(points(&camera)) {
        let [dx_mm, dy_mm] =
            difference(frame.correction.distortion(point), still.distortion(point));
        *place = Added {
            x_mm: point.x_mm,
            y_mm: point.y_mm,
            dx_mm,
            dy_mm,
        };
    }
    Ok(())
}
