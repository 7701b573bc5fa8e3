//! Stops and ways back, with numbers that can be checked by hand.

use fmc_camera::flight::stage::{MechanismLimits, PlanError, Setpoint};

use crate::stage::support::{LIMITS, at_rest, stage, with_jerk};

fn near(found: f32, expected: f32) {
    assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
}

fn moving(offset_mm: f32, speed_mm_s: f32, acceleration_mm_s2: f32) -> Setpoint {
    Setpoint {
        offset_mm,
        speed_mm_s,
        acceleration_mm_s2,
    }
}

#[test]
fn stop_takes_as_long_as_jerk_and_acceleration_demand() {
    for (limits, from, duration_s, end_mm) in [
        // 20/1000 s, 20²/2000 mm.
        (LIMITS, moving(0.5, 20.0, 0.0), 0.02, 0.7),
        (LIMITS, moving(0.5, -20.0, 700.0), 0.02, 0.3),
        // 20/1000 + 1000/10⁵ s, half of it at 20 mm/s.
        (with_jerk(1e5), moving(0.0, 20.0, 0.0), 0.03, 0.3),
        // While accelerating: 10 ms, 5 mm/s and 0.15 + 0.05 - 0.1/6 mm to end that; then as before.
        (with_jerk(1e5), moving(0.0, 15.0, 1000.0), 0.04, 0.483_333_3),
        // While stopping: the acceleration only has to go back to 0, in 10 ms, over 0.05 - 0.05 +
        // 0.1/6 mm.
        (
            with_jerk(1e5),
            moving(0.0, 5.0, -1000.0),
            0.01,
            0.016_666_67,
        ),
        // While stopping too hard: the stage turns round and stops from the other side, with p =
        // √(2·10⁵) mm/s²: 14.47 and 4.47 ms.
        (
            with_jerk(1e5),
            moving(0.0, 3.0, -1000.0),
            0.018_944_27,
            -0.012_277_61,
        ),
    ] {
        let stop = stage(limits).stop(from);
        near(stop.duration_s(), duration_s);
        near(stop.end().offset_mm, end_mm);
    }
}

#[test]
fn way_back_is_as_quick_as_the_limits_allow() {
    let limited = |jerk_mm_s3, max_speed_mm_s| MechanismLimits {
        jerk_mm_s3,
        max_speed_mm_s,
        ..LIMITS
    };
    for (limits, duration_s) in [
        // 2√(D/A).
        (limited(None, None), 0.063_245_55),
        // 10 mm/s: 2·10 ms, and 90 ms for the 0.9 mm between.
        (limited(None, Some(10.0)), 0.11),
        // D > 2·1000³/10¹⁰: v²/1000 + v/100 = 1.
        (limited(Some(1e5), None), 0.074_031_24),
        // D < 2·1000³/10⁸: ∛(10⁴/4), four times √(v/J).
        (limited(Some(1e4), None), 0.147_361_3),
        // 10 mm/s: ramps of 20 ms and 0.1 mm.
        (limited(Some(1e5), Some(10.0)), 0.12),
    ] {
        let back = stage(limits).reposition(at_rest(0.7), -0.3).unwrap();
        near(back.duration_s(), duration_s);
        assert_eq!(back.end(), at_rest(-0.3));
    }
}

#[test]
fn moving_stage_stops_before_it_returns() {
    let stage = stage(LIMITS);
    let back = stage.reposition(moving(0.5, 20.0, 0.0), -0.3).unwrap();
    // The stage takes 20 ms and 0.2 mm to stop, then goes back by 1 mm.
    near(back.duration_s(), 0.02 + 0.063_245_55);
    near(back.setpoint(0.02).offset_mm, 0.7);
    let (least, most) = back.reach_mm();
    near(least, -0.3);
    near(most, 0.7);
    // The reach includes overshoot within the stop.
    let turned = crate::stage::support::stage(with_jerk(1e5)).stop(moving(0.0, 3.0, -1000.0));
    let (least, most) = turned.reach_mm();
    near(least, -0.012_277_61);
    // 3 mm/s are gone after 10 ms·(1 - √0.4).
    near(most, 0.005_099_4);
}

#[test]
fn way_back_stays_within_the_stroke_or_is_refused() {
    let stage = stage(LIMITS);
    for (from, to_mm) in [
        (moving(1.9, 20.0, 0.0), 0.0),
        (at_rest(0.0), 2.001),
        (at_rest(0.0), f32::NAN),
        (at_rest(f32::NAN), 0.0),
        (moving(0.0, f32::NAN, 0.0), 0.0),
        (moving(0.0, f32::INFINITY, 0.0), 0.0),
        (moving(0.0, 1e30, 0.0), 0.0),
        (moving(0.0, 0.0, f32::NAN), 0.0),
        (moving(2.1, 1.0, 0.0), 0.0),
    ] {
        let refused = stage.reposition(from, to_mm);
        assert!(matches!(refused, Err(PlanError::Stroke(_))), "{from:?}");
    }
    // A stage beyond the end may return.
    assert!(stage.reposition(at_rest(2.1), 0.0).is_ok());
    assert!(stage.reposition(moving(2.1, -1.0, 0.0), 0.0).is_ok());
}

#[test]
fn profile_answers_any_time() {
    let back = stage(LIMITS).reposition(at_rest(0.7), -0.3).unwrap();
    for before_s in [-1.0, 0.0, f32::NAN, f32::NEG_INFINITY] {
        assert_eq!(back.setpoint(before_s), at_rest(0.7));
    }
    for after_s in [back.duration_s(), 1e9, f32::INFINITY] {
        assert_eq!(back.setpoint(after_s), at_rest(-0.3));
    }
    let nowhere = stage(LIMITS).reposition(at_rest(0.7), 0.7).unwrap();
    assert!(nowhere.duration_s() <= 0.0);
    assert_eq!(nowhere.setpoint(1.0), at_rest(0.7));
}
