//! Tests of the stage's track.

use super::*;
use crate::geometry::principal_point::PrincipalPointMotion;
use crate::geometry::shutter::{Shutter, ShutterProfile};

fn place(us: u64) -> StagePlace {
    #[expect(clippy::cast_precision_loss, reason = "small")]
    let offset_mm = 0.1 + 20.0e-6 * us as f32;
    StagePlace {
        time: Time::from_us(us),
        offset_mm,
        reading: PlaceReading::of_round(0.0),
    }
}

#[test]
fn long_exposures_are_covered_by_fewer_readings() {
    let shutter = Shutter::new(ShutterProfile::Uniform).unwrap();
    for length_ms in [1, 10, 63, 64, 65, 130, 1000, 3333, 10_000] {
        let mut track = StageTrack::new();
        for tick in 0..20 {
            track.push(place(1000 * tick));
        }
        let opened = Time::from_us(19_300);
        track.keep_from(opened);
        let closed = Time::from_us(19_300 + 1000 * length_ms);
        for tick in 20..=20 + length_ms {
            track.push(place(1000 * tick));
        }
        let path = track.path(opened, closed);
        assert!(path.is_covered && !path.is_continued, "{length_ms}");
        let exposure_s = closed.seconds_since(opened);
        let motion =
            PrincipalPointMotion::from_samples(&path.samples, exposure_s, &shutter).unwrap();
        assert!(path.wander_mm < 1e-4, "{length_ms}: {}", path.wander_mm);
        let gap_s = path.longest_gap_s;
        assert!(gap_s < 1.1e-3 + exposure_s / 16.0, "{length_ms}: {gap_s}");
        let expected = 0.1 + 20.0 * (0.0193 + 0.5 * exposure_s);
        assert!((motion.centroid_mm - expected).abs() < 2e-6 + 2e-6 * expected);
    }
}

#[test]
fn exposure_after_a_long_wait_has_all_of_its_places() {
    let mut track = StageTrack::new();
    for tick in 0..100 {
        track.push(place(1000 * tick));
    }
    let [opened, closed] = [99_300, 104_200].map(Time::from_us);
    track.keep_from(opened);
    for tick in 100..=105 {
        track.push(place(1000 * tick));
    }
    let path = track.path(opened, closed);
    assert_eq!(path.samples.len(), 7);
    assert!(
        path.longest_gap_s < 1.01e-3 && path.bend_mm < 1e-6,
        "{path:?}"
    );
    // Places before the exposure are compared with its first.
    let mut jerk = place(106_000);
    jerk.offset_mm += 0.004;
    track.push(jerk);
    let path = track.path(Time::from_us(105_100), Time::from_us(105_900));
    assert!((path.bend_mm - 0.004).abs() < 1e-6, "{path:?}");
}

#[test]
fn ends_are_continued_by_three_milliseconds_at_most() {
    let mut track = StageTrack::new();
    assert!(!track.path(Time::START, Time::from_us(1000)).is_covered);
    track.push(place(2000));
    assert!(!track.path(Time::START, Time::from_us(3000)).is_covered);
    track.push(place(3000));
    let path = track.path(Time::START, Time::from_us(5000));
    assert!(path.is_covered && path.is_continued);
    let [first, .., last] = path.samples[..] else {
        panic!()
    };
    assert!((first.offset_mm - 0.1).abs() < 1e-6 && (last.offset_mm - 0.2).abs() < 1e-6);
    assert!(!track.path(Time::START, Time::from_us(6001)).is_covered);
}

/// A track of readings 1 ms apart.
fn track_of(offsets_mm: &[f32]) -> StageTrack {
    let mut track = StageTrack::new();
    for (round, offset_mm) in (0_u64..).zip(offsets_mm) {
        track.push(StagePlace {
            time: Time::from_us(1000 * round),
            offset_mm: *offset_mm,
            reading: PlaceReading::of_round(0.0),
        });
    }
    track
}

fn assert_speed(track: &StageTrack, offset_mm: f32, expected: TrackSpeed) {
    let found = track.speed_at(offset_mm).unwrap();
    let off = |one: f32, other: f32| libm::fabsf(one - other) > 2e-3;
    let is_off = off(found.speed_mm_s, expected.speed_mm_s)
        || off(found.change_mm_s, expected.change_mm_s)
        || off(found.bend_mm_s, expected.bend_mm_s);
    assert!(!is_off, "{found:?} for {expected:?}");
}

#[test]
fn even_acceleration_changes_the_speed_and_does_not_bend_it() {
    // 5, 7, 9 and 11 mm/s from reading to reading.
    let track = track_of(&[0.0, 0.005, 0.012, 0.021, 0.032]);
    let expected = TrackSpeed {
        speed_mm_s: 11.0,
        change_mm_s: 2.0,
        bend_mm_s: 0.0,
    };
    assert_speed(&track, 0.0265, expected);
    let later = TrackSpeed {
        speed_mm_s: 11.5,
        ..expected
    };
    assert_speed(&track, 0.02925, later);
}

