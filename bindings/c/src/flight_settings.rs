//! Settings of a flight, as C fills them.

use fmc::flight::drive::kind::DriveKind;
use fmc::flight::drive::loop_settings::LoopSettings;
use fmc::flight::drive::position_command_settings::PositionCommandSettings;
use fmc::flight::drive::settings::{DriveSettings, EncoderSide};
use fmc::flight::drive::step_settings::StepSettings;
use fmc::flight::input_settings::InputSettings;
use fmc::flight::settings::FlightSettings;
use fmc::flight::vh::{ChannelSettings, VhSettings};

use crate::code::{self, codes, fmc_code};
use crate::error::{fmc_error, fmc_status};
use crate::memory;
use crate::refusal::Refusal;
use crate::version::{Input, checked};
use crate::{FMC_CAMERA_VERSION, FMC_NO};

/// The encoder is on the screw: it does not see the play.
pub const FMC_ENCODER_ON_SCREW: fmc_code = 0;
/// The encoder is on the stage.
pub const FMC_ENCODER_ON_STAGE: fmc_code = 1;

codes!(encoder_side, code_of_encoder_side, EncoderSide:
    FMC_ENCODER_ON_SCREW = EncoderSide::Screw,
    FMC_ENCODER_ON_STAGE = EncoderSide::Stage,
);

/// A motor with an encoder that counts.
pub const FMC_DRIVE_MOTOR: fmc_code = 0;
/// A sensor shows the place of the stage at any time, as an LVDT does: no place is lost, and play,
/// index mark and friction do not count.
pub const FMC_DRIVE_ABSOLUTE: fmc_code = 1;
/// A stepper, which nothing measures.
pub const FMC_DRIVE_STEPPER: fmc_code = 2;

codes!(drive_kind, code_of_drive_kind, DriveKind:
    FMC_DRIVE_MOTOR = DriveKind::Motor,
    FMC_DRIVE_ABSOLUTE = DriveKind::PositionCommand,
    FMC_DRIVE_STEPPER = DriveKind::Stepper,
);

/// Settings of one source of V/H; the unit is that of its sample.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_vh_source_settings {
    /// Smallest and largest believable value.
    pub range: [f32; 2],
    /// Longest time between two samples of a healthy source, s.
    pub period_s: f32,
    /// Age up to which a sample is used, s.
    pub validity_s: f32,
    /// Largest believable rate of change, per s.
    pub slew_per_s: f32,
    /// σ of a sample.
    pub sigma: f32,
    /// Age of a sample when it arrives, s.
    pub latency_s: f32,
    /// Change of the quantity in a second, as a random walk.
    pub change_per_sqrt_s: f32,
    /// Time after which an unchanged value is frozen, s; 0: never.
    pub frozen_s: f32,
}

/// Settings of motor, encoder and velocity loop.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_drive_settings {
    /// Step of the encoder, µm.
    pub encoder_step_um: f32,
    /// `FMC_YES` if the encoder counts against the FMC axis.
    pub encoder_reversed: fmc_code,
    /// `FMC_ENCODER_...`
    pub encoder_side: fmc_code,
    /// Play between screw and stage, µm.
    pub play_um: f32,
    /// Error of the encoder's scale, ppm.
    pub encoder_scale_ppm: f32,
    /// σ of the calibrated position in the encoder's count, µm.
    pub zero_sigma_um: f32,
    /// σ of the age of a reading, s.
    pub reading_age_sigma_s: f32,
    /// `FMC_YES` if the motor turns against the FMC axis.
    pub motor_reversed: fmc_code,
    /// Gain of the velocity loop from position to speed, 1/s.
    pub position_gain_per_s: f32,
    /// Gain from speed to duty, per mm/s.
    pub speed_gain_per_mm_s: f32,
    /// Rate of the integral, 1/s.
    pub integral_rate_per_s: f32,
    /// Weight of a new slope.
    pub slope_weight: f32,
    /// Feed-forward of the speed, per mm/s.
    pub speed_feed_per_mm_s: f32,
    /// Feed-forward of the acceleration, per mm/s².
    pub acceleration_feed_per_mm_s2: f32,
    /// Feed-forward of the friction.
    pub friction_feed: f32,
    /// Largest duty.
    pub max_duty: f32,
    /// Band in which the stage rests, µm.
    pub rest_band_um: f32,
    /// Rate of learning, 1/s.
    pub learning_rate_per_s: f32,
    /// Age of a reading when the loop runs, s.
    pub reading_age_s: f32,
    /// Time until a duty acts, s.
    pub duty_delay_s: f32,
    /// `FMC_YES` with an index mark.
    pub has_index: fmc_code,
    /// Place of the index mark, mm along the FMC axis.
    pub index_mm: f32,
    /// σ of a crossing, µm.
    pub index_sigma_um: f32,
    /// `FMC_DRIVE_...`
    pub kind: fmc_code,
    /// σ of one reading of an absolute sensor, µm.
    pub sensor_noise_um: f32,
    /// σ by which a stage is off the steps of its stepper, µm.
    pub following_sigma_um: f32,
}

