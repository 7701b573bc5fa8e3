//! Numbers of the watch of the index mark, each by hand for an encoder of 0.1 µm whose readings are
//! 0.1 ms old to ± 2 µs, and a mark that repeats to 0.02 µm.

use super::*;

/// Largest difference of two readings of a place: `0.1·(1 + 2·0.1/1)` µm.
const STEPS_MM: f32 = 1.2e-4;

/// Difference of two readings of a place that nine of ten do not exceed: 0.7 of a step.
const USUAL_MM: f32 = 7e-5;

/// Tolerance of two crossings at the same steady speed: the steps and 5 · 0.02 µm.
const REPEAT_MM: f32 = STEPS_MM + 1e-4;

/// Largest step that the stage's watch lets pass, mm, of the tests.
const PASSED_MM: f32 = 0.009;

fn drive() -> DriveSettings {
    let mut drive = DriveSettings {
        index_mm: Some(0.0),
        ..DriveSettings::default()
    };
    drive.velocity_loop.reading_age_s = 1e-4;
    drive
}

/// Crosses the mark where the encoder shows a place, steadily.
fn cross(watch: &mut IndexWatch, place_mm: f32, speed_mm_s: f32, next: u32) -> Option<InDoubt> {
    cross_unevenly(watch, place_mm, [speed_mm_s, 0.0], next)
}

/// The same with a change of the speed between two readings, beyond that which a step makes, mm/s.
fn cross_unevenly(
    watch: &mut IndexWatch,
    place_mm: f32,
    [speed_mm_s, change_mm_s]: [f32; 2],
    next_sequence: u32,
) -> Option<InDoubt> {
    let crossing = Crossing {
        reading_mm: place_mm - 1e-4 * speed_mm_s,
        speed: TrackSpeed {
            speed_mm_s,
            change_mm_s: 0.1 + change_mm_s,
            bend_mm_s: 0.2 + change_mm_s,
        },
        next_sequence,
    };
    watch.cross(&crossing, &drive())
}

fn sigma_mm(watch: &IndexWatch, common_mm: f32) -> f32 {
    watch.sigma_mm(common_mm, &drive(), PASSED_MM)
}

fn assert_near(found: f32, expected: f32) {
    let off = libm::fabsf(found / expected - 1.0);
    assert!(off < 2e-3, "{found} for {expected}");
}

#[test]
fn unseen_counts_are_those_of_a_crossing_at_arming_until_one_between_records() {
    let mut watch = IndexWatch::new();
    // At 50 mm/s the age of a reading is worth 0.1 µm; nobody knows yet how fast frames cross.
    let of_arming_mm = STEPS_MM + 5.0 * libm::hypotf(2e-5, 1e-4);
    for _ in 0..3 {
        assert_eq!(cross(&mut watch, 0.0, 50.0, 1), None);
        assert_near(sigma_mm(&watch, 0.0), 0.15 * of_arming_mm);
    }
    watch.count_record();
    assert_eq!(cross(&mut watch, 0.0, 50.0, 2), None);
    assert_near(sigma_mm(&watch, 0.0), 0.15 * REPEAT_MM);
    // So it stays, whether a record has come since or not.
    assert_eq!(cross(&mut watch, 0.0, 50.0, 2), None);
    assert_near(sigma_mm(&watch, 0.0), 0.15 * REPEAT_MM);
    // Arming begins anew, and the crossing after it is compared with the settings.
    watch.arm();
    watch.demand();
    assert!(!watch.is_found() && !watch.is_referenced(&drive()));
    assert_eq!(cross(&mut watch, 0.0, 50.0, 2), None);
    assert_near(sigma_mm(&watch, 0.0), 0.15 * of_arming_mm);
}

#[test]
fn demanded_crossing_is_flown_only_against_a_reference() {
    let mut watch = IndexWatch::new();
    watch.demand();
    assert_eq!(cross(&mut watch, 0.0, 50.0, 1), None);
    let first_mm = sigma_mm(&watch, 0.0);
    assert_near(first_mm, 0.15 * (STEPS_MM + 5.0 * libm::hypotf(2e-5, 1e-4)));
    watch.demand();
    assert_eq!(cross(&mut watch, 0.0, 50.0, 1), None);
    assert_near(sigma_mm(&watch, 0.0), 0.15 * REPEAT_MM);
}

