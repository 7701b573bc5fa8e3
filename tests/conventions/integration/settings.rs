//! The settings of a flight: defaults and ranges.

use fmc_camera::flight::drive::loop_settings::LoopSettings;
use fmc_camera::flight::drive::position_command_settings::PositionCommandSettings;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::drive::step_settings::StepSettings;
use fmc_camera::flight::input_settings::InputSettings;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::vh::{ChannelSettings, VhSettings};

use super::{DOCUMENT, rows};
use crate::conventions::document::names;

type Field = fn(&mut FlightSettings) -> &mut f32;

/// Returns the fields under their paths; does not compile for a field that does not exist.
macro_rules! settings {
    ($($($field:ident).+),+ $(,)?) => {
        [$((
            concat!($(".", stringify!($field)),+),
            (|settings| &mut settings.$($field).+) as Field,
        )),+]
    };
}

const SETTINGS: [(&str, Field); 53] = settings![
    exposure_s,
    smear_budget_px,
    speed_tolerance_percent,
    following_tolerance_um,
    jump_tolerance_um,
    shutter_latency_s,
    shutter_tolerance_s,
    trigger_interval_s,
    time_pulse_sigma_s,
    attitude_sigma_deg,
    rate_sigma_deg_s,
    vh.disagreement_percent,
    drive.encoder_step_um,
    drive.play_um,
    drive.encoder_scale_ppm,
    drive.zero_sigma_um,
    drive.reading_age_sigma_s,
    drive.index_sigma_um,
    drive.velocity_loop.position_gain_per_s,
    drive.velocity_loop.speed_gain_per_mm_s,
    drive.velocity_loop.integral_rate_per_s,
    drive.velocity_loop.slope_weight,
    drive.velocity_loop.speed_feed_per_mm_s,
    drive.velocity_loop.acceleration_feed_per_mm_s2,
    drive.velocity_loop.friction_feed,
    drive.velocity_loop.max_duty,
    drive.velocity_loop.rest_band_um,
    drive.velocity_loop.learning_rate_per_s,
    drive.velocity_loop.reading_age_s,
    drive.velocity_loop.duty_delay_s,
    drive.position_command.command_travel_um,
    drive.position_command.command_zero,
    drive.position_command.max_command,
    drive.position_command.lag_s,
    drive.position_command.acceleration_lag_s2,
    drive.position_command.correction_rate_per_s,
    drive.position_command.max_correction_um,
    drive.position_command.sensor_zero_counts,
    drive.position_command.sensor_least_counts,
    drive.position_command.sensor_most_counts,
    drive.position_command.sensor_noise_um,
    drive.position_command.sensor_frozen_s,
    drive.stepper.steps_per_mm,
    drive.stepper.pulse_rate_hz,
    drive.stepper.max_step_rate_hz,
    drive.stepper.homing_offset_mm,
    drive.stepper.homing_speed_mm_s,
    drive.stepper.homing_travel_mm,
    drive.stepper.following_sigma_um,
    inputs.shortest_pulse_ns,
    inputs.shortest_track_ns,
    inputs.receiver_baud,
    inputs.autopilot_baud,
];

/// Returns true if the settings are accepted with this value of one of them.
fn is_believed(field: Field, value: f32) -> bool {
    let mut settings = FlightSettings::default();
    *field(&mut settings) = value;
    settings.checked().is_ok()
}

#[test]
fn defaults_and_ranges_are_those_of_the_code() {
    let documented = rows("setting");
    assert_eq!(documented.len(), SETTINGS.len());
    for (row, (name, field)) in documented.iter().zip(SETTINGS) {
        assert_eq!(Some(names(row[0])[0]), name.strip_prefix('.'));
        let [shown, least, most] =
            [row[1], row[2], row[3]].map(|cell| cell.parse::<f32>().unwrap());
        let default = *field(&mut FlightSettings::default());
        // The document has six digits.
        let apart = (shown - default).abs();
        assert!(apart <= 2e-6 * default.abs(), "{name} = {default}");
        for end in [least, most] {
            assert!(is_believed(field, end), "{name} = {end}");
        }
        for outside in [least.next_down(), most.next_up()] {
            assert!(!is_believed(field, outside), "{name} = {outside}");
        }
    }
}

