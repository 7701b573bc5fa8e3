//! Rounding of the profiles.

use fmc_camera::flight::stage::{MechanismLimits, POSITION_NM, Profile, RunUp};

use crate::stage::exact::Motion;
use crate::stage::support::{LIMITS, at_rest, stage, tracking, with_jerk};

/// Returns the largest difference in place, nm, between a profile and a motion, at times that
/// single precision has.
fn difference_nm(profile: &Profile, motion: &Motion) -> f64 {
    (0..=20_000_u16)
        .map(|step| profile.duration_s() * f32::from(step) / 20_000.0)
        .map(|time_s| motion.at(time_s.into()).minus(profile.setpoint(time_s))[0].abs() * 1e6)
        .fold(0.0, f64::max)
}

/// Returns stages that need about a second for 4 mm, with the speed at which they do it.
fn slow_stages() -> Vec<(MechanismLimits, f64)> {
    let slow = |acceleration_mm_s2, jerk_mm_s3, max_speed_mm_s: Option<f32>| MechanismLimits {
        acceleration_mm_s2,
        jerk_mm_s3,
        max_speed_mm_s,
        ..LIMITS
    };
    let a = |rise: f64| 24.0 / 2.0 * ((rise * rise + 16.0 / 24.0_f64).sqrt() - rise);
    vec![
        // Two ramps: √(AD), ∛(D²J/4), and between them.
        (slow(16.0, None, None), 8.0),
        (slow(1000.0, Some(128.0), None), (16.0 * 32.0_f64).cbrt()),
        (slow(24.0, Some(200.0), None), a(24.0 / 200.0)),
        // These run at the largest speed for most of the way.
        (slow(50.0, None, Some(5.0)), 5.0),
        (slow(50.0, Some(700.0), Some(5.3)), 5.300_000_190_734_863),
        (
            slow(1000.0, Some(10_000.0), Some(4.1)),
            4.099_999_904_632_568,
        ),
    ]
}

#[test]
fn four_millimetres_in_a_second_are_right_to_half_a_nanometre() {
    for (limits, speed) in slow_stages() {
        for (from_mm, to_mm) in [(-2.0_f32, 2.0_f32), (2.0, -2.0)] {
            let profile = stage(limits).reposition(at_rest(from_mm), to_mm).unwrap();
            let rounding = difference_nm(&profile, &Motion::of(&profile));
            let exact = exact_way(from_mm, to_mm, speed, &limits);
            let duration_s = exact.duration();
            assert!((0.7..1.4).contains(&duration_s), "{duration_s} s");
            let planning = difference_nm(&profile, &exact);
            assert!(rounding <= POSITION_NM.into(), "{limits:?}: {rounding} nm");
            assert!(planning <= POSITION_NM.into(), "{limits:?}: {planning} nm");
        }
    }
}

fn exact_way(from_mm: f32, to_mm: f32, speed: f64, limits: &MechanismLimits) -> Motion {
    let distance = f64::from(to_mm - from_mm);
    let motion = |cruise| {
        Motion::rest_to_rest(
            from_mm.into(),
            speed.copysign(distance),
            cruise,
            limits.acceleration_mm_s2.into(),
            limits.jerk_mm_s3.map(f64::from),
        )
    };
    let ramps = motion(0.0);
    let ramps = ramps.at(ramps.duration()).offset - ramps.start.offset;
    motion(((distance - ramps) / speed.copysign(distance)).max(0.0))
}

#[test]
fn travel_of_an_exposure_is_right_to_half_a_nanometre() {
    for (limits, speeds) in [
        (LIMITS, [5.0_f32, 17.0, 40.0]),
        (with_jerk(200_000.0), [5.0, 17.0, 40.0]),
        (with_jerk(1e4), [0.3, 5.0, 17.0]),
    ] {
        for speed in speeds {
            let stage = stage(limits);
            let start_mm = -1.9;
            let travel = stage
                .travel(start_mm, RunUp::Centred, tracking(speed))
                .unwrap();
            let rounding = difference_nm(&travel.profile, &Motion::of(&travel.profile));
            let exact = |cruise| {
                Motion::rest_to_rest(
                    start_mm.into(),
                    speed.into(),
                    cruise,
                    1000.0,
                    limits.jerk_mm_s3.map(f64::from),
                )
            };
            let ramps = exact(0.0);
            let ramp = (ramps.at(ramps.duration()).offset - f64::from(start_mm)) / 2.0;
            let opening = -f64::from(speed) * 0.005;
            let cruise = (opening - f64::from(start_mm) - ramp) / f64::from(speed) + 0.01;
            let planning = difference_nm(&travel.profile, &exact(cruise));
            assert!(
                rounding <= POSITION_NM.into(),
                "{speed} mm/s: {rounding} nm"
            );
            assert!(
                planning <= POSITION_NM.into(),
                "{speed} mm/s, {limits:?}: {planning} nm"
            );
            let opening_mm = f64::from(travel.setpoint(travel.opening_s).offset_mm);
            let opening_nm = (opening_mm - opening).abs() * 1e6;
            assert!(
                opening_nm <= POSITION_NM.into(),
                "{speed} mm/s: {opening_nm} nm"
            );
        }
    }
}