#[test]
fn larger_of_both_sigmas_counts_where_the_mark_agrees() {
    let mut watch = IndexWatch::new();
    cross(&mut watch, 0.0, 50.0, 1);
    assert_near(sigma_mm(&watch, 1e-3), 1e-3);
    assert_near(sigma_mm(&watch, 1e-6), 0.15 * (STEPS_MM + 5.1e-4));
}

#[test]
fn sigma_after_a_disagreement_holds_it_and_a_step_for_every_record_since() {
    for (records, cycles) in [(0, 1.0), (1, 1.0), (3, 3.0)] {
        let mut watch = IndexWatch::new();
        assert_eq!(cross(&mut watch, 0.0, 5.0, 7), None);
        for _ in 0..records {
            watch.count_record();
        }
        let exposures = cross(&mut watch, -0.02, 5.0, 9).unwrap();
        assert_eq!(exposures.from_sequence, 7);
        assert_near(exposures.off_mm, -0.02);
        assert!(!watch.is_referenced(&drive()), "{records}");
        assert_near(watch.last_mm().unwrap(), -0.02);
        let expected = |cycles: f32| {
            fmc_camera_kernel::sqrt(
                0.003 * 0.003 + PASSED_MM * PASSED_MM * cycles / 3.0 + 0.02 * 0.02,
            )
        };
        assert_near(sigma_mm(&watch, 0.003), expected(cycles));
        watch.count_record();
        assert_near(sigma_mm(&watch, 0.003), expected(cycles + 1.0));
        // The next that agrees ends it.
        assert_eq!(cross(&mut watch, 0.0, 5.0, 11), None);
        assert!(watch.is_referenced(&drive()));
        assert_near(sigma_mm(&watch, 0.0), 0.15 * REPEAT_MM);
        assert_eq!(cross(&mut watch, 0.02, 5.0, 12).unwrap().from_sequence, 11);
    }
}

#[test]
fn difference_beyond_the_steps_is_half_in_sigma_and_leaves_the_records_since_in_question() {
    let mut watch = IndexWatch::new();
    cross(&mut watch, 0.0, 5.0, 1);
    watch.count_record();
    cross(&mut watch, 0.0, 5.0, 2);
    watch.count_record();
    // 0.15 µm: more than the steps, less than with the noise of the mark.
    assert_eq!(cross(&mut watch, 1.5e-4, 5.0, 3), None);
    let off_mm = 1.5e-4 - USUAL_MM;
    assert_near(
        sigma_mm(&watch, 0.0),
        libm::hypotf(0.15 * REPEAT_MM, 0.75 * off_mm),
    );
    watch.count_record();
    assert_eq!(cross(&mut watch, 0.01, 5.0, 4).unwrap().from_sequence, 2);
}

#[test]
fn difference_that_agrees_leaves_records_in_doubt_whose_sigma_does_not_cover_it() {
    for off_mm in [2.5e-4, -4e-4] {
        let mut watch = IndexWatch::new();
        cross(&mut watch, 0.0, 5.0, 1);
        watch.count_record();
        cross(&mut watch, 0.0, 5.0, 2);
        watch.count_record();
        // Uneven motion may explain it, but the record before was of a steady crossing.
        assert!(libm::fabsf(off_mm) - STEPS_MM > 3.0 * 0.15 * REPEAT_MM);
        let exposures = cross_unevenly(&mut watch, off_mm, [5.0, 3.0], 3).unwrap();
        assert_eq!(exposures.from_sequence, 2);
        assert_eq!(exposures.through_sequence(), 2);
        assert!(!exposures.is_fault);
        assert_near(exposures.off_mm, off_mm);
        // The records after it hold half of it: the same difference again is covered.
        watch.count_record();
        assert_eq!(cross_unevenly(&mut watch, off_mm, [5.0, 3.0], 4), None);
        assert!(watch.is_referenced(&drive()));
    }
    // Within three σ, or without a record, there is nothing to doubt.
    let mut watch = IndexWatch::new();
    cross(&mut watch, 0.0, 5.0, 1);
    assert_eq!(cross_unevenly(&mut watch, 4e-4, [5.0, 3.0], 1), None);
    let mut watch = IndexWatch::new();
    cross(&mut watch, 0.0, 5.0, 1);
    watch.count_record();
    let covered_mm = STEPS_MM + 3.0 * 0.149 * REPEAT_MM;
    assert_eq!(cross_unevenly(&mut watch, covered_mm, [5.0, 3.0], 2), None);
}

