//! The camera in flight.

use fmc_camera::flight::{
    camera::{Camera, CameraRecord},
    exposure::{Exposure, Limits},
    stage::Stage,
};

/// Keeps the public functions of `fmc_camera::flight`.
pub(crate) fn keep() {
    keep![
        CameraRecord::new,
        Camera::new,
        Camera::calibration,
        Camera::shutter,
        Camera::plan,
        Camera::motion,
        Camera::frame,
        Camera::frame_of,
        Exposure::new,
        Limits::checked,
        Limits::check,
        Stage::new,
        Stage::plan,
        Stage::opening_at,
    ];
}
