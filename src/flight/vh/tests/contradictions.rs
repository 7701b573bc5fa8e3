//! Sources that contradict each other, and a source that jumps while it is alone.

use super::*;

/// Sends samples every 0.1 s for a time, s.
fn send(monitor: &mut VhMonitor, from_s: f32, samples: &[VhSample], steps: u16) {
    for step in 1..=steps {
        for sample in samples {
            monitor.observe(at(from_s + 0.1 * f32::from(step)), noisy(*sample, step));
        }
    }
}

/// Returns V/H and its σ.
fn found(monitor: &VhMonitor, seconds: f32) -> (f32, f32, VhSource) {
    let estimate = monitor.estimate(at(seconds)).unwrap();
    (estimate.vh_per_s, estimate.sigma_per_s, estimate.source)
}

const RIGHT: VhSample = VhSample::Direct(VH);

#[test]
fn half_of_vh_is_not_believed_over_speed_and_height_that_were_right() {
    // The factors of a jump by half and of a speed in knots.
    for factor in [0.5, 0.514_444] {
        let mut monitor = flying(&[RIGHT, GOOD[0], GOOD[1]]);
        let wrong = VhSample::Direct(factor * VH);
        send(&mut monitor, 4.0, &[wrong, GOOD[0], GOOD[1]], 700);
        let (vh, sigma, source) = found(&monitor, 74.0);
        assert_eq!(source, VhSource::Altimeter);
        assert!((vh - VH).abs() < 0.001 * VH, "{vh}");
        // σ covers both.
        assert!(sigma >= (1.0 - factor) * VH * 0.99, "{sigma}");
        assert!(monitor.has_disagreed() && !monitor.is_unconfirmed());
        assert_eq!(monitor.counters().wrong_unit, 0);
        // It returns: everything is as before.
        send(&mut monitor, 74.0, &[RIGHT, GOOD[0], GOOD[1]], 30);
        let (vh, sigma, source) = found(&monitor, 77.0);
        assert_eq!(source, VhSource::Direct);
        assert!((vh - VH).abs() < 1e-6 && sigma < 0.02 * VH, "{sigma}");
        assert!(!monitor.has_disagreed());
    }
}

#[test]
fn vh_that_drifts_away_slower_than_it_can_slew_gives_way_to_speed_and_height() {
    let mut monitor = flying(&[RIGHT, GOOD[0], GOOD[1]]);
    for step in 1..=60_u16 {
        let now = at(4.0 + 0.1 * f32::from(step));
        monitor.observe(now, VhSample::Direct(VH - 0.0005 * f32::from(step)));
        monitor.observe(now, noisy(GOOD[0], step));
        monitor.observe(now, noisy(GOOD[1], step));
    }
    let (vh, sigma, source) = found(&monitor, 10.0);
    assert_eq!(source, VhSource::Altimeter);
    assert!(
        (vh - VH).abs() < 0.001 * VH && sigma > 0.45 * VH,
        "{vh} {sigma}"
    );
    // The right speed is never taken for one in knots.
    assert_eq!(monitor.counters().wrong_unit, 0);
    assert!(monitor.has_disagreed());
}

#[test]
fn one_of_three_ways_is_outvoted_and_one_outside_the_limits_is_implausible() {
    let good = [GOOD[0], GOOD[1], GOOD[2], GOOD[3]];
    let mut monitor = VhMonitor::default();
    // Wrong from the first sample on, with nothing to be trusted before.
    monitor.observe(at(0.0), VhSample::Direct(0.09));
    for sample in good {
        monitor.observe(at(0.0), sample);
    }
    let (vh, sigma, source) = found(&monitor, 0.0);
    assert_eq!(source, VhSource::Altimeter);
    assert!((vh - VH).abs() < 1e-6 && sigma >= 0.03);
    for (limits_per_s, expected) in [
        ([0.05, 0.17], VhSource::Direct),
        ([0.05, 0.08], VhSource::Altimeter),
    ] {
        let mut monitor = VhMonitor::default().with_limits(limits_per_s);
        for sample in [VhSample::Direct(0.09), GOOD[0], GOOD[1]] {
            monitor.observe(at(0.0), sample);
        }
        let (_, sigma, source) = found(&monitor, 0.0);
        assert_eq!(source, expected);
        assert!(sigma >= 0.03 && monitor.has_disagreed());
    }
}