#[test]
fn push_bends_the_speed_and_so_does_the_only_change() {
    // 5, 5, 6 and 8 mm/s: a push of 3 mm/s in the third interval, after two thirds of it.
    let pushed = track_of(&[0.0, 0.005, 0.010, 0.016, 0.024]);
    let expected = TrackSpeed {
        speed_mm_s: 8.0,
        change_mm_s: 2.0,
        bend_mm_s: 1.0,
    };
    assert_speed(&pushed, 0.020, expected);
    let begun = track_of(&[0.0, 0.005, 0.012]);
    let expected = TrackSpeed {
        speed_mm_s: 7.0,
        change_mm_s: 2.0,
        bend_mm_s: 2.0,
    };
    assert_speed(&begun, 0.0085, expected);
    assert_eq!(track_of(&[0.0, 0.005]).speed_at(0.0), None);
}

#[test]
fn stage_that_stands_has_no_speed() {
    let track = track_of(&[0.0, 0.005, 0.010, 0.010]);
    assert!(track.speed_at(0.010).unwrap().speed_mm_s.abs() <= 0.0);
}

/// A place that was latched between two readings.
fn latched(us: u64) -> StagePlace {
    StagePlace {
        reading: PlaceReading::latched(0.0),
        ..place(us)
    }
}

fn times_us(track: &StageTrack) -> Vec<u64, CAPACITY> {
    track.places.iter().map(|it| it.time.us()).collect()
}

#[test]
fn latched_places_are_kept_in_order_of_time_each_once_and_none_before_the_first() {
    let mut track = StageTrack::new();
    track.latch(latched(100));
    for tick in 1..4 {
        track.push(place(1000 * tick));
    }
    for us in [2500, 3700, 2250, 999, 3000, 2500, 3500] {
        track.latch(latched(us));
    }
    track.push(place(4000));
    track.latch(latched(3900));
    let expected = [1000, 2000, 2250, 2500, 3000, 3500, 3700, 3900, 4000];
    assert_eq!(times_us(&track), expected);
    let speed_mm_s = track.speed_at(0.1 + 20.0e-3 * 3.5).unwrap().speed_mm_s;
    assert!((speed_mm_s - 20.0).abs() < 1e-2, "{speed_mm_s}");
}

#[test]
fn latched_places_give_way_in_an_exposure_that_has_no_room_for_them() {
    let mut track = StageTrack::new();
    for tick in 0..20 {
        track.push(place(1000 * tick));
    }
    let [opened, closed] = [19_300, 78_700].map(Time::from_us);
    track.keep_from(opened);
    for tick in 20..80 {
        for quarter in 1..4 {
            track.latch(latched(1000 * (tick - 1) + 250 * quarter));
        }
        track.push(place(1000 * tick));
    }
    let path = track.path(opened, closed);
    assert!(path.is_covered && !path.is_continued);
    assert!(path.longest_gap_s < 1.01e-3, "{}", path.longest_gap_s);
    assert_eq!(times_us(&track).len(), 62);
    // The next exposure takes them again.
    track.keep_latest();
    track.latch(latched(79_250));
    assert!(times_us(&track).contains(&79_250));
}

#[test]
fn bend_is_that_of_readings_however_near_a_latched_place_is() {
    let mut track = StageTrack::new();
    for tick in 0..8 {
        track.push(place(1000 * tick));
    }
    // A step of the encoder, 10 µs after a reading and before another.
    for us in [3010, 4990] {
        track.latch(StagePlace {
            offset_mm: place(us).offset_mm + 0.0001,
            ..latched(us)
        });
    }
    let path = track.path(Time::from_us(3010), Time::from_us(4990));
    assert!(path.bend_mm < 1e-6, "{}", path.bend_mm);
    assert_eq!(path.samples.first().map(|it| it.time_s), Some(0.0));
}

#[test]
fn exposure_far_from_all_places_is_not_covered() {
    let mut track = StageTrack::default();
    for tick in 10..20 {
        track.push(place(1000 * tick));
    }
    // Before the first place by more than is continued, and after the last.
    for [opened, closed] in [[5000, 12_000], [22_000, 27_000], [5000, 6000]] {
        let path = track.path(Time::from_us(opened), Time::from_us(closed));
        assert!(!path.is_covered && !path.is_continued, "{path:?}");
    }
    let alone = track.path(Time::from_us(22_000), Time::from_us(27_000));
    assert_eq!(alone.samples.len(), 1);
    assert!(alone.wander_mm <= 0.0 && alone.longest_gap_s <= 0.0);
}

#[test]
fn place_latched_before_a_long_exposure_makes_no_difference_to_it() {
    let [opened, closed] = [19_300, 19_300 + 200_000].map(Time::from_us);
    let path = |is_latched: bool| {
        let mut track = StageTrack::new();
        for tick in 0..20 {
            track.push(place(1000 * tick));
            if tick == 10 && is_latched {
                track.latch(StagePlace {
                    reading: PlaceReading::latched(0.0),
                    ..place(9500)
                });
            }
        }
        track.keep_from(opened);
        for tick in 20..=220 {
            track.push(place(1000 * tick));
        }
        track.path(opened, closed)
    };
    let [with, without] = [path(true), path(false)];
    assert!(with.is_covered);
    assert_eq!(with.samples, without.samples);
}
