//! V/H, its uncertainty and its sources.

use super::*;

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
    // Direct and radar are valid for 5 s; the terrain's height for 60 s, speed and altitude for
    // 10 s.
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
    // f·t/p of 150 mm, 1/200 s and 8.75 µm: smear per σ of V/H.
    let smear_px_s = 1000.0 * 150.0 * 0.005 / 8.75;
    let smear = |age: f32| {
        let estimate = monitor.estimate(at(4.0 + age)).unwrap();
        assert_eq!(estimate.extrapolated, age >= 0.5);
        assert!((estimate.age_s - age).abs() < 1e-5);
        smear_px_s * estimate.sigma_per_s
    };
    let grown = [0.0, 0.4, 1.0, 2.0, 4.0, 4.9].map(smear);
    assert!(grown.is_sorted(), "{grown:?}");
    assert!(grown[0] < 0.02);
    // After 1 s: 100 m/√3 of 1000 m and 5 m/s/√3 of 60 m/s, 7.5 % of 0.06 1/s over 85.7 px·s.
    assert!((grown[2] - 0.386).abs() < 0.01, "{grown:?}");
    assert!(monitor.estimate(at(9.01)).is_none());
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
