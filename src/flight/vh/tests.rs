//! Each bad input by name: found, or bounded, and by how much.

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

/// What receivers add, so that nothing is frozen.
fn noisy(sample: VhSample, step: u16) -> VhSample {
    let noise = 0.01 * f32::from(step % 7);
    match sample {
        VhSample::GroundSpeed(value) => VhSample::GroundSpeed(value + noise),
        VhSample::HeightAboveGround(value) => VhSample::HeightAboveGround(value + noise),
        VhSample::Altitude(value) => VhSample::Altitude(value + noise),
        other => other,
    }
}

/// A monitor that has had good samples of these sources every 0.2 s for 4 s; the last at 4 s.
fn flying(sources: &[VhSample]) -> VhMonitor {
    let mut monitor = VhMonitor::new(VhSettings::DEFAULT.checked().unwrap());
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

/// The relative error of V/H where there is one.
fn error(monitor: &VhMonitor, seconds: f32) -> Option<f32> {
    let estimate = monitor.estimate(at(seconds))?;
    Some((estimate.vh_per_s - VH).abs() / VH)
}

#[test]
fn vh_is_speed_over_height_with_its_sigma() {
    let estimate = flying(&GOOD).estimate(at(4.0)).unwrap();
    assert_eq!(estimate.source, VhSource::Altimeter);
    assert!(!estimate.extrapolated && estimate.age_s < 1e-6);
    assert!((estimate.vh_per_s - VH).abs() < 1e-4);
    // 0.1 m/s of 60 m/s and 3 m of 1000 m: 1/600 and 3/1000 of 0.06.
    let expected = VH * libm::sqrtf(1.0 / (600.0 * 600.0) + 9e-6);
    assert!((estimate.sigma_per_s - expected).abs() < 0.001 * expected);
}

#[test]
fn ways_are_taken_in_order_as_they_are_lost() {
    let mut monitor = flying(&GOOD);
    assert_eq!(monitor.observe(at(4.0), VhSample::Direct(0.0602)), None);
    let source = |seconds| monitor.estimate(at(seconds)).map(|found| found.source);
    assert_eq!(source(4.1), Some(VhSource::Direct));
    // Direct and radar are valid for 5 s; the terrain's height for 60 s, speed and altitude for 10 s.
    assert_eq!(source(9.1), Some(VhSource::Terrain));
    assert_eq!(source(14.1), None);
    let direct_lost = flying(&GOOD);
    assert_eq!(
        direct_lost.estimate(at(8.9)).unwrap().source,
        VhSource::Altimeter
    );
}

#[test]
fn inertial_speed_and_laser_take_over_and_their_differences_are_in_sigma() {
    let mut monitor = flying(&GOOD[..2]);
    let alone = monitor.estimate(at(4.0)).unwrap();
    let found = monitor
        .observe(at(4.0), VhSample::InertialSpeed(66.0))
        .unwrap();
    assert_eq!(found.kind, VhFindingKind::Disagreement);
    let both = monitor.estimate(at(4.0)).unwrap();
    assert!((both.vh_per_s - alone.vh_per_s).abs() < 1e-9);
    // 6 m/s over 1000 m.
    assert!((0.0055..0.0065).contains(&both.sigma_per_s), "{both:?}");
    let found = monitor.observe(at(4.1), VhSample::InertialSpeed(60.5));
    assert_ne!(
        kind(found),
        Some(VhFindingKind::Recovered),
        "6 m/s in 0.1 s is a jump"
    );
    assert_eq!(
        monitor.observe(at(4.1), VhSample::LaserHeight(1001.0)),
        None
    );
    let estimate = monitor.estimate(at(4.1)).unwrap();
    assert!((estimate.vh_per_s - 60.05 / 1001.0).abs() < 1e-4);
    let mut inertial = VhMonitor::default();
    inertial.observe(at(0.0), VhSample::InertialSpeed(60.0));
    inertial.observe(at(0.0), VhSample::LaserHeight(1000.0));
    assert!(error(&inertial, 0.0).unwrap() < 1e-6);
}

#[test]
fn silence_extrapolates_with_growing_sigma_in_pixels_until_its_validity_ends() {
    let monitor = flying(&GOOD[..2]);
    // The lens: 150 mm, 8.75 µm, 1/200 s.
    let scale = SmearScale {
        principal_distance_mm: 150.0,
        exposure_s: 0.005,
        pixel_um: 8.75,
    };
    let smear = |age: f32| {
        let estimate = monitor.estimate(at(4.0 + age)).unwrap();
        assert_eq!(estimate.extrapolated, age >= 0.5);
        assert!((estimate.age_s - age).abs() < 1e-5);
        estimate.smear_px(&scale)
    };
    let grown = [0.0, 0.4, 1.0, 2.0, 4.0, 4.9].map(smear);
    assert!(grown.is_sorted(), "{grown:?}");
    assert!(grown[0] < 0.02);
    // After 1 s: 100 m/√3 of 1000 m and 5 m/s/√3 of 60 m/s, 7.5 % of 0.06 1/s over 85.7 px·s.
    assert!((grown[2] - 0.386).abs() < 0.01, "{grown:?}");
    assert!(monitor.estimate(at(9.01)).is_none());
}

#[test]
fn not_a_number_is_found_and_changes_nothing() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut monitor = flying(&GOOD);
        let before = monitor.estimate(at(4.2));
        for sample in [
            VhSample::Direct(value),
            VhSample::GroundSpeed(value),
            VhSample::HeightAboveGround(value),
            VhSample::Altitude(value),
            VhSample::TerrainHeight(value),
            VhSample::InertialSpeed(value),
            VhSample::LaserHeight(value),
        ] {
            let found = monitor.observe(at(4.1), sample);
            assert_eq!(kind(found), Some(VhFindingKind::NotANumber));
        }
        assert_eq!(monitor.estimate(at(4.2)), before);
        assert_eq!(monitor.counters().not_a_number, 7);
    }
}

