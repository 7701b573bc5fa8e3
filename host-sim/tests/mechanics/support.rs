//! The camera's control loop at 1 kHz, reduced to its drive, on the simulated stage.

use fmc_camera::flight::drive::FmcDrive;
use fmc_camera::flight::drive::rig::RigDrive;
use fmc_camera::flight::drive::settings::DriveSettings;
use fmc_camera::flight::time::Time;
use fmc_simulation::mechanics::{Injection, Mechanics, MechanicsSettings};

use crate::mechanics::profile::{Phase, Profile};

/// Period of the control loop, s.
pub(crate) const TICK_S: f64 = 1e-3;

/// Time from the run-up to the exposure, s.
pub(crate) const SETTLING_S: f64 = 5e-3;

/// Longest exposure over which smear is judged, s.
pub(crate) const EXPOSURE_S: f64 = 10e-3;

/// Errors of the stage, µm.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Followed {
    /// Largest true following error in cruise after settling.
    pub(crate) cruise_um: f64,
    /// Largest change of it within any window as long as the exposure, in cruise after settling.
    pub(crate) smear_um: f64,
    /// Largest true following error in run-ups and stops, and in cruise while settling.
    pub(crate) ramp_um: f64,
    /// Largest true following error in fly-back.
    pub(crate) fly_back_um: f64,
    /// Largest true following error at rest, 20 ms after the stop.
    pub(crate) rest_um: f64,
    /// Largest following error that the camera sees.
    pub(crate) seen_um: f64,
    /// Number of ticks with duty although the stage has been at rest for 200 ms.
    pub(crate) hunting: u32,
}

impl Followed {
    pub(crate) fn worst(self, other: Self) -> Self {
        Self {
            cruise_um: self.cruise_um.max(other.cruise_um),
            smear_um: self.smear_um.max(other.smear_um),
            ramp_um: self.ramp_um.max(other.ramp_um),
            fly_back_um: self.fly_back_um.max(other.fly_back_um),
            rest_um: self.rest_um.max(other.rest_um),
            seen_um: self.seen_um.max(other.seen_um),
            hunting: self.hunting.max(other.hunting),
        }
    }
}

/// Returns the library's drive, told the encoder and the latencies of a stage, but not its mass.
#[expect(clippy::cast_possible_truncation, reason = "the camera's precision")]
pub(crate) fn drive_for(settings: &MechanicsSettings) -> DriveSettings {
    let mut drive = DriveSettings {
        encoder_step_um: settings.encoder_step_um as f32,
        ..DriveSettings::default()
    };
    drive.velocity_loop.reading_age_s = settings.encoder_latency_s as f32;
    drive.velocity_loop.duty_delay_s = settings.duty_latency_s as f32;
    drive
}

/// A tick as the camera sees it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tick {
    pub(crate) time_s: f64,
    /// Set point at the time of the reading, less the reading, µm.
    pub(crate) error_um: f64,
}

/// Runs the control loop over a profile; `at_tick` receives each tick, the mechanics with their
/// history, and the duty.
pub(crate) fn run(
    settings: MechanicsSettings,
    drive: DriveSettings,
    profile: &Profile,
    faults: &[Injection],
    mut at_tick: impl FnMut(Tick, &Mechanics, f32),
) {
    let mut mechanics = Mechanics::new(settings).unwrap();
    for fault in faults {
        mechanics.inject(*fault);
    }
    let mut rig = RigDrive::new(drive).unwrap();
    let mut tick = 0_u32;
    while f64::from(tick) * TICK_S < profile.end_s() {
        let time_s = f64::from(tick) * TICK_S;
        let now = Time::from_us(u64::from(tick) * 1000);
        rig.set_count(mechanics.encoder_count());
        let reading = rig.position(now).unwrap();
        rig.follow(now, profile.at(time_s).setpoint()).unwrap();
        let age_s = f64::from(drive.velocity_loop.reading_age_s);
        let error_um =
            1e3 * (profile.at((time_s - age_s).max(0.0)).offset_mm - f64::from(reading.offset_mm));
        at_tick(Tick { time_s, error_um }, &mechanics, rig.duty());
        mechanics.advance(f64::from(rig.duty()), rig.powered(), TICK_S);
        tick += 1;
    }
}

/// Runs the control loop over a profile and measures the errors.
pub(crate) fn followed(
    settings: MechanicsSettings,
    drive: DriveSettings,
    profile: &Profile,
) -> Followed {
    let mut found = Followed::default();
    let mut settled: Vec<(f64, f64)> = Vec::new();
    run(settings, drive, profile, &[], |tick, mechanics, duty| {
        if tick.time_s < profile.measured_from_s() {
            return;
        }
        found.seen_um = found.seen_um.max(tick.error_um.abs());
        let wanted = profile.at(tick.time_s);
        if wanted.phase == Phase::Rest && wanted.since_s > 0.2 && duty != 0.0 {
            found.hunting += 1;
        }
        for instant in mechanics.history(tick.time_s - TICK_S) {
            let wanted = profile.at(instant.time_s);
            let error_um = 1e3 * (instant.stage_mm - wanted.offset_mm);
            let kind = match wanted.phase {
                Phase::Rest if wanted.since_s > 0.02 => &mut found.rest_um,
                Phase::Cruise if wanted.since_s >= SETTLING_S => {
                    settled.push((instant.time_s, error_um));
                    &mut found.cruise_um
                }
                Phase::Ramp | Phase::Cruise => &mut found.ramp_um,
                Phase::FlyBack | Phase::Rest => &mut found.fly_back_um,
            };
            *kind = kind.max(error_um.abs());
        }
    });
    found.smear_um = smear_um(&settled);
    found
}

/// Returns the largest change of the error within any window as long as the exposure.
fn smear_um(errors: &[(f64, f64)]) -> f64 {
    let mut worst: f64 = 0.0;
    for (first, (start_s, _)) in errors.iter().enumerate().step_by(10) {
        let window = errors[first..]
            .iter()
            .take_while(|(time_s, _)| *time_s <= start_s + EXPOSURE_S);
        let (least, most) = window.fold((f64::MAX, f64::MIN), |(least, most), (_, error_um)| {
            (least.min(*error_um), most.max(*error_um))
        });
        worst = worst.max(most - least);
    }
    worst
}
