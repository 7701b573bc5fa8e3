//! Smear that disturbances leave, for the error budget.

use fmc::flight::camera::Camera;
use fmc::geometry::image_motion::{
    Attitude, FlightState, GroundMotion, ImageMotion, ImageMotionError, View,
};

use crate::budget::Assumptions;

/// Largest smear over the sensor, mm, of each disturbance alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Smears {
    pub(crate) vh_error: f32,
    pub(crate) relief: f32,
    pub(crate) drift: f32,
    /// The larger one of roll and pitch.
    pub(crate) tilt_rate: f32,
    pub(crate) yaw_rate: f32,
}

impl Smears {
    /// Returns the smears of an exposure.
    ///
    /// # Errors
    /// [`ImageMotionError`] for an assumption outside its range.
    pub(crate) fn of(
        camera: &Camera,
        (vh_per_s, exposure_s): (f32, f32),
        assumed: &Assumptions,
    ) -> Result<Self, ImageMotionError> {
        let view = View::calibrated(camera.calibration());
        let undisturbed = FlightState {
            motion: GroundMotion {
                vh_per_s,
                ..GroundMotion::default()
            },
            attitude: Attitude::default(),
            compensated_vh_per_s: vh_per_s,
        };
        let of = |change: &dyn Fn(&mut FlightState)| {
            let mut state = undisturbed;
            change(&mut state);
            let motion = ImageMotion::new(&view, &state)?;
            let smear = motion.largest_smear(exposure_s).smear;
            Ok::<_, ImageMotionError>(smear.length_um() / 1000.0)
        };
        let rate = assumed.rate_deg_s;
        let pitch_rate = of(&|state| state.attitude.pitch_rate_deg_s = rate)?;
        let roll_rate = of(&|state| state.attitude.roll_rate_deg_s = rate)?;
        Ok(Self {
            vh_error: of(&|state| {
                state.compensated_vh_per_s *= 1.0 + assumed.vh_error_percent / 100.0;
            })?,
            relief: of(&|state| state.motion.relief_percent = assumed.relief_percent)?,
            drift: of(&|state| state.motion.drift_deg = assumed.drift_deg)?,
            tilt_rate: pitch_rate.max(roll_rate),
            yaw_rate: of(&|state| state.attitude.yaw_rate_deg_s = rate)?,
        })
    }
}
