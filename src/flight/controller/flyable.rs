//! The part of a camera's limits that its mechanism can fly.

use super::Controller;
use super::setup::{exposure, needed_s};
use crate::flight::camera::{Camera, CameraParameters};
use crate::flight::settings::FlightSettings;

/// Number of steps between the smallest and the largest V/H of the limits.
const STEPS: u16 = 256;

impl Controller {
    /// Returns the same camera with the largest V/H that its mechanism can fly with these settings,
    /// if it can fly less than the limits say.
    ///
    /// [`PreparedCamera::new`](crate::flight::prepared_camera::PreparedCamera::new) refuses a
    /// camera whose mechanism cannot fly the largest V/H of its limits. Limits that were
    /// chosen should be refused; those of a camera that states none
    /// ([`Limits::DEFAULT`](crate::flight::exposure::Limits::DEFAULT)) are made to fit here, once,
    /// before the camera is given to the controller.
    ///
    /// # Model
    /// The V/H of 257 that are evenly spread over the limits, the largest first, at which the
    /// settings' exposure fits stroke and speed of the stage, and the stage is back before the next
    /// trigger; for a TDI sensor, at which the rows can be counted. A camera that cannot fly any of
    /// them, or is not valid, is returned unchanged.
    #[must_use]
    pub fn flyable(parameters: &CameraParameters, settings: &FlightSettings) -> CameraParameters {
        let Ok(camera) = Camera::new(*parameters) else {
            return *parameters;
        };
        let [least, most] = parameters.limits.vh_per_s;
        let flown = (0..=STEPS)
            .rev()
            .map(|step| f32::from(step) / f32::from(STEPS))
            // In this form the first number is exactly `most` and the last `least`.
            .map(|share| least * (1.0 - share) + most * share)
            .find(|vh_per_s| flies(&camera, settings, *vh_per_s));
        let mut parameters = *parameters;
        parameters.limits.vh_per_s = [least, flown.unwrap_or(most)];
        parameters
    }
}

/// Returns `true` if the mechanism can take the settings' exposure at a V/H, 1/s, again and again.
fn flies(camera: &Camera, settings: &FlightSettings, vh_per_s: f32) -> bool {
    if !camera.has_stage() {
        let exposure = exposure(settings, vh_per_s, settings.exposure_s);
        return camera.motion(&exposure).is_ok();
    }
    let available_s = settings.trigger_interval_s;
    needed_s(camera, settings, vh_per_s, settings.exposure_s)
        .is_ok_and(|needed_s| available_s == 0.0 || needed_s <= available_s)
}