#[test]
fn value_of_the_last_minute_speaks_for_the_source_that_kept_to_it() {
    // Speed and height alone at first; V/H comes later, and differs.
    let mut monitor = flying(&GOOD[..2]);
    let wrong = VhSample::Direct(0.09);
    send(&mut monitor, 4.0, &[wrong, GOOD[0], GOOD[1]], 700);
    let (vh, sigma, source) = found(&monitor, 74.0);
    assert_eq!(source, VhSource::Altimeter);
    assert!((vh - VH).abs() < 0.001 * VH && sigma >= 0.0299, "{sigma}");
    assert!(monitor.has_disagreed());
}

#[test]
fn better_source_that_falls_silent_gives_way_at_its_period() {
    let mut monitor = flying(&[RIGHT, GOOD[0], GOOD[1]]);
    send(&mut monitor, 4.0, &GOOD[..2], 40);
    let of = |seconds| found(&monitor, seconds).2;
    // It is valid for 5 s and has a period of 1.2 s.
    assert_eq!(of(5.1), VhSource::Direct);
    assert_eq!(of(5.3), VhSource::Altimeter);
    let at_8 = monitor.estimate(at(8.0)).unwrap();
    assert!(!at_8.extrapolated && at_8.source == VhSource::Altimeter);
    // So do the receiver's speed and the laser, of speeds and heights.
    let speed = VhSample::InertialSpeed(60.5);
    let mut monitor = flying(&[GOOD[0], GOOD[1], VhSample::InertialSpeed(60.0)]);
    send(&mut monitor, 4.0, &[speed, GOOD[1]], 20);
    let (vh, ..) = found(&monitor, 6.0);
    assert!((vh - 60.5 / 1000.0).abs() < 1e-4, "{vh}");
}

#[test]
fn source_that_is_alone_and_jumps_is_unconfirmed_until_another_agrees_or_it_returns() {
    let jumped = VhSample::HeightAboveGround(500.0);
    let after_jump = || {
        let mut monitor = flying(&GOOD[..2]);
        send(&mut monitor, 4.0, &[GOOD[0], jumped], 300);
        let (vh, sigma, _) = found(&monitor, 34.0);
        // 500 m is used, and σ covers the 1000 m before.
        assert!(
            (vh - 0.12).abs() < 1e-3 && sigma > 0.99 * (vh - VH),
            "{vh} {sigma}"
        );
        assert!(monitor.is_unconfirmed());
        monitor
    };
    let mut confirmed = after_jump();
    confirmed.observe(at(34.1), VhSample::LaserHeight(501.0));
    confirmed.observe(at(34.1), jumped);
    assert!(!confirmed.is_unconfirmed() && found(&confirmed, 34.1).1 < 0.01);
    let mut returned = after_jump();
    send(&mut returned, 34.0, &[GOOD[0], GOOD[1]], 10);
    assert!(!returned.is_unconfirmed());
    assert!(error(&returned, 35.0).unwrap() < 1e-3 && found(&returned, 35.0).1 < 0.01);
    let mut cleared = after_jump();
    cleared.clear_doubt();
    assert!(!cleared.is_unconfirmed() && found(&cleared, 34.0).1 < 0.01);
    // Another jump away does not end the doubt.
    let mut again = after_jump();
    let other = VhSample::HeightAboveGround(700.0);
    send(&mut again, 34.0, &[GOOD[0], other], 50);
    assert!(again.is_unconfirmed());
}

#[test]
fn difference_that_is_no_contradiction_is_half_in_sigma() {
    // 3 % apart, below the limit of 5 %: a latency or a constant error.
    let mut monitor = VhMonitor::new(calm().checked().unwrap());
    let other = VhSample::Direct(1.03 * VH);
    send(&mut monitor, 0.0, &[other, GOOD[0], GOOD[1]], 100);
    let (vh, sigma, source) = found(&monitor, 10.0);
    assert_eq!(source, VhSource::Direct);
    assert!((vh - 1.03 * VH).abs() < 1e-6);
    let difference = 0.03 * VH;
    assert!((0.7..1.0).contains(&(sigma / difference)), "{sigma}");
    assert!(!monitor.has_disagreed());
}

