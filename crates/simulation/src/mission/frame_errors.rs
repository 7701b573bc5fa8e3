//! Errors of one frame.

use fmc_camera::flight::frame_record::{ExposedFrame, Flag, FrameRecord, Outcome};
use fmc_camera_file::CameraFile;

use super::flown::FlownFrame;

/// Flags that do not affect the coordinates of a frame.
const HARMLESS: [Flag; 7] = [
    Flag::NoCompensation,
    Flag::LastGoodVh,
    Flag::OffCentre,
    Flag::SmearOverBudget,
    Flag::WithAttitude,
    Flag::EncoderGlitch,
    Flag::Unreferenced,
];

/// Errors of one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameErrors {
    /// Reported less true centroid principal point, along the FMC axis, px.
    pub pp_error_px: f64,
    /// σ of the principal point that the camera states, px.
    pub sigma_px: f64,
    /// Motion of a point's image on the detector, px.
    pub smear_px: f64,
    /// Part of the smear along the FMC axis that compensation leaves, px, signed.
    pub compensation_px: f64,
    /// Smear that the camera predicted, px.
    pub predicted_px: f64,
    /// `true` if the camera vouches for the coordinates: without a fault and without a flag that
    /// affects them.
    pub is_clean: bool,
}

impl FrameErrors {
    /// Computes the errors of a frame; `None` if no light passed or no exposure was recorded.
    #[must_use]
    pub fn of(camera: &CameraFile, frame: &FlownFrame) -> Option<Self> {
        let Outcome::Exposed(exposed) = &frame.record.outcome else {
            return None;
        };
        let truth = frame.truth.as_ref()?;
        let pixel_mm = camera.sensor.pixel_um / 1000.0;
        Some(Self {
            pp_error_px: (reported_offset_mm(camera, exposed) - truth.centroid_offset_mm)
                / pixel_mm,
            sigma_px: f64::from(exposed.principal_point_sigma.total_mm()) / pixel_mm,
            smear_px: truth.smear_mm / pixel_mm,
            compensation_px: truth.compensation_smear_mm / pixel_mm,
            predicted_px: f64::from(exposed.smear_px),
            is_clean: is_clean(&frame.record),
        })
    }
}

/// Returns the principal point as the block adjustment receives it, along the FMC axis from the
/// calibrated one, mm.
fn reported_offset_mm(camera: &CameraFile, exposed: &ExposedFrame) -> f64 {
    let [x0, y0] = camera.principal_point_mm;
    let [ex, ey] = camera.fmc.axis.unit();
    let point = exposed.interior.principal_point;
    (f64::from(point.x_mm) - x0) * ex + (f64::from(point.y_mm) - y0) * ey
}

fn is_clean(record: &FrameRecord) -> bool {
    record.faults.is_empty()
        && Flag::ALL
            .into_iter()
            // A finding of an instrument does not affect the coordinates either.
            .filter(|flag| !HARMLESS.contains(flag) && !flag.is_of_instrument())
            .all(|flag| !record.flags.contains(flag))
}
