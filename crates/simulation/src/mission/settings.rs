//! Settings of the camera for the aircraft, the shutter and the stage.

use fmc_camera::flight::drive::loop_settings::{LoopSettings, Plant};
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::exposure::FlightDirection;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::flight::vh::{ChannelSettings, VhSettings};
use fmc_camera_file::number::single;

use super::file::{DirectionName, MissionFile, VhSourceName};
use crate::mechanics::MechanicsSettings;

/// Factor of a source's period after which the source counts as silent.
const PERIODS: f64 = 1.5;

/// Returns the settings of a scenario's camera: everything that its engineer knows of the simulated
/// hardware, and nothing that only the simulation knows (jitter, play, noise).
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
            velocity_loop: velocity_loop(&written.mechanics),
            ..DriveSettings::default()
        },
        ..FlightSettings::default()
    };
    settings.vh = vh_settings(written);
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

/// Returns σ and rate of each source as they are.
fn vh_settings(written: &MissionFile) -> VhSettings {
    let mut settings = VhSettings::DEFAULT;
    let height_m = written.flight.height_m - written.terrain.height_m;
    let speed_m_s = written.flight.speed_m_s;
    for sensor in &written.vh {
        let relative = sensor.sigma_percent / 100.0;
        let part = relative / 2.0_f64.sqrt();
        let period_s = PERIODS / sensor.rate_hz + sensor.latency_ms / 1000.0;
        let told = |channel: &mut ChannelSettings, sigma: f64| {
            channel.sigma = channel.sigma.min(single(sigma.max(1e-6)));
            channel.period_s = single(period_s);
            channel.validity_s = channel.validity_s.max(channel.period_s);
        };
        match sensor.source {
            VhSourceName::Direct => told(&mut settings.direct, relative * speed_m_s / height_m),
            VhSourceName::Altimeter => {
                told(&mut settings.ground_speed, part * speed_m_s);
                told(&mut settings.height_above_ground, part * height_m);
            }
            VhSourceName::Laser => {
                told(&mut settings.inertial_speed, part * speed_m_s);
                told(&mut settings.laser_height, part * height_m);
            }
            VhSourceName::Terrain => {
                told(&mut settings.ground_speed, part * speed_m_s);
                told(&mut settings.altitude, part * height_m);
                told(&mut settings.terrain_height, part * height_m);
            }
        }
    }
    settings
}
