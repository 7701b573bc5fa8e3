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

#[test]
fn channels_and_kinds_have_names_and_each_kind_its_count() {
    let names = VhChannel::ALL.map(VhChannel::name);
    let expected = [
        "V/H",
        "ground speed",
        "inertial speed",
        "height above ground",
        "laser height",
        "altitude",
        "terrain height",
    ];
    assert_eq!(names, expected);
    let kinds = [
        (VhFindingKind::NotANumber, "not a number"),
        (VhFindingKind::OutOfRange, "out of range"),
        (VhFindingKind::WrongSign, "wrong sign"),
        (VhFindingKind::WrongUnit(WrongUnit::Feet), "feet for metres"),
        (
            VhFindingKind::WrongUnit(WrongUnit::Knots),
            "knots for metres per second",
        ),
        (VhFindingKind::Jump, "jump"),
        (VhFindingKind::Frozen, "frozen"),
        (VhFindingKind::FromThePast, "from the past"),
        (VhFindingKind::Disagreement, "disagreement"),
        (VhFindingKind::Recovered, "recovered"),
    ];
    let mut counters = VhCounters::default();
    for (times, (kind, name)) in (1..).zip(kinds) {
        assert_eq!(kind.name(), name);
        let before = counters.of(kind);
        for _ in 0..times {
            counters.count(kind);
        }
        assert_eq!(counters.of(kind), before + times, "{name}");
    }
    // Both units have one count.
    let units = VhFindingKind::WrongUnit(WrongUnit::Feet);
    assert_eq!((counters.wrong_unit, counters.of(units)), (4 + 5, 9));
}

#[test]
fn monitor_shows_its_settings_and_values_are_those_of_their_channels() {
    let mut settings = VhSettings::DEFAULT;
    settings.direct.latency_s = 0.123;
    assert_eq!(VhMonitor::new(settings).settings(), &settings);
    let values = values::Values {
        direct: Some(0.0),
        ground_speed: Some(1.0),
        inertial_speed: Some(2.0),
        radar: Some(3.0),
        laser: Some(4.0),
        altitude: Some(5.0),
        terrain: None,
    };
    let of = VhChannel::ALL.map(|channel| values.of(channel));
    let numbers = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(Some);
    assert_eq!((&of[..6], of[6]), (&numbers[..], None));
}