/// Settings of a flight, as `fmc_flight_settings_defaults` begins them. Their ranges stand in
/// `docs/integration.md`.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct fmc_flight_settings {
    /// Size of this structure, bytes.
    pub size: u32,
    /// `FMC_CAMERA_VERSION` of the header.
    pub version: u32,
    /// Exposure time of the frames to come, s.
    pub exposure_s: f32,
    /// `FMC_FORWARD` or `FMC_REVERSE`.
    pub direction: fmc_code,
    /// Largest smear of a frame that is not flagged, pixels.
    pub smear_budget_px: f32,
    /// Largest error of the stage's speed at which the shutter is told to open, per cent.
    pub speed_tolerance_percent: f32,
    /// Largest following error that is not a fault, µm.
    pub following_tolerance_um: f32,
    /// Largest step of a reading beyond its set point's, µm.
    pub jump_tolerance_um: f32,
    /// Time from command to first light, s.
    pub shutter_latency_s: f32,
    /// Largest error of first light and of exposure in time, s.
    pub shutter_tolerance_s: f32,
    /// Shortest planned time between triggers, s; 0 if not known.
    pub trigger_interval_s: f32,
    /// σ of the satellite receiver's time pulse, s.
    pub time_pulse_sigma_s: f32,
    /// `FMC_YES` if the encoder counts on while the supply is too low for the motor.
    pub encoder_survives_brown_out: fmc_code,
    /// σ of pitch, roll and drift while no attitude is reported, degrees.
    pub attitude_sigma_deg: f32,
    /// σ of each attitude rate while no attitude is reported, degrees/s.
    pub rate_sigma_deg_s: f32,
    /// Source of V/H.
    pub direct: fmc_vh_source_settings,
    /// Source of the ground speed.
    pub ground_speed: fmc_vh_source_settings,
    /// Source of the inertial speed.
    pub inertial_speed: fmc_vh_source_settings,
    /// Source of the height above ground.
    pub height_above_ground: fmc_vh_source_settings,
    /// Source of the laser's height.
    pub laser_height: fmc_vh_source_settings,
    /// Source of the altitude.
    pub altitude: fmc_vh_source_settings,
    /// Source of the terrain's height.
    pub terrain_height: fmc_vh_source_settings,
    /// Difference of V/H of two sources that is a disagreement, per cent.
    pub disagreement_percent: f32,
    /// Motor, encoder and velocity loop.
    pub drive: fmc_drive_settings,
    /// `FMC_YES` if the frames are corrected by the fitted model of the calibration.
    pub fitted_model: fmc_code,
}

impl Input for fmc_flight_settings {}

/// Fills settings with their defaults. `size` is that of the structure, `version` is
/// `FMC_CAMERA_VERSION`.
///
/// # Safety
/// Unless it is NULL or misaligned, `settings` is to `size` bytes of the caller.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmc_flight_settings_defaults(
    settings: *mut fmc_flight_settings,
    size: u32,
    version: u32,
    error: *mut fmc_error,
) -> fmc_status {
    let filled = || {
        checked([size, version], size_of::<fmc_flight_settings>(), 2)?;
        let place = memory::output(settings, 1)?;
        // SAFETY: the caller's promise.
        unsafe { place.write((&FlightSettings::default()).into()) };
        Ok(())
    };
    // SAFETY: the caller's promise.
    unsafe { memory::status(filled(), error) }
}

