//! Tests of the motion of the principal point.

use super::*;
use crate::geometry::shutter::ShutterProfile;

const LEAF: ShutterProfile = ShutterProfile::Trapezoid {
    opening_fraction: 0.3,
    closing_fraction: 0.1,
};
const TRAVEL: UniformTravel = UniformTravel {
    opening_offset_mm: -0.05,
    speed_mm_s: 20.0,
    exposure_s: 0.01,
};

fn steady(times_s: &[f32]) -> std::vec::Vec<StageSample> {
    times_s
        .iter()
        .map(|&time_s| StageSample {
            time_s,
            offset_mm: TRAVEL.opening_offset_mm + TRAVEL.speed_mm_s * time_s,
        })
        .collect()
}

#[test]
fn samples_of_a_steady_stage_give_the_plan() {
    let shutter = Shutter::new(LEAF).unwrap();
    let plan = PrincipalPointMotion::from_plan(TRAVEL, &shutter);
    for times in [
        &[0.0, 0.01][..],
        &[-0.003, 0.0007, 0.004, 0.0041, 0.0095, 0.013],
        &[-0.5, -0.003, 0.0007, 0.0095, 0.013, 0.02, 0.3],
    ] {
        let measured = PrincipalPointMotion::from_samples(&steady(times), 0.01, &shutter).unwrap();
        assert!((measured.opening_offset_mm - plan.opening_offset_mm).abs() < 1e-7);
        assert!((measured.travel_mm - plan.travel_mm).abs() < 1e-7);
        assert!((measured.centroid_mm - plan.centroid_mm).abs() < 2e-8);
        assert!((measured.moments.second - plan.moments.second).abs() < 1e-9);
        assert!((measured.moments.third - plan.moments.third).abs() < 1e-10);
        assert!((measured.moments.fourth - plan.moments.fourth).abs() < 1e-11);
    }
}

#[test]
fn a_stage_that_stops_half_way_is_seen() {
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let stalled = [(0.0, 0.0), (0.005, 0.1), (0.01, 0.1)]
        .map(|(time_s, offset_mm)| StageSample { time_s, offset_mm });
    let motion = PrincipalPointMotion::from_samples(&stalled, 0.01, &shutter).unwrap();
    assert!((motion.centroid_mm - 0.075).abs() < 1e-8);
    assert!((motion.travel_mm - 0.1).abs() < 1e-8);
    // E[c²] = (1/2)(0.01/3) + (1/2)(0.01), minus c̄².
    assert!((motion.moments.second - (0.02 / 3.0 - 0.005_625)).abs() < 1e-8);
}

#[test]
fn thirteen_per_cent_of_travel_are_worth_the_published_shift() {
    // Ramps of 30 and 10 %: centroid 4.6 % of δ off the middle.
    let motion = PrincipalPointMotion::from_plan(TRAVEL, &Shutter::new(LEAF).unwrap());
    let middle = TRAVEL.opening_offset_mm + motion.travel_mm / 2.0;
    assert!(((motion.centroid_mm - middle) / motion.travel_mm - 0.045_83).abs() < 1e-4);
}

#[test]
fn tdi_lags_by_half_a_pixel_after_a_full_row_period() {
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let travel = UniformTravel {
        opening_offset_mm: 0.0,
        speed_mm_s: 12.0,
        exposure_s: 0.01,
    };
    let smooth = PrincipalPointMotion::from_plan(travel, &shutter);
    let late = smooth.in_rows(0.012, 1.0, &shutter).unwrap();
    let even = smooth.in_rows(0.012, 0.5, &shutter).unwrap();
    assert!((late.centroid_mm - (0.06 - 0.006)).abs() < 1e-6);
    assert!((even.centroid_mm - 0.06).abs() < 1e-6);
    assert_eq!(late.moments, even.moments);
}

#[test]
fn samples_that_do_not_determine_the_path_are_refused() {
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    let from = |times: &[f32]| {
        PrincipalPointMotion::from_samples(&steady(times), 0.01, &shutter).unwrap_err()
    };
    assert_eq!(from(&[]), SampleError::TooFew(0));
    assert_eq!(from(&[0.0]), SampleError::TooFew(1));
    assert_eq!(from(&[0.0, 0.0, 0.01]), SampleError::NotIncreasing(1));
    assert_eq!(from(&[0.0, f32::NAN, 0.01]), SampleError::NotFinite(1));
    for uncovered in [[0.001, 0.02], [0.0, 0.009]] {
        assert!(matches!(from(&uncovered), SampleError::NotCovered { .. }));
    }
    let samples = steady(&[0.0, 0.01]);
    assert_eq!(
        PrincipalPointMotion::from_samples(&samples, 0.0, &shutter),
        Err(SampleError::Exposure(0.0))
    );
}
