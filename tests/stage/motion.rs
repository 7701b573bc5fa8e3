//! Limits that every profile keeps, and its continuity in place and speed.

use fmc_camera::flight::stage::{MechanismLimits, PlanError, RunUp, Setpoint};
use proptest::prelude::*;

use crate::stage::support::{any_limits, at_rest, check_profile, mirrored, stage, times, tracking};

fn any_run_up() -> impl Strategy<Value = RunUp> {
    prop_oneof![Just(RunUp::Centred), Just(RunUp::FromRest)]
}

/// Returns the state for numbers in units of the stage's limits; they may exceed 1.
fn state(limits: &MechanismLimits, [offset, speed, acceleration]: [f32; 3]) -> Setpoint {
    Setpoint {
        offset_mm: offset * 0.5 * limits.stroke_mm,
        speed_mm_s: speed * limits.max_speed_mm_s.unwrap_or(100.0),
        acceleration_mm_s2: acceleration * limits.acceleration_mm_s2,
    }
}

proptest! {
    #[test]
    fn travel_keeps_its_limits_or_is_refused(
        limits in any_limits(),
        run_up in any_run_up(),
        start in -1.1_f32..1.1,
        speed in -60.0_f32..60.0,
    ) {
        let stage = stage(limits);
        let half_mm = 0.5 * limits.stroke_mm;
        match stage.travel(start * half_mm, run_up, tracking(speed)) {
            Ok(travel) => {
                check_profile(&travel.profile, &limits)?;
                prop_assert!(travel.at_speed_s + limits.settling_ms / 1000.0 <= travel.opening_s * 1.000_001);
                for time_s in times(&travel.profile) {
                    let now = travel.setpoint(time_s);
                    prop_assert!(now.offset_mm.abs() <= half_mm * 1.000_001);
                    prop_assert!(now.speed_mm_s.abs() <= speed.abs() * 1.000_001);
                    if let Some(most) = limits.max_speed_mm_s {
                        prop_assert!(now.speed_mm_s.abs() <= most * 1.000_001);
                    }
                }
            }
            Err(PlanError::Speed { wanted_mm_s, max_mm_s }) => {
                prop_assert!(wanted_mm_s.abs() > max_mm_s);
            }
            Err(PlanError::Stroke(short)) => {
                prop_assert!(short.from_mm.abs().max(short.to_mm.abs()) > short.half_stroke_mm);
            }
            Err(error) => prop_assert!(false, "{error:?}"),
        }
    }

    #[test]
    fn fly_back_keeps_its_limits_or_is_refused(
        limits in any_limits(),
        from in prop::array::uniform3(-1.0_f32..1.0),
        to in -1.0_f32..1.0,
    ) {
        let stage = stage(limits);
        let half_mm = 0.5 * limits.stroke_mm;
        let from = state(&limits, from);
        match stage.reposition(from, to * half_mm) {
            Ok(back) => {
                check_profile(&back, &limits)?;
                prop_assert_eq!(back.end(), at_rest(to * half_mm));
                let (least, most) = back.reach_mm();
                prop_assert!(-half_mm <= least && most <= half_mm);
                for time_s in times(&back) {
                    let now = back.setpoint(time_s);
                    prop_assert!(now.acceleration_mm_s2.abs() <= limits.acceleration_mm_s2 * 1.000_001);
                    let slack = 1e-6 * limits.stroke_mm;
                    prop_assert!(least - slack <= now.offset_mm && now.offset_mm <= most + slack);
                }
                // From standing, the stage does not exceed its largest speed.
                if let (Some(most), Ok(way)) = (limits.max_speed_mm_s, stage.reposition(at_rest(from.offset_mm), to * half_mm)) {
                    for time_s in times(&way) {
                        prop_assert!(way.setpoint(time_s).speed_mm_s.abs() <= most * 1.000_001);
                    }
                }
            }
            Err(PlanError::Stroke(_)) => {
                let (least, most) = stage.stop(from).reach_mm();
                prop_assert!(least < -half_mm || most > half_mm);
            }
            Err(error) => prop_assert!(false, "{error:?}"),
        }
    }

    #[test]
    fn stop_ends_at_rest_and_mirrored_states_stop_mirrored(
        limits in any_limits(),
        from in prop::array::uniform3(-2.0_f32..2.0),
    ) {
        let stage = stage(limits);
        let from = state(&limits, from);
        let stop = stage.stop(from);
        let other = stage.stop(mirrored(from));
        prop_assert!(stop.segments().len() <= 3);
        prop_assert_eq!(stop.end(), at_rest(stop.end().offset_mm));
        for time_s in times(&stop) {
            prop_assert_eq!(stop.setpoint(time_s), mirrored(other.setpoint(time_s)));
        }
        // The changes of speed of the segments add up to the whole speed.
        let change: f64 = stop
            .segments()
            .iter()
            .map(|segment| {
                let (time, jerk) = (f64::from(segment.duration_s), f64::from(segment.jerk_mm_s3));
                f64::from(segment.start.acceleration_mm_s2) * time + jerk * time * time / 2.0
            })
            .sum();
        let turn_s = from.acceleration_mm_s2 / limits.jerk_mm_s3.unwrap_or(f32::INFINITY);
        let scale = from.speed_mm_s.abs() + (from.acceleration_mm_s2 * turn_s).abs();
        prop_assert!(
            (f64::from(from.speed_mm_s) + change).abs() <= 2e-6 * f64::from(scale),
            "{} mm/s are left: {stop:?}", f64::from(from.speed_mm_s) + change
        );
    }

    #[test]
    fn flight_the_other_way_is_mirrored_bit_by_bit(
        limits in any_limits(),
        run_up in any_run_up(),
        start in -1.0_f32..1.0,
        speed in 0.1_f32..60.0,
    ) {
        let stage = stage(limits);
        let from_mm = start * 0.5 * limits.stroke_mm;
        let there = stage.travel(from_mm, run_up, tracking(speed));
        let back = stage.travel(-from_mm, run_up, tracking(-speed));
        prop_assert_eq!(there.is_ok(), back.is_ok());
        if let (Ok(there), Ok(back)) = (there, back) {
            prop_assert_eq!(there.opening_s.to_bits(), back.opening_s.to_bits());
            prop_assert!((there.off_centre_mm + back.off_centre_mm).abs() <= 0.0);
            for time_s in times(&there.profile) {
                prop_assert_eq!(there.setpoint(time_s), mirrored(back.setpoint(time_s)));
            }
        }
        let waiting = [speed, -speed].map(|speed| stage.waiting_place_mm(run_up, tracking(speed)));
        if let [Ok(there), Ok(back)] = waiting {
            prop_assert!((there + back).abs() <= 0.0);
        }
    }
}