/// Defines the conversions between two structures with fields of the same names, and a few that
/// differ.
macro_rules! same_fields {
    ($c:ty, $rust:ty, [$($field:ident),+]) => {
        impl From<&$rust> for $c {
            fn from(from: &$rust) -> Self {
                Self { $($field: from.$field),+ }
            }
        }

        impl From<&$c> for $rust {
            fn from(from: &$c) -> Self {
                Self { $($field: from.$field),+ }
            }
        }
    };
}

same_fields!(
    fmc_vh_source_settings,
    ChannelSettings,
    [
        range,
        period_s,
        validity_s,
        slew_per_s,
        sigma,
        latency_s,
        change_per_sqrt_s,
        frozen_s
    ]
);

impl From<&DriveSettings> for fmc_drive_settings {
    fn from(drive: &DriveSettings) -> Self {
        let velocity_loop = &drive.velocity_loop;
        Self {
            encoder_step_um: drive.encoder_step_um,
            encoder_reversed: code::code_of_bool(drive.encoder_reversed),
            encoder_side: code_of_encoder_side(drive.encoder_side),
            play_um: drive.play_um,
            encoder_scale_ppm: drive.encoder_scale_ppm,
            zero_sigma_um: drive.zero_sigma_um,
            reading_age_sigma_s: drive.reading_age_sigma_s,
            motor_reversed: code::code_of_bool(drive.motor_reversed),
            position_gain_per_s: velocity_loop.position_gain_per_s,
            speed_gain_per_mm_s: velocity_loop.speed_gain_per_mm_s,
            integral_rate_per_s: velocity_loop.integral_rate_per_s,
            slope_weight: velocity_loop.slope_weight,
            speed_feed_per_mm_s: velocity_loop.speed_feed_per_mm_s,
            acceleration_feed_per_mm_s2: velocity_loop.acceleration_feed_per_mm_s2,
            friction_feed: velocity_loop.friction_feed,
            max_duty: velocity_loop.max_duty,
            rest_band_um: velocity_loop.rest_band_um,
            learning_rate_per_s: velocity_loop.learning_rate_per_s,
            reading_age_s: velocity_loop.reading_age_s,
            duty_delay_s: velocity_loop.duty_delay_s,
            has_index: drive.index_mm.map_or(FMC_NO, |_| crate::FMC_YES),
            index_mm: drive.index_mm.unwrap_or(0.0),
            index_sigma_um: drive.index_sigma_um,
            kind: code_of_drive_kind(drive.kind),
            sensor_noise_um: drive.position_command.sensor_noise_um,
            following_sigma_um: drive.stepper.following_sigma_um,
        }
    }
}

impl fmc_drive_settings {
    fn settings(&self) -> Result<DriveSettings, Refusal> {
        Ok(DriveSettings {
            encoder_step_um: self.encoder_step_um,
            encoder_reversed: code::bool_of(self.encoder_reversed)?,
            encoder_side: encoder_side(self.encoder_side)?,
            play_um: self.play_um,
            encoder_scale_ppm: self.encoder_scale_ppm,
            zero_sigma_um: self.zero_sigma_um,
            reading_age_sigma_s: self.reading_age_sigma_s,
            motor_reversed: code::bool_of(self.motor_reversed)?,
            velocity_loop: LoopSettings {
                position_gain_per_s: self.position_gain_per_s,
                speed_gain_per_mm_s: self.speed_gain_per_mm_s,
                integral_rate_per_s: self.integral_rate_per_s,
                slope_weight: self.slope_weight,
                speed_feed_per_mm_s: self.speed_feed_per_mm_s,
                acceleration_feed_per_mm_s2: self.acceleration_feed_per_mm_s2,
                friction_feed: self.friction_feed,
                max_duty: self.max_duty,
                rest_band_um: self.rest_band_um,
                learning_rate_per_s: self.learning_rate_per_s,
                reading_age_s: self.reading_age_s,
                duty_delay_s: self.duty_delay_s,
            },
            index_mm: code::bool_of(self.has_index)?.then_some(self.index_mm),
            index_sigma_um: self.index_sigma_um,
            kind: drive_kind(self.kind)?,
            // The caller of a library has a drive of its own.
            position_command: PositionCommandSettings {
                sensor_noise_um: self.sensor_noise_um,
                ..PositionCommandSettings::UNUSED
            },
            stepper: StepSettings {
                following_sigma_um: self.following_sigma_um,
                ..StepSettings::default()
            },
        })
    }
}

