//! Settings of the camera for the aircraft, the shutter and the stage.

use fmc_camera::flight::drive::loop_settings::{LoopSettings, Plant};
use fmc_camera::flight::drive::position_command_settings::PositionCommandSettings;
use fmc_camera::flight::drive::settings::{DriveSettings, EncoderSide};
use fmc_camera::flight::drive::step_settings::StepSettings;
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::vh::{ChannelSettings, VhSettings};
use fmc_camera_file::number::single;

use super::file::{AutopilotFormat, DirectionName, MissionFile, ReceiverFormat, VhSourceName};
use super::wire_load::{Transport, receiver_table};
use crate::mechanics::{self, MechanicsSettings};

/// Factor of a source's period after which the source counts as silent.
const PERIODS: f64 = 1.5;

/// Returns the settings of a scenario's camera: everything that its engineer knows of the simulated
/// hardware, its play and the size of the encoder's errors included, and nothing that only the
/// simulation knows (their signs, phase, noise).
#[must_use]
pub fn flight_settings(written: &MissionFile, interval_s: f64) -> FlightSettings {
    let mut settings = FlightSettings {
        exposure_s: single(written.flight.exposure_s),
        direction: written
            .flight
            .direction
            .map_or(FlightDirection::Forward, DirectionName::direction),
        smear_budget_px: single(written.limits.smear_px),
        shutter_latency_s: single(written.shutter.latency_ms / 1000.0),
        trigger_interval_s: single(interval_s),
        drive: DriveSettings {
            encoder_step_um: single(written.mechanics.encoder_step_um),
            encoder_side: match written.mechanics.encoder_side {
                mechanics::EncoderSide::Screw => EncoderSide::Screw,
                mechanics::EncoderSide::Stage => EncoderSide::Stage,
            },
            play_um: single(written.mechanics.backlash_um),
            encoder_scale_ppm: single(written.mechanics.encoder_scale_ppm.abs()),
            zero_sigma_um: 0.0,
            reading_age_sigma_s: single(
                written
                    .mechanics
                    .encoder_latency_error_s
                    .hypot(written.mechanics.encoder_jitter_s),
            ),
            velocity_loop: velocity_loop(&written.mechanics),
            index_mm: written
                .mechanics
                .has_index
                .then(|| single(written.mechanics.index_mm)),
            index_sigma_um: single(written.mechanics.index_noise_um),
            kind: written.mechanics.drive_kind(),
            position_command: position_command(&written.mechanics),
            stepper: stepper(&written.mechanics),
            ..DriveSettings::default()
        },
        ..FlightSettings::default()
    };
    settings.vh = vh_settings(written);
    let attitude = &written.attitude;
    let largest = |parts: [f64; 3]| single(parts.map(f64::abs).into_iter().fold(0.0, f64::max));
    settings.attitude_sigma_deg =
        largest([attitude.pitch_deg, attitude.roll_deg, attitude.drift_deg]);
    settings.rate_sigma_deg_s = largest(attitude.rate_rms_deg_s);
    settings
}

/// Returns the gains for the stage of the scenario.
fn velocity_loop(mechanics: &MechanicsSettings) -> LoopSettings {
    LoopSettings {
        reading_age_s: single(mechanics.encoder_latency_s),
        duty_delay_s: single(mechanics.duty_latency_s),
        ..LoopSettings::tuned(Plant {
            mass_kg: single(mechanics.mass_kg),
            force_n: single(mechanics.force_n),
            damping_n_s_m: single(mechanics.back_emf_n_s_m + mechanics.viscous_n_s_m),
            friction_n: single(mechanics.coulomb_n),
        })
    }
}

/// Returns the steps of a stage with a stepper, which is off them by as much as the field pulls at
/// most.
fn stepper(mechanics: &MechanicsSettings) -> StepSettings {
    let Some(stepper) = &mechanics.stepper else {
        return StepSettings::default();
    };
    StepSettings {
        steps_per_mm: single(stepper.steps_per_mm),
        pulse_rate_hz: single(stepper.pulse_rate_hz),
        max_step_rate_hz: single(stepper.max_step_rate_hz),
        following_sigma_um: single(1e3 * mechanics.force_n / stepper.stiffness_n_mm),
        ..StepSettings::default()
    }
}

