//! Tests with bad inputs by name: each is found, or bounded to a stated error.

mod contradictions;
mod estimate;
mod properties;
mod wrong_samples;

use std::vec;
use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::flight::time::Time;

/// 60 m/s at 1000 m, over terrain at 200 m.
const VH: f32 = 0.06;
const GOOD: [VhSample; 4] = [
    VhSample::GroundSpeed(60.0),
    VhSample::HeightAboveGround(1000.0),
    VhSample::Altitude(1200.0),
    VhSample::TerrainHeight(200.0),
];

fn at(seconds: f32) -> Time {
    Time::START.plus_s(seconds)
}

/// Returns a sample with a receiver's noise, so that no value is frozen.
fn noisy(sample: VhSample, step: u16) -> VhSample {
    let noise = 0.01 * f32::from(step % 7);
    match sample {
        VhSample::GroundSpeed(value) => VhSample::GroundSpeed(value + noise),
        VhSample::HeightAboveGround(value) => VhSample::HeightAboveGround(value + noise),
        VhSample::Altitude(value) => VhSample::Altitude(value + noise),
        VhSample::InertialSpeed(value) => VhSample::InertialSpeed(value + noise),
        other => other,
    }
}

/// Returns a monitor that has had good samples of these sources every 0.2 s for 4 s; the last at
/// 4 s.
fn flying(sources: &[VhSample]) -> VhMonitor {
    flying_with(VhSettings::DEFAULT, sources)
}

/// Returns default settings of instruments without latency, in still air over level ground.
fn calm() -> VhSettings {
    let mut settings = VhSettings::DEFAULT;
    for source in [
        &mut settings.direct,
        &mut settings.ground_speed,
        &mut settings.inertial_speed,
        &mut settings.height_above_ground,
        &mut settings.laser_height,
        &mut settings.altitude,
        &mut settings.terrain_height,
    ] {
        source.latency_s = 0.0;
        source.change_per_sqrt_s = 1e-6;
    }
    settings
}

/// Returns a monitor as [`flying`] does, with these settings.
fn flying_with(settings: VhSettings, sources: &[VhSample]) -> VhMonitor {
    let mut monitor = VhMonitor::new(settings.checked().unwrap());
    for step in 0..=20_u16 {
        for sample in sources {
            let found = monitor.observe(at(0.2 * f32::from(step)), noisy(*sample, step));
            assert_eq!(found, None);
        }
    }
    monitor
}

fn kind(finding: Option<VhFinding>) -> Option<VhFindingKind> {
    finding.map(|finding| finding.kind)
}

/// Returns the relative error of V/H, if there is one.
fn error(monitor: &VhMonitor, seconds: f32) -> Option<f32> {
    let estimate = monitor.estimate(at(seconds))?;
    Some((estimate.vh_per_s - VH).abs() / VH)
}