#[test]
fn zero_and_negative_speed_and_height_never_give_vh() {
    let mut monitor = VhMonitor::default();
    for (speed, height) in [
        (0.0, 0.0),
        (-60.0, -1000.0),
        (-60.0, 1000.0),
        (60.0, -1000.0),
    ] {
        monitor.observe(at(0.0), VhSample::GroundSpeed(speed));
        monitor.observe(at(0.0), VhSample::HeightAboveGround(height));
        monitor.observe(at(0.0), VhSample::Direct(-0.06));
    }
    // One good speed and one good height came separately: their quotient is good.
    assert!(error(&monitor, 0.0).unwrap() < 1e-6);
    let mut below_ground = VhMonitor::default();
    for sample in [
        VhSample::GroundSpeed(60.0),
        VhSample::Altitude(200.0),
        VhSample::TerrainHeight(1200.0),
    ] {
        assert_eq!(below_ground.observe(at(0.0), sample), None);
    }
    assert_eq!(below_ground.estimate(at(0.0)), None);
}

#[test]
fn wrong_sign_is_named_and_not_used() {
    let mut monitor = flying(&GOOD);
    for sample in [
        VhSample::GroundSpeed(-60.0),
        VhSample::HeightAboveGround(-1000.0),
        VhSample::Altitude(-1200.0),
        VhSample::TerrainHeight(-200.0),
    ] {
        for step in 1..20_u8 {
            let found = monitor.observe(at(4.0 + 0.01 * f32::from(step)), sample);
            assert_eq!(kind(found), Some(VhFindingKind::WrongSign), "{sample:?}");
        }
    }
    assert!(error(&monitor, 4.2).unwrap() < 1e-3);
}

#[test]
fn frozen_value_is_found_after_its_time_and_is_bounded_by_slew_until_then() {
    let mut monitor = flying(&GOOD[..2]);
    let mut found_at = None;
    for step in 1..100_u16 {
        let now = 4.0 + 0.1 * f32::from(step);
        monitor.observe(at(now), noisy(GOOD[0], step));
        let found = monitor.observe(at(now), VhSample::HeightAboveGround(1000.07));
        if kind(found) == Some(VhFindingKind::Frozen) && found_at.is_none() {
            found_at = Some(now);
            // Its age counts from when it stopped changing: 5 s, and it is lost at once.
            assert!(monitor.estimate(at(now)).is_none());
        }
    }
    // At most 5 s at 100 m/s of slew: 500 m. σ says so from the moment it is found.
    assert!((found_at.unwrap() - 9.2).abs() < 0.11, "{found_at:?}");
    let found = monitor.observe(at(14.1), VhSample::HeightAboveGround(1001.0));
    assert_eq!(kind(found), Some(VhFindingKind::Recovered));
    assert!(error(&monitor, 14.1).unwrap() < 2e-3);
}

#[test]
fn terrain_height_and_direct_vh_may_stay_the_same() {
    let mut monitor = VhMonitor::default();
    for step in 0..100_u8 {
        for sample in [VhSample::Direct(0.06), VhSample::TerrainHeight(200.0)] {
            assert_eq!(monitor.observe(at(f32::from(step)), sample), None);
        }
    }
}

