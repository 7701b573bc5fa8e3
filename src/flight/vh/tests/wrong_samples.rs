//! Tests of wrong samples, and of their use.

use super::*;

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
    // One good speed and one good height came separately, so their quotient is good.
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
        // The source is alone with its past, without another way.
        let (channel, _) = VhChannel::of(sample);
        let alone: Vec<_> = GOOD
            .into_iter()
            .filter(|good| VhChannel::of(*good).0 == channel)
            .collect();
        let mut monitor = flying(&alone);
        // It stays barred, however long the unit stays wrong.
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
        // The samples may come in any order.
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
    // Without another source V/H is wrong by the factor, and no finding reports it. A range set for
    // the mission finds it.
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
fn sample_from_the_past_is_found_and_clear_forgets_all_but_the_counts() {
    let mut monitor = flying(&GOOD);
    let found = monitor.observe(at(3.9), VhSample::GroundSpeed(60.0));
    assert_eq!(kind(found), Some(VhFindingKind::FromThePast));
    monitor.clear();
    assert_eq!(monitor.counters().of(VhFindingKind::FromThePast), 1);
    assert!(monitor.estimate(at(4.0)).is_none());
}
