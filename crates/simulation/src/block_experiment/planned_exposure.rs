//! Exposure of the block as the camera's own code plans it.

use fmc_camera::Camera;
use fmc_camera::flight::camera::FrameError;
use fmc_camera::flight::exposure::Exposure;
use fmc_camera_file::number::single;

/// Exposure as the camera plans it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PlannedExposure {
    /// c̄, mm.
    pub(super) offset_mm: f64,
    /// κ: enlargement by run-out and focus shift.
    pub(super) enlargement: f64,
    /// Centroid after the trigger, s.
    pub(super) centroid_after_trigger_s: f64,
}

/// Plans an exposure by the camera's own code.
///
/// # Errors
/// [`FrameError`] for an exposure that the camera refuses.
pub(super) fn planned(
    camera: &Camera,
    vh_per_s: f64,
    exposure_s: f64,
    focus_shift_um: f64,
) -> Result<PlannedExposure, FrameError> {
    let exposure = Exposure {
        focus_shift_um: single(focus_shift_um),
        ..Exposure::new(single(vh_per_s), single(exposure_s))
    };
    let interior = camera.frame(&exposure)?.interior;
    let start_mm = camera.plan(&exposure)?.start_mm;
    let travel = camera.travel(start_mm, &exposure, 0.0)?;
    Ok(PlannedExposure {
        offset_mm: f64::from(interior.motion.centroid_mm),
        enlargement: f64::from(interior.enlargement),
        centroid_after_trigger_s: f64::from(travel.opening_s + interior.motion.centroid_time_s),
    })
}