#[test]
fn jump_is_refused_and_accepted_when_it_stays() {
    let mut monitor = flying(&GOOD[..2]);
    let jump = |step: u8| VhSample::HeightAboveGround(500.0 + f32::from(step));
    for step in 1..CONSISTENT_SAMPLES {
        let found = monitor.observe(at(4.0 + 0.1 * f32::from(step)), jump(step));
        assert_eq!(kind(found), Some(VhFindingKind::Jump));
        assert!(
            error(&monitor, 4.5).unwrap() < 1e-3,
            "the last good one is held"
        );
    }
    let found = monitor.observe(at(4.5), jump(5));
    assert_eq!(kind(found), Some(VhFindingKind::Recovered));
    assert!((monitor.estimate(at(4.5)).unwrap().vh_per_s - 60.06 / 505.0).abs() < 1e-6);
    assert_eq!(monitor.counters().jump, 4);
}

#[test]
fn values_that_jump_about_are_never_used() {
    let mut monitor = flying(&GOOD[..2]);
    for step in 1..30_u8 {
        let height = if step % 2 == 0 { 400.0 } else { 2600.0 };
        let now = at(4.0 + 0.1 * f32::from(step));
        let found = monitor.observe(now, VhSample::HeightAboveGround(height));
        assert_eq!(kind(found), Some(VhFindingKind::Jump));
    }
    assert!(error(&monitor, 7.0).unwrap() < 1e-3);
}

#[test]
fn most_that_one_wrong_sample_moves_vh_by_is_its_slew_and_noise() {
    // 0.1 s after the last: 10 m of slew and 18 m of noise in 1000 m, 0.5 m/s + 0.6 m/s of 60 m/s.
    for (wrong, bound) in [
        (VhSample::HeightAboveGround as fn(f32) -> _, 0.029),
        (VhSample::GroundSpeed, 0.019),
    ] {
        for thousandths in 500..2000_u16 {
            let mut monitor = flying(&GOOD[..2]);
            let right = if bound > 0.02 { 1000.0 } else { 60.0 };
            monitor.observe(at(4.1), wrong(right * f32::from(thousandths) / 1000.0));
            assert!(error(&monitor, 4.1).unwrap() < bound);
        }
    }
}

#[test]
fn unit_that_changes_in_flight_is_named_and_not_used() {
    for (sample, unit) in [
        (VhSample::GroundSpeed(60.0 / 0.514_444), WrongUnit::Knots),
        (VhSample::GroundSpeed(60.0 * 0.514_444), WrongUnit::Knots),
        (VhSample::HeightAboveGround(3280.84), WrongUnit::Feet),
        (VhSample::HeightAboveGround(304.8), WrongUnit::Feet),
        (VhSample::Altitude(1200.0 / 0.3048), WrongUnit::Feet),
        (VhSample::TerrainHeight(200.0 / 0.3048), WrongUnit::Feet),
    ] {
        // Alone with its past, without another way.
        let (channel, _) = VhChannel::of(sample);
        let alone: Vec<_> = GOOD
            .into_iter()
            .filter(|good| VhChannel::of(*good).0 == channel)
            .collect();
        let mut monitor = flying(&alone);
        // However long it stays.
        for step in 1..600_u16 {
            let now = at(4.0 + 0.1 * f32::from(step));
            let found = monitor.observe(now, noisy(sample, step)).unwrap();
            assert_eq!(
                found.kind,
                VhFindingKind::WrongUnit(unit),
                "{sample:?} {step}"
            );
        }
        let found = monitor.observe(at(65.0), alone[0]);
        assert_eq!(kind(found), Some(VhFindingKind::Recovered), "{sample:?}");
    }
}

