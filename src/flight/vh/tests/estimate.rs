//! V/H, its uncertainty and its sources.

use super::*;

#[test]
fn vh_is_speed_over_height_with_its_sigma() {
    let estimate = flying_with(calm(), &GOOD).estimate(at(4.0)).unwrap();
    assert_eq!(estimate.source, VhSource::Altimeter);
    assert!(!estimate.extrapolated && estimate.age_s < 1e-6);
    assert!((estimate.vh_per_s - VH).abs() < 1e-4);
    // 0.1 m/s of 60 m/s and 3 m of 1000 m: 1/600 and 3/1000 of 0.06.
    let expected = VH * fmc_camera_kernel::sqrt(1.0 / (600.0 * 600.0) + 9e-6);
    assert!((estimate.sigma_per_s - expected).abs() < 0.001 * expected);
}

#[test]
fn age_counts_from_the_measurement_to_the_use_and_sigma_grows_with_it() {
    let mut settings = calm();
    settings.direct.latency_s = 0.3;
    settings.direct.change_per_sqrt_s = 0.004;
    let mut monitor = VhMonitor::new(settings.checked().unwrap());
    monitor.observe(at(1.0), VhSample::Direct(VH));
    for (now, ahead_s, age_s) in [(1.0, 0.0, 0.3), (1.5, 0.0, 0.8), (1.5, 0.05, 0.85)] {
        let found = monitor.estimate_ahead(at(now), ahead_s).unwrap();
        assert!((found.age_s - age_s).abs() < 1e-6, "{found:?}");
        // A noise of 0.0005 1/s and a random walk of 0.004 1/s per √s.
        let expected = fmc_camera_kernel::sqrt(0.0005 * 0.0005 + 0.004 * 0.004 * age_s);
        assert!((found.sigma_per_s - expected).abs() < 1e-3 * expected);
    }
}

#[test]
fn noise_and_change_are_those_of_the_samples() {
    // Every 0.1 s, a noise of ±0.3 m/s and, on the right, steps of ±1 m/s every 0.4 s.
    let sigma = |step_m_s: f32| {
        let mut monitor = VhMonitor::new(calm().checked().unwrap());
        let mut speed_m_s = 60.0;
        for step in 0..600_u16 {
            let now = at(0.1 * f32::from(step));
            let sign = |bit: u32| {
                if (0x9e37_79b9_u32 >> bit) & 1 == 0 {
                    1.0
                } else {
                    -1.0
                }
            };
            if step % 4 == 0 {
                speed_m_s += step_m_s * sign(u32::from(step / 4) % 32);
            }
            let noise_m_s = 0.3 * sign(u32::from(7 * step) % 32);
            monitor.observe(now, VhSample::GroundSpeed(speed_m_s + noise_m_s));
            monitor.observe(now, VhSample::HeightAboveGround(1000.0 + noise_m_s));
        }
        let estimate = monitor.estimate_ahead(at(59.9), 0.4).unwrap();
        // Less the 3 m of the altimeter.
        let of_height = estimate.vh_per_s * 0.003;
        let sigma = estimate.sigma_per_s;
        1000.0 * fmc_camera_kernel::sqrt(sigma * sigma - of_height * of_height)
    };
    // The noise alone, where the settings state 0.1 m/s.
    let noise = sigma(0.0);
    assert!((0.2..0.45).contains(&noise), "{noise}");
    // Within 0.4 s the speed changes by 1 m/s.
    let change = sigma(1.0);
    assert!((0.7..1.6).contains(&change), "{change}");
}

#[test]
fn guess_of_the_change_fades_with_the_differences_that_the_samples_show() {
    // A speed that does not change, every half second, and V/H at the age of a second: after n
    // differences σ² is `w/(w + n)` of the guess, w = 1/(1 + n/2).
    let sigma = |differences: u16| {
        let mut settings = calm();
        settings.ground_speed.change_per_sqrt_s = 3.0;
        settings.ground_speed.sigma = 1e-3;
        settings.height_above_ground.sigma = 1e-6;
        let mut monitor = VhMonitor::new(settings.checked().unwrap());
        for step in 0..=differences {
            let now = at(0.5 * f32::from(step));
            // No value repeats.
            let little = 1e-4 * f32::from(step % 2);
            monitor.observe(now, VhSample::GroundSpeed(60.0 + little));
            monitor.observe(now, VhSample::HeightAboveGround(1000.0 + little));
        }
        let latest = at(0.5 * f32::from(differences));
        1000.0 * monitor.estimate_ahead(latest, 1.0).unwrap().sigma_per_s
    };
    for (differences, share) in [(0, 1.0), (2, 1.0 / 5.0), (4, 1.0 / 13.0), (10, 1.0 / 61.0)] {
        let expected = 3.0 * fmc_camera_kernel::sqrt(share);
        let found = sigma(differences);
        assert!(
            (found - expected).abs() < 0.001 * expected,
            "{differences}: {found}"
        );
    }
    // A twentieth of the guess stays.
    assert!((sigma(400) - 0.15).abs() < 0.001);
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
    let monitor = flying_with(calm(), &GOOD[..2]);
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
    // After 1 s the altimeter has been silent for 0.5 s more than its period: 50 m/√3 of 1000 m,
    // and 3 m; 2.9 % of 0.06 1/s over 85.7 px·s.
    assert!((grown[2] - 0.150).abs() < 0.01, "{grown:?}");
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

#[test]
fn vh_is_known_as_long_as_there_is_an_estimate() {
    for sources in [
        &GOOD[..],
        &GOOD[..2],
        &[GOOD[0], GOOD[2], GOOD[3]],
        &GOOD[..1],
    ] {
        let monitor = flying(sources);
        for tenths in 40..700_u16 {
            let now = at(0.1 * f32::from(tenths));
            assert_eq!(monitor.is_known(now), monitor.estimate(now).is_some());
        }
    }
}