#[test]
fn age_of_a_reading_explains_a_difference_between_speeds_and_no_more() {
    // 1.73 σ of the age, 3.46 µs, at 45 mm/s more than the reference.
    let explained_mm = USUAL_MM + 1.73 * 2e-6 * 45.0;
    let floor_mm = 0.15 * (STEPS_MM + 5.0 * libm::hypotf(2e-5, 2e-6 * 45.0));
    for beyond_mm in [0.0, 1e-4] {
        let mut watch = IndexWatch::new();
        cross(&mut watch, 0.0, 5.0, 1);
        watch.count_record();
        assert_eq!(cross(&mut watch, explained_mm + beyond_mm, 50.0, 2), None);
        assert_near(
            sigma_mm(&watch, 0.0),
            libm::hypotf(floor_mm, 0.75 * beyond_mm),
        );
    }
}

#[test]
fn difference_of_the_reference_from_the_settings_is_half_in_sigma() {
    let mut watch = IndexWatch::new();
    assert_eq!(cross(&mut watch, 3e-4, 5.0, 1), None);
    // The settings have half the steps of a difference.
    let off_mm = 3e-4 - 0.5 * STEPS_MM - 1.73 * 2e-6 * 5.0;
    let floor_mm = 0.15 * (STEPS_MM + 5.0 * libm::hypotf(2e-5, 1e-5));
    assert_near(sigma_mm(&watch, 0.0), libm::hypotf(floor_mm, 0.75 * off_mm));
}

#[test]
fn sigma_has_no_part_of_an_even_acceleration() {
    let mut watch = IndexWatch::new();
    let accelerating = Crossing {
        reading_mm: -5e-4,
        speed: TrackSpeed {
            speed_mm_s: 5.0,
            change_mm_s: 2.0,
            bend_mm_s: 0.1,
        },
        next_sequence: 1,
    };
    assert_eq!(watch.cross(&accelerating, &drive()), None);
    watch.count_record();
    assert_eq!(watch.cross(&accelerating, &drive()), None);
    assert_near(sigma_mm(&watch, 0.0), 0.15 * REPEAT_MM);
    // A crossing agrees within twice the changes of both in a tenth of a millisecond.
    let off_mm = REPEAT_MM + 2.0 * 2.0 * 1.9e-4 - 2e-5;
    let later = Crossing {
        reading_mm: accelerating.reading_mm + off_mm,
        next_sequence: 1,
        ..accelerating
    };
    assert_eq!(watch.cross(&later, &drive()), None);
}

#[test]
fn reference_is_the_slowest_and_steadiest_crossing() {
    let mut watch = IndexWatch::new();
    cross(&mut watch, 0.0, 50.0, 1);
    // 0.3 µm with the age of a reading at 45 mm/s more; 0.5 µm is more than 5 σ.
    assert_eq!(cross(&mut watch, 3e-4, 5.0, 1), None);
    assert_eq!(cross(&mut watch, 3e-4, 5.0, 1), None);
    // Slower but uneven: it is compared, and does not replace.
    assert_eq!(cross_unevenly(&mut watch, 2e-4, [1.0, 3.0], 1), None);
    assert_eq!(cross(&mut watch, 3e-4 + 0.95 * REPEAT_MM, 5.0, 1), None);
    assert!(cross(&mut watch, 3e-4 + 1.05 * REPEAT_MM, 5.0, 1).is_some());
    // Twice the change in a tenth of a millisecond.
    let uneven_mm = 2.0 * 3.0 * 1e-4;
    let most_mm = 3e-4 + REPEAT_MM + uneven_mm;
    assert_eq!(
        cross_unevenly(&mut watch, most_mm - 2e-5, [5.0, 3.0], 1),
        None
    );
    assert!(cross_unevenly(&mut watch, most_mm + 2e-5, [5.0, 3.0], 1).is_some());
}

#[test]
fn difference_from_a_reference_that_is_off_the_settings_itself_counts_with_that() {
    let mut watch = IndexWatch::new();
    assert_eq!(cross(&mut watch, 2e-4, 5.0, 1), None);
    watch.count_record();
    let beyond_mm = 5e-5;
    cross(&mut watch, 2e-4 + USUAL_MM + beyond_mm, 5.0, 2);
    let off_mm = beyond_mm + 2e-4 - 0.5 * STEPS_MM - 1.73 * 2e-6 * 5.0;
    assert_near(
        sigma_mm(&watch, 0.0),
        libm::hypotf(0.15 * REPEAT_MM, 0.75 * off_mm),
    );
}