#[test]
fn unit_that_is_wrong_from_the_first_sample_is_found_against_another_way() {
    let inertial = VhSample::InertialSpeed(60.0);
    let cases: [(&[VhSample], VhSample); 5] = [
        (&GOOD[..], VhSample::LaserHeight(3280.84)),
        (
            &[GOOD[0], GOOD[2], GOOD[3]],
            VhSample::HeightAboveGround(3280.84),
        ),
        (&[GOOD[0], GOOD[1], GOOD[3]], VhSample::Altitude(3937.0)),
        (
            &[GOOD[0], GOOD[1], GOOD[2]],
            VhSample::TerrainHeight(656.17),
        ),
        (&[inertial, GOOD[1]], VhSample::GroundSpeed(116.63)),
    ];
    for (others, wrong) in cases {
        // In whatever order they come.
        for wrong_first in [false, true] {
            let mut monitor = VhMonitor::default();
            let before = wrong_first.then_some(wrong);
            let after = (!wrong_first).then_some(wrong);
            let found: Vec<_> = before
                .into_iter()
                .chain(others.iter().copied())
                .chain(after)
                .filter_map(|sample| monitor.observe(at(1.0), sample))
                .filter(|found| matches!(found.kind, VhFindingKind::WrongUnit(_)))
                .collect();
            assert_eq!(found.len(), 1, "{wrong:?} {wrong_first} {found:?}");
            assert_eq!(found[0].channel, VhChannel::of(wrong).0);
            assert!(error(&monitor, 1.0).unwrap() < 1e-3);
            // It stays out when the others fall silent, and V/H with it, however long it goes on.
            assert!(monitor.observe(at(80.0), wrong).is_some());
            assert!(monitor.estimate(at(80.0)).is_none());
        }
    }
}

#[test]
fn unit_wrong_from_the_first_sample_without_another_way_is_bounded_by_the_range() {
    // Nothing to compare with: V/H is wrong by the factor, and says so to nobody. A range of the mission finds it.
    let mut monitor = VhMonitor::default();
    monitor.observe(at(0.0), VhSample::GroundSpeed(60.0));
    monitor.observe(at(0.0), VhSample::HeightAboveGround(3280.84));
    assert!((error(&monitor, 0.0).unwrap() - (1.0 - 0.3048)).abs() < 1e-3);
    let mut settings = VhSettings::DEFAULT;
    settings.height_above_ground.range = [500.0, 2000.0];
    let mut monitor = VhMonitor::new(settings.checked().unwrap());
    monitor.observe(at(0.0), VhSample::GroundSpeed(60.0));
    let found = monitor.observe(at(0.0), VhSample::HeightAboveGround(3280.84));
    assert_eq!(kind(found), Some(VhFindingKind::OutOfRange));
    assert_eq!(found.unwrap().expected, Some(2000.0));
    assert!(monitor.estimate(at(0.0)).is_none());
}

#[test]
fn ways_that_disagree_are_found_and_their_difference_is_in_sigma() {
    let mut monitor = flying(&GOOD);
    let alone = monitor.estimate(at(4.1)).unwrap();
    // Terrain 300 m higher than it was: a height of 700 m, V/H 0.0857.
    let mut found = None;
    for step in 0..CONSISTENT_SAMPLES {
        let time = at(4.1 + 0.1 * f32::from(step));
        found = monitor.observe(time, VhSample::TerrainHeight(500.0));
    }
    let found = found.unwrap();
    assert_eq!(found.kind, VhFindingKind::Disagreement);
    assert!((found.expected.unwrap() - 60.06 / 700.0).abs() < 1e-3);
    let both = monitor.estimate(at(4.5)).unwrap();
    assert!((both.vh_per_s - alone.vh_per_s).abs() < 1e-6);
    assert!(both.sigma_per_s >= 0.0257, "{both:?}");
    for step in 0..CONSISTENT_SAMPLES {
        let time = at(5.0 + 0.1 * f32::from(step));
        let found = monitor.observe(time, VhSample::TerrainHeight(200.0));
        let last = step + 1 == CONSISTENT_SAMPLES;
        let expected = if last {
            VhFindingKind::Recovered
        } else {
            VhFindingKind::Jump
        };
        assert_eq!(kind(found), Some(expected));
    }
    assert!(monitor.estimate(at(5.4)).unwrap().sigma_per_s < 0.01);
}

#[test]
fn loss_and_return_are_told() {
    let mut monitor = flying(&GOOD[..2]);
    assert!(monitor.estimate(at(20.0)).is_none());
    let found = monitor.observe(at(20.0), GOOD[0]);
    assert_eq!(kind(found), Some(VhFindingKind::Recovered));
    let found = monitor.observe(at(20.0), VhSample::HeightAboveGround(1400.0));
    assert_eq!(
        kind(found),
        Some(VhFindingKind::Recovered),
        "a height 16 s can reach"
    );
    assert!((monitor.estimate(at(20.0)).unwrap().vh_per_s - 60.0 / 1400.0).abs() < 1e-4);
}

#[test]
fn sample_from_the_past_is_found_and_clear_forgets_all_but_the_counts() {
    let mut monitor = flying(&GOOD);
    let found = monitor.observe(at(3.9), VhSample::GroundSpeed(60.0));
    assert_eq!(kind(found), Some(VhFindingKind::FromThePast));
    monitor.clear();
    assert_eq!(monitor.counters().of(VhFindingKind::FromThePast), 1);
    assert!(monitor.estimate(at(4.0)).is_none());
}