impl From<&FlightSettings> for fmc_flight_settings {
    #[expect(clippy::cast_possible_truncation, reason = "hundreds of bytes")]
    fn from(settings: &FlightSettings) -> Self {
        let vh = &settings.vh;
        Self {
            size: size_of::<Self>() as u32,
            version: FMC_CAMERA_VERSION,
            exposure_s: settings.exposure_s,
            direction: code::code_of_direction(settings.direction),
            smear_budget_px: settings.smear_budget_px,
            speed_tolerance_percent: settings.speed_tolerance_percent,
            following_tolerance_um: settings.following_tolerance_um,
            jump_tolerance_um: settings.jump_tolerance_um,
            shutter_latency_s: settings.shutter_latency_s,
            shutter_tolerance_s: settings.shutter_tolerance_s,
            trigger_interval_s: settings.trigger_interval_s,
            time_pulse_sigma_s: settings.time_pulse_sigma_s,
            encoder_survives_brown_out: code::code_of_bool(settings.encoder_survives_brown_out),
            attitude_sigma_deg: settings.attitude_sigma_deg,
            rate_sigma_deg_s: settings.rate_sigma_deg_s,
            direct: (&vh.direct).into(),
            ground_speed: (&vh.ground_speed).into(),
            inertial_speed: (&vh.inertial_speed).into(),
            height_above_ground: (&vh.height_above_ground).into(),
            laser_height: (&vh.laser_height).into(),
            altitude: (&vh.altitude).into(),
            terrain_height: (&vh.terrain_height).into(),
            disagreement_percent: vh.disagreement_percent,
            drive: (&settings.drive).into(),
            fitted_model: code::code_of_bool(settings.fitted_model),
        }
    }
}

impl fmc_flight_settings {
    /// Returns the settings, not yet validated.
    pub(crate) fn settings(&self) -> Result<FlightSettings, Refusal> {
        Ok(FlightSettings {
            // The caller of a library has lines of its own.
            inputs: InputSettings::default(),
            // It keeps no flight over a reset.
            flies_on_after_reset: FlightSettings::default().flies_on_after_reset,
            fitted_model: code::bool_of(self.fitted_model)?,
            exposure_s: self.exposure_s,
            direction: code::direction(self.direction)?,
            smear_budget_px: self.smear_budget_px,
            speed_tolerance_percent: self.speed_tolerance_percent,
            following_tolerance_um: self.following_tolerance_um,
            jump_tolerance_um: self.jump_tolerance_um,
            shutter_latency_s: self.shutter_latency_s,
            shutter_tolerance_s: self.shutter_tolerance_s,
            trigger_interval_s: self.trigger_interval_s,
            time_pulse_sigma_s: self.time_pulse_sigma_s,
            encoder_survives_brown_out: code::bool_of(self.encoder_survives_brown_out)?,
            attitude_sigma_deg: self.attitude_sigma_deg,
            rate_sigma_deg_s: self.rate_sigma_deg_s,
            vh: VhSettings {
                direct: (&self.direct).into(),
                ground_speed: (&self.ground_speed).into(),
                inertial_speed: (&self.inertial_speed).into(),
                height_above_ground: (&self.height_above_ground).into(),
                laser_height: (&self.laser_height).into(),
                altitude: (&self.altitude).into(),
                terrain_height: (&self.terrain_height).into(),
                disagreement_percent: self.disagreement_percent,
            },
            drive: self.drive.settings()?,
        })
    }
}