/// Returns what an engineer knows of a stage that follows a position command: not by how much its
/// travel is wrong, nor its hysteresis and creep. Its sensor reads 10 % beyond the end stops.
fn position_command(mechanics: &MechanicsSettings) -> PositionCommandSettings {
    let Some(stage) = &mechanics.position_stage else {
        return PositionCommandSettings::default();
    };
    let [least, most] = mechanics
        .end_stops_mm
        .map(|stop_mm| single(1100.0 * stop_mm / mechanics.encoder_step_um));
    PositionCommandSettings {
        command_travel_um: single(stage.travel_um),
        lag_s: single(stage.lag_s()),
        acceleration_lag_s2: single(stage.acceleration_lag_s2()),
        sensor_least_counts: least,
        sensor_most_counts: most,
        sensor_noise_um: single(stage.sensor_noise_um),
        sensor_frozen_s: if stage.sensor_noise_um < mechanics.encoder_step_um {
            0.0
        } else {
            PositionCommandSettings::default().sensor_frozen_s
        },
        max_correction_um: single(0.2 * stage.travel_um),
        ..PositionCommandSettings::default()
    }
}

/// Returns σ, rate and latency of each source as they are.
fn vh_settings(written: &MissionFile) -> VhSettings {
    let mut settings = VhSettings::DEFAULT;
    let height_m = written.flight.height_m - written.terrain.height_m;
    let speed_m_s = written.flight.speed_m_s;
    let mut is_receiver_told = false;
    let transport = Transport::of(written);
    // The autopilot's speed is as noisy and as late as that of the receiver.
    let of_receiver = receiver_table(written);
    let reported_hz = written.attitude.reported_hz;
    if let Some(sensor) = of_receiver.or(written.vh.first())
        && written.line.autopilot == AutopilotFormat::Mavlink
        && reported_hz > 0.0
    {
        let channel = match (of_receiver, written.line.receiver) {
            (Some(_), ReceiverFormat::Nmea) => &mut settings.inertial_speed,
            _ => &mut settings.ground_speed,
        };
        let known = Known {
            sigma: sensor.sigma_percent / 100.0 / 2.0_f64.sqrt() * speed_m_s,
            latency_s: sensor.latency_ms / 1000.0 + transport.autopilot_speed,
            rate_hz: reported_hz,
        };
        known.tell(channel);
    }
    for sensor in &written.vh {
        let relative = sensor.sigma_percent / 100.0;
        let part = relative / 2.0_f64.sqrt();
        let told = |channel: &mut ChannelSettings, sigma: f64, transport_s: f64| {
            let known = Known {
                sigma,
                latency_s: sensor.latency_ms / 1000.0 + transport_s,
                rate_hz: sensor.rate_hz,
            };
            known.tell(channel);
        };
        // All sources share the one receiver of the aircraft, which reports with the first of them.
        if sensor.source.has_receiver() && !is_receiver_told {
            is_receiver_told = true;
            told(
                &mut settings.ground_speed,
                part * speed_m_s,
                transport.ground_speed,
            );
        }
        match sensor.source {
            VhSourceName::Direct => {
                told(&mut settings.direct, relative * speed_m_s / height_m, 0.0);
            }
            VhSourceName::Altimeter => told(
                &mut settings.height_above_ground,
                part * height_m,
                transport.height,
            ),
            VhSourceName::Laser => {
                told(&mut settings.inertial_speed, part * speed_m_s, 0.0);
                told(&mut settings.laser_height, part * height_m, 0.0);
            }
            VhSourceName::Terrain => {
                told(&mut settings.altitude, part * height_m, transport.altitude);
                // The elevation model is that of the simulated ground.
                told(&mut settings.terrain_height, 0.0, 0.0);
            }
        }
    }
    settings
}

/// Properties of a sensor that an engineer knows.
struct Known {
    /// σ of a value, in its unit.
    sigma: f64,
    /// Time from the measurement to the stamp of its arrival, s.
    latency_s: f64,
    rate_hz: f64,
}

impl Known {
    fn tell(&self, channel: &mut ChannelSettings) {
        channel.sigma = single(self.sigma.max(1e-6));
        channel.latency_s = single(self.latency_s);
        channel.period_s = single(PERIODS / self.rate_hz);
        channel.validity_s = channel.validity_s.max(channel.period_s);
    }
}
