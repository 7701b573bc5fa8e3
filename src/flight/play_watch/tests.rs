//! Numbers of the watch of the play, each by hand for an encoder of 0.1 µm whose readings are
//! 0.1 ms old to ± 2 µs, and a mark that repeats to 0.02 µm.

use super::*;
use crate::flight::stage_track::TrackSpeed;

/// Width of the mark, mm.
const WIDTH_MM: f32 = 0.05;

/// Play of the settings, mm.
const PLAY_MM: f32 = 0.005;

/// Largest difference of two readings of a place: `0.1·(1 + 2·0.1/1)` µm.
const STEPS_MM: f32 = 1.2e-4;

/// Tolerance of two pairs at the same steady speeds: the steps and 5·√2·0.02 µm.
const REPEAT_MM: f32 = STEPS_MM + 1.414e-4;

fn drive() -> DriveSettings {
    let mut drive = DriveSettings {
        index_mm: Some(0.0),
        ..DriveSettings::default()
    };
    drive.velocity_loop.reading_age_s = 1e-4;
    drive
}

/// A steady crossing where the encoder shows a place.
fn crossing(place_mm: f32, speed_mm_s: f32) -> Crossing {
    Crossing {
        reading_mm: place_mm - 1e-4 * speed_mm_s,
        speed: TrackSpeed {
            speed_mm_s,
            change_mm_s: 0.1,
            bend_mm_s: 0.2,
        },
        next_sequence: 1,
    }
}

/// Crosses the mark along the axis and back, with counts that are shifted, mm.
fn cross(watch: &mut PlayWatch, grown_mm: f32, shift_mm: f32, speed_mm_s: f32) -> Option<Compared> {
    let along = crossing(shift_mm, speed_mm_s).passage(&drive());
    assert!(!watch.cross_along(Some(along)));
    let upper_mm = WIDTH_MM - PLAY_MM - grown_mm + shift_mm;
    watch.cross_against(&crossing(upper_mm, -speed_mm_s), &drive(), true)
}

#[test]
fn growth_is_found_wherever_the_counts_are_and_is_sigma_until_it_is_gone() {
    for (grown_um, sign) in [(0.5, 1.0), (3.0, 1.0), (100.0, 1.0), (2.0, -1.0)] {
        let grown_mm = sign * 1e-3 * grown_um;
        let mut watch = PlayWatch::new();
        assert_eq!(cross(&mut watch, 0.0, 0.0, 50.0), None);
        for shift_mm in [0.0, 0.7, -0.02] {
            let compared = cross(&mut watch, grown_mm, shift_mm, 50.0).unwrap();
            assert!(!compared.agrees && watch.disagrees(), "{compared:?}");
            assert!((compared.off_mm + grown_mm).abs() < 1e-6, "{compared:?}");
            let expected_mm = grown_mm.abs() - STEPS_MM;
            assert!((watch.off_mm() - expected_mm).abs() < 1e-6);
        }
        // Records hold it by now.
        let again = cross(&mut watch, grown_mm, 0.0, 50.0).unwrap();
        assert!(again.is_covered);
        assert!(cross(&mut watch, 0.0, 0.0, 50.0).unwrap().agrees);
        assert!(watch.off_mm() <= 0.0 && !watch.disagrees());
    }
}

#[test]
fn growth_that_records_do_not_hold_is_not_covered() {
    // Three σ of a tenth of 5 µm of play and of 0.15 of the tolerance.
    let held_mm = 3.0 * libm::hypotf(0.1 * PLAY_MM, 0.15 * REPEAT_MM);
    for (grown_mm, is_covered) in [
        (STEPS_MM + 0.99 * held_mm, true),
        (STEPS_MM + 1.01 * held_mm, false),
    ] {
        let mut watch = PlayWatch::new();
        cross(&mut watch, 0.0, 0.0, 50.0);
        let compared = cross(&mut watch, grown_mm, 0.0, 50.0).unwrap();
        assert_eq!(compared.is_covered, is_covered, "{compared:?}");
    }
}

#[test]
fn pairs_agree_within_steps_noise_and_what_the_age_of_a_reading_makes_of_speeds() {
    for (part, agrees) in [(0.99, true), (1.01, false)] {
        let mut watch = PlayWatch::new();
        cross(&mut watch, 0.0, 0.0, 5.0);
        let compared = cross(&mut watch, part * REPEAT_MM, 0.0, 5.0).unwrap();
        assert_eq!(compared.agrees, agrees, "{compared:?}");
    }
    // Both ways 45 mm/s faster: 90 mm/s times 2 µs.
    let faster_mm = STEPS_MM + 5.0 * libm::hypotf(2.83e-5, 1.8e-4);
    for (part, agrees) in [(0.99, true), (1.01, false)] {
        let mut watch = PlayWatch::new();
        cross(&mut watch, 0.0, 0.0, 5.0);
        let compared = cross(&mut watch, part * faster_mm, 0.0, 50.0).unwrap();
        assert_eq!(compared.agrees, agrees, "{compared:?}");
        // Half of it beyond the steps is σ.
        let sigma_mm = 0.75 * (0.99 * faster_mm - STEPS_MM);
        assert!(!agrees || (watch.off_mm() - sigma_mm).abs() < 1e-6);
    }
}