/// Does not compile with an additional field, which belongs in the document, too.
const fn fields_of_other_drives(settings: &DriveSettings) {
    let PositionCommandSettings {
        command_travel_um: _,
        command_zero: _,
        max_command: _,
        lag_s: _,
        acceleration_lag_s2: _,
        correction_rate_per_s: _,
        max_correction_um: _,
        sensor_zero_counts: _,
        sensor_least_counts: _,
        sensor_most_counts: _,
        sensor_noise_um: _,
        sensor_frozen_s: _,
    } = &settings.position_command;
    let StepSettings {
        steps_per_mm: _,
        reversed: _,
        pulse_rate_hz: _,
        max_step_rate_hz: _,
        setup_pulses: _,
        limit_closed_low: _,
        homing_offset_mm: _,
        homing_speed_mm_s: _,
        homing_travel_mm: _,
        following_sigma_um: _,
    } = &settings.stepper;
}

/// As above.
#[test]
fn settings_without_a_range_are_named() {
    let FlightSettings {
        exposure_s: _,
        direction: _,
        smear_budget_px: _,
        speed_tolerance_percent: _,
        following_tolerance_um: _,
        jump_tolerance_um: _,
        shutter_latency_s: _,
        shutter_tolerance_s: _,
        trigger_interval_s: _,
        time_pulse_sigma_s: _,
        encoder_survives_brown_out: _,
        attitude_sigma_deg: _,
        rate_sigma_deg_s: _,
        vh: _,
        drive:
            DriveSettings {
                encoder_step_um: _,
                encoder_reversed: _,
                encoder_side: _,
                play_um: _,
                encoder_scale_ppm: _,
                zero_sigma_um: _,
                reading_age_sigma_s: _,
                motor_reversed: _,
                velocity_loop:
                    LoopSettings {
                        position_gain_per_s: _,
                        speed_gain_per_mm_s: _,
                        integral_rate_per_s: _,
                        slope_weight: _,
                        speed_feed_per_mm_s: _,
                        acceleration_feed_per_mm_s2: _,
                        friction_feed: _,
                        max_duty: _,
                        rest_band_um: _,
                        learning_rate_per_s: _,
                        reading_age_s: _,
                        duty_delay_s: _,
                    },
                index_mm: _,
                index_sigma_um: _,
                kind: _,
                position_command: _,
                stepper: _,
            },
        inputs:
            InputSettings {
                shortest_pulse_ns: _,
                shortest_track_ns: _,
                trigger: _,
                time_pulse: _,
                shutter_opened: _,
                shutter_closed: _,
                index: _,
                limit_switch: _,
                brake: _,
                receiver_baud: _,
                autopilot_baud: _,
            },
        flies_on_after_reset: _,
        fitted_model: _,
    } = FlightSettings::default();
    fields_of_other_drives(&DriveSettings::default());
    for name in [
        "`direction`",
        "`encoder_survives_brown_out`",
        "`flies_on_after_reset`",
        "`fitted_model`",
        "`drive.encoder_reversed`",
        "`drive.encoder_side`",
        "`drive.motor_reversed`",
        "`drive.index_mm`",
        "`drive.kind`",
        "`drive.stepper.reversed`",
        "`drive.stepper.setup_pulses`",
        "`drive.stepper.limit_closed_low`",
        "`inputs.trigger`",
        "`inputs.time_pulse`",
        "`inputs.shutter_opened`",
        "`inputs.shutter_closed`",
        "`inputs.index`",
        "`inputs.limit_switch`",
        "`inputs.brake`",
    ] {
        assert!(DOCUMENT.contains(name), "{name}");
    }
}

#[test]
fn sources_are_believed_as_documented() {
    let VhSettings {
        direct,
        ground_speed,
        inertial_speed,
        height_above_ground,
        laser_height,
        altitude,
        terrain_height,
        disagreement_percent: _,
    } = VhSettings::DEFAULT;
    let row = |name: &str, source: ChannelSettings| {
        let [least, most] = source.range;
        [
            name.to_owned(),
            format!("{least} to {most}"),
            source.period_s.to_string(),
            source.validity_s.to_string(),
            source.slew_per_s.to_string(),
            source.sigma.to_string(),
            source.latency_s.to_string(),
            source.change_per_sqrt_s.to_string(),
            source.frozen_s.to_string(),
        ]
    };
    let expected = [
        row("direct", direct),
        row("ground_speed", ground_speed),
        row("inertial_speed", inertial_speed),
        row("height_above_ground", height_above_ground),
        row("laser_height", laser_height),
        row("altitude", altitude),
        row("terrain_height", terrain_height),
    ];
    let documented: Vec<_> = rows("source of V/H")
        .into_iter()
        .map(|row| {
            [
                names(row[0])[0],
                row[2],
                row[3],
                row[4],
                row[5],
                row[6],
                row[7],
                row[8],
                row[9],
            ]
        })
        .collect();
    assert_eq!(documented, expected);
}