/// Any number, more often one that a sensor may give.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 50.0_f32..70.0,
        4 => 900.0_f32..1300.0,
        2 => 0.01_f32..0.1,
        2 => prop::sample::select(vec![
            f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, f32::MIN_POSITIVE, f32::MAX,
            -60.0, -1000.0, 60.0, 116.6, 1000.0, 3280.84, 304.8, 200.0,
        ]),
        1 => any::<f32>(),
    ]
}

fn sample() -> impl Strategy<Value = VhSample> {
    (number(), 0..7_u8).prop_map(|(value, channel)| match channel {
        0 => VhSample::Direct(value),
        1 => VhSample::GroundSpeed(value),
        2 => VhSample::HeightAboveGround(value),
        3 => VhSample::Altitude(value),
        4 => VhSample::TerrainHeight(value),
        5 => VhSample::InertialSpeed(value),
        _ => VhSample::LaserHeight(value),
    })
}

/// σ of V/H from fresh samples of this source at the least.
fn base_sigma(settings: &VhSettings, estimate: &VhEstimate) -> f32 {
    let [_, highest] = settings.height_above_ground.range;
    match estimate.source {
        VhSource::Direct => settings.direct.sigma,
        VhSource::Altimeter | VhSource::Terrain => settings.ground_speed.sigma / highest,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(1000) })]

    #[test]
    fn estimate_of_any_samples_is_finite_positive_in_range_and_ages(
        samples in prop::collection::vec((0_u64..2_000_000, sample()), 0..80),
    ) {
        let settings = VhSettings::DEFAULT;
        let mut monitor = VhMonitor::new(settings);
        let mut now_us = 0;
        for (step_us, sample) in samples {
            now_us += step_us;
            monitor.observe(Time::from_us(now_us), sample);
            for silence in 0..60_u64 {
                let now = Time::from_us(now_us + silence * 1_000_000);
                let Some(found) = monitor.estimate(now) else {
                    continue;
                };
                let [least, most] = settings.direct.range;
                prop_assert!((least..=most).contains(&found.vh_per_s), "{found:?}");
                prop_assert!(found.sigma_per_s.is_finite() && found.age_s < 60.0);
                prop_assert!(found.sigma_per_s >= base_sigma(&settings, &found));
            }
            prop_assert!(monitor.estimate(Time::from_us(now_us + 60_000_000)).is_none());
        }
    }

    #[test]
    fn sigma_and_age_grow_while_all_are_silent(
        samples in prop::collection::vec((0_u64..2_000_000, sample()), 0..80),
    ) {
        let mut monitor = VhMonitor::default();
        let mut now_us = 0;
        for (step_us, sample) in samples {
            now_us += step_us;
            // One sensor of each quantity: another that takes over is fresher.
            let sample = match sample {
                VhSample::InertialSpeed(value) => VhSample::GroundSpeed(value),
                VhSample::LaserHeight(value) => VhSample::HeightAboveGround(value),
                other => other,
            };
            monitor.observe(Time::from_us(now_us), sample);
        }
        let heard = Time::from_us(now_us);
        let mut before = monitor.estimate(heard);
        for tenths in 1..620_u64 {
            let now = Time::from_us(now_us + tenths * 100_000);
            let found = monitor.estimate(now);
            if let (Some(before), Some(found)) = (before, found)
                && before.source == found.source
            {
                prop_assert!(found.age_s > before.age_s);
                // A way that disagreed takes the difference with it when it is lost.
                prop_assert!(found.sigma_per_s > before.sigma_per_s || monitor.disagrees(heard));
            }
            before = found;
        }
    }

    #[test]
    fn change_from_one_sample_to_the_next_is_bounded_by_slew_and_noise(
        heights in prop::collection::vec(number(), 1..60),
    ) {
        // Fewer in a row than a jump needs to be believed, then a good one.
        let mut monitor = flying(&GOOD[..2]);
        for (step, height) in (1_u16..).zip(heights) {
            let now = at(4.0 + 0.1 * f32::from(step));
            monitor.observe(now, noisy(GOOD[0], step));
            let height = if step % 4 == 0 { 1000.0 } else { height };
            monitor.observe(now, VhSample::HeightAboveGround(height));
            // Three of 10 m + 18 m each away from 1000 m, before the slew back to it.
            if let Some(error) = error(&monitor, 4.0 + 0.1 * f32::from(step)) {
                prop_assert!(error < 0.2, "{error}");
            }
        }
    }
}