#[test]
fn slowest_pair_within_the_steps_is_the_reference() {
    for (grown_mm, is_reference) in [(0.9 * STEPS_MM, true), (3e-4, false)] {
        let mut watch = PlayWatch::new();
        cross(&mut watch, 0.0, 0.0, 50.0);
        assert!(cross(&mut watch, grown_mm, 0.0, 5.0).unwrap().agrees);
        let compared = cross(&mut watch, grown_mm, 0.0, 5.0).unwrap();
        assert_eq!(compared.off_mm.abs() < 1e-7, is_reference, "{compared:?}");
    }
}

#[test]
fn play_that_grows_slowly_does_not_take_its_reference_along() {
    let mut watch = PlayWatch::new();
    for pair in 0..100_u8 {
        // A little slower each time.
        let speed_mm_s = 20.0 - 0.1 * f32::from(pair);
        let grown_mm = 2e-5 * f32::from(pair);
        cross(&mut watch, grown_mm, 0.0, speed_mm_s);
        // From 20 to 10.1 mm/s a reference is replaced three times, within the steps.
        let expected_mm = (grown_mm - 4.0 * STEPS_MM).max(0.0);
        assert!(watch.off_mm() >= 0.5 * expected_mm, "{pair}: {watch:?}");
    }
}

#[test]
fn crossing_that_was_due_is_missed_once_at_the_next_along_the_axis() {
    let mut watch = PlayWatch::new();
    cross(&mut watch, 0.0, 0.0, 50.0);
    let along = Some(crossing(0.0, 50.0).passage(&drive()));
    watch.expect(true);
    assert!(!watch.cross_along(along), "it has been seen");
    watch.expect(true);
    assert!(watch.cross_along(along));
    assert!(!watch.cross_along(along));
}

#[test]
fn without_a_crossing_along_the_axis_there_is_nothing_to_compare() {
    let against = crossing(WIDTH_MM, -5.0);
    let mut watch = PlayWatch::new();
    assert_eq!(watch.cross_against(&against, &drive(), false), None);
    cross(&mut watch, 0.0, 0.0, 5.0);
    // Counts from another zero: the play that was known is compared with after the next pair.
    watch.forget_counts();
    assert_eq!(watch.cross_against(&against, &drive(), false), None);
    assert!(!cross(&mut watch, 0.01, 0.4, 5.0).unwrap().agrees);
    watch.cross_along(None);
    assert_eq!(watch.cross_against(&against, &drive(), false), None);
}

#[test]
fn play_is_in_the_error_of_a_flight_against_the_axis_with_the_encoder_on_the_screw() {
    let screw = drive();
    let stage = DriveSettings {
        encoder_side: EncoderSide::Stage,
        ..screw
    };
    assert!(is_play_in_error(&screw, true, -1.0) && !is_play_in_error(&screw, true, 1.0));
    // Without play in the settings nothing seems to be taken up; with it, a stage on neither flank.
    assert!(is_play_in_error(&screw, false, 1.0));
    assert!(!is_play_in_error(&stage, false, -1.0));
}

#[test]
fn slower_pair_that_is_more_uneven_is_no_better_reference() {
    let pair = |watch: &mut PlayWatch, speed_mm_s: f32, change_mm_s: f32| {
        let crossing = |place_mm, speed_mm_s| {
            let mut crossing = crossing(place_mm, speed_mm_s);
            crossing.speed.change_mm_s = change_mm_s;
            crossing
        };
        let along = crossing(0.0, speed_mm_s).passage(&drive());
        assert!(!watch.cross_along(Some(along)));
        let upper_mm = WIDTH_MM - PLAY_MM;
        watch.cross_against(&crossing(upper_mm, -speed_mm_s), &drive(), true)
    };
    let mut watch = PlayWatch::new();
    assert_eq!(pair(&mut watch, 50.0, 0.1), None);
    let first = watch.reference;
    assert!(pair(&mut watch, 5.0, 40.0).unwrap().agrees);
    assert_eq!(watch.reference, first, "the even pair stays");
    assert!(pair(&mut watch, 5.0, 0.1).unwrap().agrees);
    assert_ne!(
        watch.reference, first,
        "the slow and even one takes its place"
    );
}
