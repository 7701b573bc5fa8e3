//! Properties that hold for all samples of the sensors.

use super::*;

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

/// Returns the least σ of V/H, that of fresh samples of this source.
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
                prop_assert!(found.sigma_per_s.is_finite());
                prop_assert!(found.age_s < 60.0 + settings.terrain_height.latency_s);
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
            // One sensor of each quantity is used, since another that takes over is fresher.
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
                let last = Time::from_us(now.us() - 100_000);
                let disagreed = monitor.survey(last).against().is_some();
                // Beside another value that may be true the growth may be lost in rounding.
                let is_alone = monitor.held(now).is_some_and(|it| {
                    let [least, most] = it.held.bounds;
                    most - least <= 0.0
                });
                let has_grown = found.sigma_per_s > before.sigma_per_s
                    || !is_alone && found.sigma_per_s >= before.sigma_per_s;
                prop_assert!(has_grown || disagreed);
            }
            before = found;
        }
    }

    #[test]
    fn change_from_one_sample_to_the_next_is_bounded_by_slew_and_noise(
        heights in prop::collection::vec(number(), 1..60),
    ) {
        // Fewer samples in a row than a jump needs to be trusted, then a good one.
        let mut monitor = flying(&GOOD[..2]);
        // 100 m/s, and six σ of 3 m; single precision leaves a centimetre.
        let reach_m = |seconds: f32| 100.0 * seconds + 18.0 + 0.01;
        let mut before = (4.0, 1000.06);
        for (step, height) in (1_u16..).zip(heights) {
            let seconds = 4.0 + 0.1 * f32::from(step);
            let speed = noisy(GOOD[0], step);
            monitor.observe(at(seconds), speed);
            let height = if step % 4 == 0 { 1000.0 } else { height };
            monitor.observe(at(seconds), VhSample::HeightAboveGround(height));
            let (Some(found), VhSample::GroundSpeed(speed)) = (monitor.estimate(at(seconds)), speed)
            else {
                continue;
            };
            let believed = speed / found.vh_per_s;
            let (since, last) = before;
            let moved = (believed - last).abs();
            // Five samples that agree with one another have a good one among them.
            let is_jump_to_the_good = (believed - 1000.0).abs() <= 4.0 * reach_m(0.1);
            prop_assert!(
                moved <= reach_m(seconds - since) || is_jump_to_the_good,
                "{last} m at {since} s, {believed} m at {seconds} s"
            );
            if moved > 0.01 {
                before = (seconds, believed);
            }
        }
    }
}
