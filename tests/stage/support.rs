//! Stages for plans.

use fmc_camera::flight::stage::{MechanismLimits, Profile, Setpoint, Stage, Tracking};
use proptest::prelude::*;

/// Limits of the stage of a camera file that gives none.
pub(crate) const LIMITS: MechanismLimits = MechanismLimits {
    acceleration_mm_s2: 1000.0,
    jerk_mm_s3: None,
    max_speed_mm_s: None,
    settling_ms: 5.0,
    stroke_mm: 4.0,
};

pub(crate) const TRACKING: Tracking = Tracking {
    speed_mm_s: 20.0,
    exposure_s: 0.01,
    centroid_time_s: 0.005,
    margin_s: 0.0,
};

pub(crate) fn with_jerk(jerk_mm_s3: f32) -> MechanismLimits {
    MechanismLimits {
        jerk_mm_s3: Some(jerk_mm_s3),
        ..LIMITS
    }
}

pub(crate) fn stage(limits: MechanismLimits) -> Stage {
    Stage::new(limits).unwrap()
}

pub(crate) fn at_rest(offset_mm: f32) -> Setpoint {
    Setpoint {
        offset_mm,
        ..Setpoint::default()
    }
}

pub(crate) fn tracking(speed_mm_s: f32) -> Tracking {
    Tracking {
        speed_mm_s,
        ..TRACKING
    }
}

/// Returns any stage that could be built: with and without limit of jerk and speed.
pub(crate) fn any_limits() -> impl Strategy<Value = MechanismLimits> {
    (
        1.0_f32..5.0,
        proptest::option::of(2.0_f32..9.0),
        proptest::option::of(0.0_f32..3.0),
        0.0_f32..20.0,
        0.5_f32..50.0,
    )
        .prop_map(
            |(acceleration, jerk, speed, settling_ms, stroke_mm)| MechanismLimits {
                acceleration_mm_s2: libm::powf(10.0, acceleration),
                jerk_mm_s3: jerk.map(|jerk| libm::powf(10.0, jerk)),
                max_speed_mm_s: speed.map(|speed| libm::powf(10.0, speed)),
                settling_ms,
                stroke_mm,
            },
        )
}

/// Returns the same motion in the other direction, bit by bit.
pub(crate) fn mirrored(setpoint: Setpoint) -> Setpoint {
    Setpoint {
        offset_mm: -setpoint.offset_mm,
        speed_mm_s: -setpoint.speed_mm_s,
        acceleration_mm_s2: -setpoint.acceleration_mm_s2,
    }
}

/// Returns times over a profile, some before and after it included.
pub(crate) fn times(profile: &Profile) -> impl Iterator<Item = f32> + use<> {
    let duration_s = profile.duration_s();
    (-5_i16..=205).map(move |step| duration_s * f32::from(step) / 200.0)
}

/// Checks that the profile keeps the stage's limits, and has no step in place or speed, nor in
/// acceleration where the jerk is limited.
pub(crate) fn check_profile(
    profile: &Profile,
    limits: &MechanismLimits,
) -> Result<(), TestCaseError> {
    let segments = profile.segments();
    let most = limits.acceleration_mm_s2;
    for segment in segments {
        prop_assert!(segment.duration_s > 0.0 && segment.duration_s.is_finite());
        let jerk = segment.jerk_mm_s3.abs();
        prop_assert!(jerk <= limits.jerk_mm_s3.unwrap_or(0.0));
        prop_assert!(segment.start.acceleration_mm_s2.abs() <= most * 1.000_001);
    }
    let mut fastest = profile
        .start()
        .speed_mm_s
        .abs()
        .max(profile.end().speed_mm_s.abs());
    let (least, most_mm) = profile.reach_mm();
    let farthest = least.abs().max(most_mm.abs());
    let followers = segments.iter().map(|next| next.start).skip(1);
    for segment in segments {
        fastest = fastest.max(segment.start.speed_mm_s.abs());
    }
    for (segment, next) in segments.iter().zip(followers.chain([profile.end()])) {
        let end = crate::stage::exact::end_of(segment);
        let place = 3e-7 * (farthest + fastest * profile.duration_s());
        let speed = 1e-6 * fastest.max(most * segment.duration_s);
        let [offset_step, speed_step, acceleration_step] = end.minus(next);
        prop_assert!(
            offset_step.abs() <= f64::from(place),
            "{offset_step} mm: {profile:?}"
        );
        prop_assert!(
            speed_step.abs() <= f64::from(speed),
            "{speed_step} mm/s: {profile:?}"
        );
        if limits.jerk_mm_s3.is_some() {
            prop_assert!(
                acceleration_step.abs() <= 2e-6 * f64::from(most),
                "{acceleration_step} mm/s²: {profile:?}"
            );
        }
    }
    Ok(())
}
