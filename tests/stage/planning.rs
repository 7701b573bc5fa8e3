//! Start, opening and end of travels, and their refusals.

use fmc_camera::flight::stage::{
    MechanismLimits, PlanError, RunUp, Stage, StrokeTooShort, Tracking,
};
use fmc_camera::geometry::range::Quantity;

use crate::stage::support::{LIMITS, TRACKING, stage, tracking, with_jerk};

fn near(found: f32, expected: f32) {
    assert!((found - expected).abs() < 1e-6, "{found} is not {expected}");
}

#[test]
fn ramp_is_the_trapezoid_the_triangle_or_the_step_of_the_acceleration() {
    let opening_mm = |limits, speed| {
        let long = MechanismLimits {
            stroke_mm: 10.0,
            ..limits
        };
        let plan = stage(long).plan(RunUp::FromRest, tracking(speed)).unwrap();
        plan.opening_mm - 0.005 * speed
    };
    // 20²/2000.
    near(opening_mm(LIMITS, 20.0), 0.2);
    // 20 mm/s ≥ 1000²/10⁵: 20(20/1000 + 1000/10⁵)/2.
    near(opening_mm(with_jerk(1e5), 20.0), 0.3);
    // 20 mm/s < 1000²/10⁴: 20√(20/10⁴).
    near(opening_mm(with_jerk(1e4), 20.0), 0.894_427_2);
    // At 10 mm/s the two formulas agree: 10·10·2/1000/2.
    near(opening_mm(with_jerk(1e5), 10.0), 0.1);
}

#[test]
fn large_jerk_plans_as_unlimited_jerk() {
    for run_up in [RunUp::Centred, RunUp::FromRest] {
        for speed in [-40.0, -0.5, 0.0, 3.0, 17.0, 40.0] {
            let [step, steep] = [None, Some(1e12)].map(|jerk_mm_s3| {
                let limits = MechanismLimits {
                    jerk_mm_s3,
                    stroke_mm: 10.0,
                    ..LIMITS
                };
                stage(limits).plan(run_up, tracking(speed)).unwrap()
            });
            near(steep.start_mm, step.start_mm);
            near(steep.opening_mm, step.opening_mm);
            near(steep.stop_mm, step.stop_mm);
        }
    }
}

#[test]
fn spare_run_up_settles_longer_and_a_short_one_opens_off_the_place() {
    let stage = stage(with_jerk(1e5));
    // 30 ms and 0.3 mm of ramp, 0.1 mm of settling: -0.5 mm is the best start.
    let best = stage.travel(-0.5, RunUp::Centred, TRACKING).unwrap();
    near(best.at_speed_s, 0.03);
    near(best.opening_s, 0.035);
    near(best.off_centre_mm, 0.0);
    let plan = stage.plan(RunUp::Centred, TRACKING).unwrap();
    near(best.plan.stop_mm, plan.stop_mm);
    near(best.stop_s, 0.075);
    let early = stage.travel(-0.9, RunUp::Centred, TRACKING).unwrap();
    near(early.opening_s, 0.055);
    near(early.plan.opening_mm, -0.1);
    assert!(early.off_centre_mm.abs() <= 0.0);
    let late = stage.travel(0.1, RunUp::Centred, TRACKING).unwrap();
    near(late.opening_s, 0.035);
    near(late.off_centre_mm, 0.6);
    near(late.plan.stop_mm, 1.0);
    let backwards = stage.travel(0.9, RunUp::Centred, tracking(-20.0)).unwrap();
    near(backwards.opening_s, 0.055);
    near(backwards.plan.opening_mm, 0.1);
}

#[test]
fn stage_is_at_the_planned_place_with_the_planned_speed_when_the_shutter_opens_and_closes() {
    for (from_mm, speed) in [(-1.9, 17.0), (-0.1, 17.0), (0.6, 17.0), (1.5, -30.0)] {
        let travel = stage(with_jerk(2e5))
            .travel(from_mm, RunUp::Centred, tracking(speed))
            .unwrap();
        for (time_s, place_mm) in [
            (travel.opening_s, travel.plan.opening_mm),
            (travel.closing_s, travel.plan.closing_mm),
            (travel.stop_s, travel.plan.stop_mm),
        ] {
            near(travel.setpoint(time_s).offset_mm, place_mm);
        }
        for time_s in [travel.opening_s, travel.closing_s] {
            let now = travel.setpoint(time_s);
            assert!((now.speed_mm_s - speed).abs() <= 0.0, "{now:?}");
            assert!(now.acceleration_mm_s2.abs() <= 0.0, "{now:?}");
        }
    }
}

#[test]
fn margin_keeps_the_speed_for_a_shutter_that_is_late() {
    let late = Tracking {
        margin_s: 0.004,
        ..TRACKING
    };
    let travel = stage(LIMITS).travel(-0.4, RunUp::Centred, late).unwrap();
    let now = travel.setpoint(travel.closing_s + 0.0039);
    near(now.speed_mm_s, 20.0);
    // At 20 mm/s for 4 ms.
    near(travel.plan.stop_mm, 0.3 + 0.08);
    let plan = stage(LIMITS).plan(RunUp::Centred, late).unwrap();
    near(plan.stop_mm, travel.plan.stop_mm);
}

