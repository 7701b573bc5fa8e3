//! The camera in flight.

use fmc_camera::flight::{
    camera::{Camera, CameraRecord},
    exposure::{Exposure, FlightDirection, Limits},
    stage::{Profile, Stage, Travel},
};

/// Keeps the public functions of `fmc_camera::flight`.
pub(crate) fn keep() {
    keep![
        CameraRecord::new,
        Camera::new,
        Camera::calibration,
        Camera::shutter,
        Camera::stage,
        Camera::run_up,
        Camera::tracking,
        Camera::plan,
        Camera::motion,
        Camera::frame,
        Camera::frame_of,
        Exposure::new,
        FlightDirection::sign,
        Limits::checked,
        Limits::check,
        Stage::new,
        Stage::plan,
        Stage::opening_at,
        Stage::travel,
        Stage::waiting_place_mm,
        Stage::reposition,
        Stage::stop,
        Stage::cycle_s,
        Stage::fits_interval,
        Travel::setpoint,
        Profile::setpoint,
        Profile::duration_s,
        Profile::start,
        Profile::end,
        Profile::segments,
        Profile::reach_mm,
    ];
}
