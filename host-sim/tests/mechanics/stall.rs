//! Speed at which the following error shows a stage that does not follow.

use fmc_camera::flight::drive::loop_settings::LoopSettings;
use fmc_simulation::mechanics::{Injection, MechanicalFault, MechanicsSettings};

use crate::mechanics::profile::{ACCELERATION_MM_S2, Profile};
use crate::mechanics::support::{TICK_S, Tick, drive_for, run};

/// Begin of the ramp, s.
const START_S: f64 = 0.05;

fn profile(speed_mm_s: f64) -> Profile {
    let mut profile = Profile::at_rest(START_S);
    profile.cruise(speed_mm_s, 0.03, ACCELERATION_MM_S2);
    profile
}

/// Returns the following error that the camera sees at each tick from a fault's onset on.
fn seen_after(speed_mm_s: f64, fault: MechanicalFault, onset_s: f64) -> Vec<f64> {
    let mut seen = Vec::new();
    let settings = MechanicsSettings::default();
    run(
        settings,
        drive_for(&settings),
        &profile(speed_mm_s),
        &[Injection::from(fault, onset_s)],
        |Tick { time_s, error_um }, _, _| {
            if time_s > onset_s && seen.len() < 12 {
                seen.push(error_um.abs());
            }
        },
    );
    seen
}

/// Returns, for so many ms after onset, the largest error by then, at the onset within a tick where
/// it is smallest.
fn shown_um(speed_mm_s: f64, fault: MechanicalFault, onset_s: f64) -> [f64; 8] {
    let mut shown = [f64::MAX; 8];
    for part in [0.02, 0.3, 0.6, 0.9] {
        let mut largest: f64 = 0.0;
        let seen = seen_after(speed_mm_s, fault, onset_s + part * TICK_S);
        // After so many ms, that many ticks have passed.
        for (least, error_um) in shown.iter_mut().zip(seen) {
            largest = largest.max(error_um);
            *least = least.min(largest);
        }
    }
    shown
}

const JAM: MechanicalFault = MechanicalFault::Stall { force_n: 50.0 };

const FAULTS: [(&str, MechanicalFault); 3] = [
    ("jam", JAM),
    ("motor", MechanicalFault::MotorReversed),
    ("encoder", MechanicalFault::EncoderReversed),
];

fn cruise_s(speed_mm_s: f64) -> f64 {
    START_S + speed_mm_s / ACCELERATION_MM_S2 + 0.006
}

/// Returns the lines of the table in the library's documentation.
fn documented() -> Vec<(String, String, Vec<f64>)> {
    let source = include_str!("../../../src/flight/drive/following_error_bounds.rs");
    let rows = source.lines().filter_map(|line| {
        let cells: Vec<_> = line.trim().strip_prefix("/// | ")?.split('|').collect();
        let numbers: Vec<f64> = cells[2..]
            .iter()
            .flat_map(|cell| cell.trim().parse())
            .collect();
        (numbers.len() == 5).then(|| {
            let [fault, place] = [cells[0], cells[1]].map(|cell| cell.trim().to_owned());
            (fault, place, numbers)
        })
    });
    rows.collect()
}

#[test]
fn documented_table_is_what_the_camera_sees() {
    let rows = documented();
    assert_eq!(rows.len(), 9);
    for (name, place, documented) in rows {
        let fault = FAULTS.iter().find(|(known, _)| *known == name).unwrap().1;
        let (speed_mm_s, onset_s) = match place.as_str() {
            "5 mm/s" => (5.0, cruise_s(5.0)),
            "17 mm/s" => (17.0, cruise_s(17.0)),
            _ => (5.0, START_S),
        };
        let shown = shown_um(speed_mm_s, fault, onset_s);
        println!("{name} {place} {shown:.1?}");
        for (documented, found) in documented.iter().zip(&shown[1..]) {
            assert!(
                (documented - found).abs() <= 0.11,
                "{name} {place}: {shown:.1?}"
            );
        }
    }
}

#[test]
fn jam_and_wrong_sign_pass_the_limit_within_five_ms_and_healthy_motion_never_does() {
    let limit_um = f64::from(LoopSettings::FOLLOWING_LIMIT_UM);
    for speed_mm_s in [5.0, 10.0, 17.0, 25.0] {
        for (name, fault) in FAULTS {
            for onset_s in [START_S, cruise_s(speed_mm_s)] {
                let shown = shown_um(speed_mm_s, fault, onset_s);
                assert!(
                    shown[4] > limit_um,
                    "{name} {speed_mm_s} {onset_s}: {shown:.1?}"
                );
            }
        }
    }
    // The test `following` asserts the bounds of healthy motion.
    const {
        assert!(2.0 * LoopSettings::LEARNED.seen_um < LoopSettings::FOLLOWING_LIMIT_UM);
        assert!(LoopSettings::UNLEARNED.seen_um < LoopSettings::FOLLOWING_LIMIT_UNLEARNED_UM);
    }
}

#[test]
fn what_a_jam_teaches_is_soon_forgotten() {
    // The jam lasts for 10 ms of cruise, twice as long as its detection takes.
    let settings = MechanicsSettings::default();
    let mut motion = profile(5.0);
    motion.rest(0.1);
    motion.strokes(2);
    let after_s = motion.end_s();
    motion.cruise(17.0, 0.02, ACCELERATION_MM_S2);
    motion.rest(0.05);
    let jam = Injection {
        until_s: cruise_s(5.0) + 0.01,
        ..Injection::from(JAM, cruise_s(5.0))
    };
    let mut largest_um: f64 = 0.0;
    run(
        settings,
        drive_for(&settings),
        &motion,
        &[jam],
        |tick, _, _| {
            if tick.time_s > after_s {
                largest_um = largest_um.max(tick.error_um.abs());
            }
        },
    );
    println!("{largest_um}");
    assert!(
        largest_um <= f64::from(LoopSettings::LEARNED.seen_um),
        "{largest_um}"
    );
}