#[test]
fn waiting_place_leaves_run_up_for_a_tenth_more_speed() {
    let stage = stage(with_jerk(1e5));
    let place_mm = stage.waiting_place_mm(RunUp::Centred, TRACKING).unwrap();
    for (speed, in_place) in [(18.0, true), (20.0, true), (22.0, true), (22.1, false)] {
        let travel = stage
            .travel(place_mm, RunUp::Centred, tracking(speed))
            .unwrap();
        assert_eq!(travel.off_centre_mm.abs() <= 0.0, in_place, "{speed} mm/s");
    }
    near(
        stage.waiting_place_mm(RunUp::FromRest, TRACKING).unwrap(),
        0.0,
    );
    // The stroke bounds the reserve: -0.5 mm is needed, -0.57 mm would be better.
    let short = Stage::new(MechanismLimits {
        stroke_mm: 1.02,
        ..with_jerk(1e5)
    })
    .unwrap();
    near(
        short.waiting_place_mm(RunUp::Centred, TRACKING).unwrap(),
        -0.51,
    );
}

#[test]
fn travel_that_cannot_be_made_is_refused_with_the_reason() {
    let fast = stage(MechanismLimits {
        max_speed_mm_s: Some(19.0),
        ..LIMITS
    });
    let too_fast = PlanError::Speed {
        wanted_mm_s: -20.0,
        max_mm_s: 19.0,
    };
    assert_eq!(fast.plan(RunUp::Centred, tracking(-20.0)), Err(too_fast));
    assert_eq!(fast.opening_at(0.0, tracking(-20.0)), Err(too_fast));
    assert_eq!(
        fast.travel(0.0, RunUp::Centred, tracking(-20.0)),
        Err(too_fast)
    );
    assert_eq!(
        too_fast.to_string(),
        "the exposure needs a speed of -20 mm/s, the stage allows -19 mm/s to 19 mm/s"
    );
    let stage = stage(LIMITS);
    // From 1.5 mm: 0.3 mm of run-up, 0.2 mm of exposure, 0.2 mm to stop.
    let refused = stage.travel(1.5, RunUp::Centred, TRACKING);
    let Err(PlanError::Stroke(StrokeTooShort { from_mm, to_mm, .. })) = refused else {
        panic!("{refused:?}");
    };
    near(from_mm, 1.5);
    near(to_mm, 2.2);
    // In the other direction it fits.
    assert!(stage.travel(1.5, RunUp::Centred, tracking(-20.0)).is_ok());
}

#[test]
fn cycle_is_travel_and_fly_back() {
    let stage = stage(LIMITS);
    // 20 + 5 + 10 + 20 ms from -0.4 mm to 0.3 mm; back over 0.7 mm with 1000 mm/s²: 2√(0.7/1000) s.
    let travel = stage.travel(-0.4, RunUp::Centred, TRACKING).unwrap();
    let needed = 0.055 + 2.0 * 0.026_457_51;
    near(stage.cycle_s(&travel, -0.4).unwrap(), needed);
    assert!(matches!(
        stage.cycle_s(&travel, 2.1),
        Err(PlanError::Stroke(_))
    ));
}

#[test]
fn standing_image_is_exposed_where_the_stage_stands() {
    let travel = stage(with_jerk(1e5))
        .travel(-0.3, RunUp::Centred, tracking(0.0))
        .unwrap();
    near(travel.opening_s, 0.005);
    near(travel.off_centre_mm, -0.3);
    near(travel.setpoint(travel.closing_s).offset_mm, -0.3);
}

#[test]
fn numbers_that_are_none_are_refused() {
    let stage = stage(with_jerk(1e5));
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
        let refused = [
            stage.travel(wrong, RunUp::Centred, TRACKING).err(),
            stage.travel(0.0, RunUp::Centred, tracking(wrong)).err(),
            stage.plan(RunUp::FromRest, tracking(wrong)).err(),
            stage.opening_at(wrong, TRACKING).err(),
            stage
                .waiting_place_mm(RunUp::Centred, tracking(wrong))
                .err(),
        ];
        for (index, refusal) in refused.iter().enumerate() {
            assert!(refusal.is_some(), "{index}: {wrong}");
        }
        for exposure_s in [wrong, -0.01, 0.0] {
            let bad = Tracking {
                exposure_s,
                ..TRACKING
            };
            let refused = stage.travel(-0.5, RunUp::Centred, bad);
            let Err(PlanError::OutOfRange(range)) = refused else {
                panic!("{refused:?}");
            };
            assert_eq!(range.quantity, Quantity::ExposureS);
        }
        let bad = Tracking {
            centroid_time_s: wrong,
            ..TRACKING
        };
        assert!(stage.travel(-0.5, RunUp::Centred, bad).is_err());
    }
    // At this speed the stage would never arrive.
    let creeping = stage.travel(-1.0, RunUp::Centred, tracking(1e-39));
    assert!(
        matches!(creeping, Err(PlanError::Time { .. })),
        "{creeping:?}"
    );
}

#[test]
fn limits_that_are_not_believable_are_named() {
    let refused = |limits| Stage::new(limits).unwrap_err().quantity;
    for wrong in [f32::NAN, 0.0, -5.0, f32::INFINITY] {
        assert_eq!(refused(with_jerk(wrong)), Quantity::JerkMmS3);
        let speed = MechanismLimits {
            max_speed_mm_s: Some(wrong),
            ..LIMITS
        };
        assert_eq!(refused(speed), Quantity::MaxSpeedMmS);
    }
}