#[test]
fn sigma_covers_a_lower_height_that_may_be_true() {
    // A radar alone that jumps to the threefold, and a laser that says so from the beginning.
    let high = 3000.0;
    let mut jumped = flying(&GOOD[..2]);
    let height = VhSample::HeightAboveGround(high);
    send(&mut jumped, 4.0, &[GOOD[0], height], 300);
    let mut contradicted = VhMonitor::new(calm().checked().unwrap());
    let laser = VhSample::LaserHeight(high);
    send(&mut contradicted, 0.0, &[GOOD[0], GOOD[1], laser], 50);
    for (monitor, seconds) in [(jumped, 34.0), (contradicted, 5.0)] {
        let (vh, sigma, _) = found(&monitor, seconds);
        assert!((vh - VH / 3.0).abs() < 0.001 * VH, "{vh}");
        assert!(sigma > 0.99 * (VH - vh), "{sigma}");
    }
}

#[test]
fn jump_that_gusts_might_have_made_by_the_time_it_is_believed_is_unconfirmed() {
    // A speed alone, twice a second: 30 % more is refused at first.
    let mut settings = calm();
    settings.ground_speed.change_per_sqrt_s = 3.0;
    let mut monitor = VhMonitor::new(settings.checked().unwrap());
    let speed = |monitor: &mut VhMonitor, step: u16, speed_m_s: f32| {
        let now = at(0.5 * f32::from(step));
        monitor.observe(now, noisy(GOOD[1], step));
        monitor.observe(now, noisy(VhSample::GroundSpeed(speed_m_s), step))
    };
    for step in 0..3_u16 {
        assert_eq!(speed(&mut monitor, step, 60.0), None);
    }
    let refused = (3..10_u16).take_while(|step| {
        speed(&mut monitor, *step, 78.0).is_some_and(|found| found.kind == VhFindingKind::Jump)
    });
    let refused = refused.count();
    assert!((1..4).contains(&refused), "{refused}");
    assert!(monitor.is_unconfirmed());
    let (vh, sigma, _) = found(
        &monitor,
        1.5 + 0.5 * f32::from(u8::try_from(refused).unwrap()),
    );
    assert!(sigma > 0.99 * (vh - VH), "{vh} {sigma}");
}

#[test]
fn height_above_sea_is_confirmed_by_parts_of_the_height_above_ground() {
    // 500 m above a plateau of 4000 m; an altitude of 4300 m is within 5 % of 4500 m.
    let [terrain, altitude] = [VhSample::TerrainHeight(4000.0), VhSample::Altitude(4500.0)];
    let speed = VhSample::GroundSpeed(30.0);
    let mut settings = calm();
    settings.altitude.sigma = 1.0;
    let mut monitor = VhMonitor::new(settings.checked().unwrap());
    send(&mut monitor, 0.0, &[speed, terrain, altitude], 40);
    send(
        &mut monitor,
        4.0,
        &[speed, terrain, VhSample::Altitude(4300.0)],
        300,
    );
    let (vh, sigma, _) = found(&monitor, 34.0);
    assert!((vh - 0.1).abs() < 0.002, "{vh}");
    assert!(monitor.is_unconfirmed() && sigma > 0.039, "{sigma}");
}

#[test]
fn height_that_gives_no_vh_does_not_hide_another() {
    // V/H of 0.012, and of 0.0012 by the laser.
    let mut settings = calm();
    settings.direct.range = [0.005, 2.0];
    let mut monitor = VhMonitor::new(settings.checked().unwrap());
    let speed = VhSample::GroundSpeed(6.0);
    let near = VhSample::HeightAboveGround(500.0);
    let far = VhSample::LaserHeight(4900.0);
    send(&mut monitor, 0.0, &[speed, near, far], 20);
    let (vh, ..) = found(&monitor, 2.0);
    assert!((0.011..0.013).contains(&vh), "{vh}");
    assert!(monitor.is_known(at(2.0)));
}

#[test]
fn sigma_covers_a_value_that_is_refused_again_and_again() {
    let mut monitor = flying(&[RIGHT]);
    let sigma = |monitor: &VhMonitor, seconds| found(monitor, seconds).1;
    let jumped = VhSample::Direct(1.2 * VH);
    send(&mut monitor, 4.0, &[jumped], 1);
    // A single one may be a glitch.
    assert!(sigma(&monitor, 4.1) < 0.05 * VH);
    send(&mut monitor, 4.1, &[jumped], 2);
    let (vh, covered, _) = found(&monitor, 4.3);
    assert!(
        (vh - VH).abs() < 0.01 * VH && covered > 0.19 * VH,
        "{vh} {covered}"
    );
    send(&mut monitor, 4.3, &[RIGHT], 5);
    assert!(sigma(&monitor, 4.8) < 0.05 * VH);
}
