//! Flights over a reset of the camera, whose memory it leaves alone.

use fmc_camera::flight::controller::state::State;
use fmc_camera::flight::event::{Action, Command, Event};
use fmc_camera::flight::fault::Fault;
use fmc_camera::flight::frame_record::{Flag, FrameRecord, Outcome, Reason};
use fmc_camera::flight::record_log::CAPACITY;
use fmc_camera::flight::settings::FlightSettings;
use fmc_camera::io::link::after_reset::{AfterReset, FlightAfterReset, RESETS_IN_A_ROW, STEADY_S};
use fmc_camera::io::link::deck::FlightDeck;
use fmc_camera::io::link::flight_memory::FlightMemory;
use fmc_camera::io::link::message::{
    Answer, Ending, FetchedRecord, Refusal, Request, ResetCause, Status,
};

use crate::link::in_flight::Flight;
use crate::link::pc::camera_parameters;

const CAUSES: [ResetCause; 4] = [
    ResetCause::Requested,
    ResetCause::Watchdog,
    ResetCause::Fault,
    ResetCause::StackOverflow,
];

fn blank() -> &'static FlightMemory {
    Box::leak(Box::new(FlightMemory::blank()))
}

/// A copy, as the memory is at a reset.
pub(super) fn of_words(words: &[u32; FlightMemory::WORDS]) -> &'static FlightMemory {
    Box::leak(Box::new(FlightMemory::of_words(*words)))
}

fn loaded(memory: &'static FlightMemory) -> Flight {
    let mut flight = Flight::after_reset(ResetCause::PowerOn, memory);
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    flight
}

/// A camera that has been armed, with its memory.
pub(super) fn armed(settings: &FlightSettings) -> (Flight, &'static FlightMemory) {
    let memory = blank();
    let mut flight = loaded(memory);
    let prepared = flight.pc.ask(&Request::Prepare(*settings));
    assert_eq!(prepared, Answer::Prepared);
    flight.arm();
    (flight, memory)
}

pub(super) fn expose(flight: &mut Flight) {
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Exposing);
    flight.run_until(State::Armed);
}

fn after_reset(flight: &Flight) -> AfterReset {
    flight.after_reset
}

fn fetched(flight: &mut Flight, sequence: u32) -> Option<FrameRecord> {
    match flight.pc.ask(&Request::FrameRecord(sequence)) {
        Answer::FrameRecord(record) => record.map(|(record, _)| record),
        other => panic!("{other:?}"),
    }
}

pub(super) fn all_records(flight: &mut Flight) -> Vec<FrameRecord> {
    let (mut records, mut next) = (Vec::new(), 0);
    while let Some(record) = fetched(flight, next) {
        next = record.sequence + 1;
        records.push(record);
    }
    records
}

fn status(flight: &mut Flight) -> Status {
    match flight.pc.ask(&Request::Status) {
        Answer::Status(status) => status,
        other => panic!("{other:?}"),
    }
}

/// Returns the number of the flight in the status.
fn status_of_flight(flight: &mut Flight) -> u32 {
    status(flight).after_reset.flight
}

/// Runs rounds until triggers are answered; returns how many it took.
fn rounds_until_degraded(flight: &mut Flight) -> u32 {
    for round in 1..=1000 {
        if flight.round(None).state == State::Degraded(Fault::Encoder) {
            return round;
        }
    }
    panic!("no trigger is answered within a second");
}

#[test]
fn flight_goes_on_after_any_reset_without_force_and_no_record_is_lost() {
    for cause in CAUSES {
        let (mut flight, memory) = armed(&FlightSettings::default());
        let exposure = Command::Exposure(0.002);
        flight.round(Some(Event::Command(exposure)));
        for _ in 0..3 {
            expose(&mut flight);
        }
        let before = all_records(&mut flight);
        assert_eq!(flight.pc.acknowledge(1), Answer::Kept(2));
        let counts = status(&mut flight).counts;

        let mut flight = Flight::after_reset(cause, memory);
        let found = after_reset(&flight);
        assert_eq!(found.outcome, FlightAfterReset::FliesOn);
        assert_eq!((found.boot, found.flight, found.records), (2, 1, 2));
        assert_eq!((found.unfinished, found.damaged), (0, 0));
        assert_eq!(all_records(&mut flight), before[1..]);
        let first = flight.round(None);
        assert!(first.actions.contains(&Action::CloseShutter), "{first:?}");
        let rounds = rounds_until_degraded(&mut flight);
        // The time for which the stage has to have stood.
        assert!((50..60).contains(&rounds), "{rounds}");
        let status_now = status(&mut flight);
        assert!(status_now.is_place_lost);
        assert_eq!(status_now.counts.triggers, counts.triggers);
        let answer = flight.round(Some(Event::Trigger));
        assert!(!answer.powered && answer.duty == 0.0, "{answer:?}");
        flight.run_until(State::Exposing);
        flight.run_until(State::Degraded(Fault::Encoder));
        let record = fetched(&mut flight, 4).unwrap();
        let Outcome::Exposed(frame) = record.outcome else {
            panic!("{record:?}");
        };
        assert!(record.flags.contains(Flag::NoCompensation), "{record:?}");
        assert!(record.flags.contains(Flag::PlannedMotion), "{record:?}");
        assert!(record.faults.contains(Fault::Watchdog), "{record:?}");
        assert_eq!(record.calibration, before[0].calibration);
        // The exposure time that was commanded in flight, on the rig's grid of rounds.
        assert!((frame.interior.exposure_s - 0.002).abs() < 0.0011);
        // After the operator has referred the encoder the camera compensates again.
        flight.round(Some(Event::Command(Command::ClearFault)));
        flight.arm();
        expose(&mut flight);
        let record = fetched(&mut flight, 5).unwrap();
        assert!(!record.flags.contains(Flag::NoCompensation), "{record:?}");
    }
}

#[test]
fn frame_that_the_reset_has_ended_has_a_record_that_says_so() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    expose(&mut flight);
    flight.round(Some(Event::Trigger));
    flight.run_until(State::Exposing);
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    let found = after_reset(&flight);
    assert_eq!((found.records, found.unfinished, found.damaged), (2, 1, 0));
    let [whole, ended] = all_records(&mut flight)[..] else {
        panic!("two records");
    };
    assert!(matches!(whole.outcome, Outcome::Exposed(_)), "{whole:?}");
    assert_eq!(ended.outcome, Outcome::Refused(Reason::Unusable));
    assert!(ended.faults.contains(Fault::Watchdog));
    assert!(ended.trigger > whole.trigger);
    // It outlives the next reset as it is.
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    assert_eq!(all_records(&mut flight), [whole, ended]);
    assert_eq!(after_reset(&flight).unfinished, 0);
}

#[test]
fn triggers_without_room_are_counted_over_a_reset() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    flight.round(Some(Event::Command(Command::Disarm)));
    let last = u32::try_from(CAPACITY).unwrap() + 5;
    for _ in 0..last {
        flight.round(Some(Event::Trigger));
    }
    let before = all_records(&mut flight);
    let mut flight = Flight::after_reset(ResetCause::Fault, memory);
    assert_eq!(after_reset(&flight).records, last);
    assert_eq!(after_reset(&flight).outcome, FlightAfterReset::StandsBy);
    assert_eq!(all_records(&mut flight), before);
    assert_eq!(status(&mut flight).counts.triggers, last);
    flight.round(Some(Event::Trigger));
    assert_eq!(all_records(&mut flight).len(), before.len() + 1);
}

#[test]
fn camera_that_was_not_armed_or_may_not_or_is_switched_off_stays_disarmed() {
    let may_not = FlightSettings {
        flies_on_after_reset: false,
        ..FlightSettings::default()
    };
    let (mut disarmed, memory) = armed(&FlightSettings::default());
    disarmed.round(Some(Event::Command(Command::Disarm)));
    let (_, kept_off) = armed(&may_not);
    let (mut off, switched_off) = armed(&FlightSettings::default());
    let ending = off.pc.ask(&Request::PowerOff(Ending::Forced));
    assert_eq!(ending, Answer::Ending);
    for (memory, outcome) in [
        (memory, FlightAfterReset::StandsBy),
        (kept_off, FlightAfterReset::SwitchedOff),
        (switched_off, FlightAfterReset::StandsBy),
    ] {
        // The second start finds what the first has left.
        for _ in 0..2 {
            let words = memory.words();
            let mut flight = Flight::after_reset(ResetCause::Requested, of_words(&words));
            assert_eq!(after_reset(&flight).outcome, outcome);
            for _ in 0..200 {
                assert_eq!(flight.round(None).state, State::Standby);
            }
            let mut flight = Flight::after_reset(ResetCause::Watchdog, of_words(&words));
            for _ in 0..200 {
                let state = flight.round(None).state;
                assert_eq!(state, State::Fault(Fault::Watchdog));
            }
        }
    }
}

#[test]
fn resets_that_follow_each_other_end_in_a_camera_that_stays_disarmed_and_is_named() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    expose(&mut flight);
    for _ in 0..RESETS_IN_A_ROW {
        let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
        assert_eq!(after_reset(&flight).outcome, FlightAfterReset::FliesOn);
        rounds_until_degraded(&mut flight);
    }
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    assert_eq!(after_reset(&flight).outcome, FlightAfterReset::ResetAgain);
    assert_eq!(all_records(&mut flight).len(), 1);
    for _ in 0..200 {
        let state = flight.round(None).state;
        assert_eq!(state, State::Fault(Fault::Watchdog));
    }
    // Somebody arms it: it goes on again.
    flight.arm();
    let flight = Flight::after_reset(ResetCause::Watchdog, memory);
    assert_eq!(after_reset(&flight).outcome, FlightAfterReset::FliesOn);
}

#[test]
fn resets_are_counted_anew_after_a_steady_flight() {
    let (_, memory) = armed(&FlightSettings::default());
    for _ in 0..2 * RESETS_IN_A_ROW {
        let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
        assert_eq!(after_reset(&flight).outcome, FlightAfterReset::FliesOn);
        let mut time_s = 0.0;
        while time_s < STEADY_S + 0.01 {
            flight.round(None);
            time_s += 1e-3;
        }
    }
}

#[test]
fn camera_whose_calibration_is_gone_is_not_flown_and_has_the_records() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    expose(&mut flight);
    let before = all_records(&mut flight);
    let words = memory.words();
    // The parameters are found by their principal distance.
    let at = words.windows(2).position(|pair| {
        let bytes: Vec<u8> = pair.iter().flat_map(|word| word.to_le_bytes()).collect();
        bytes
            .windows(4)
            .any(|four| four == 51.3712_f32.to_le_bytes())
    });
    let mut words = words;
    words[at.unwrap()] ^= 1;
    let memory = of_words(&words);
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    let found = after_reset(&flight);
    assert_eq!(found.outcome, FlightAfterReset::NoCalibration);
    assert_eq!(found.records, 1);
    assert_eq!(status(&mut flight).kept, 1);
    assert_eq!(all_records(&mut flight), before);
    let kept = Answer::Refused(Refusal::RecordsKept(1));
    assert_eq!(flight.pc.load(&camera_parameters()), kept);
    // They are still there after another reset.
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    assert_eq!(all_records(&mut flight), before);
    assert_eq!(flight.pc.acknowledge(1), Answer::Kept(0));
    let refused = Answer::Refused(Refusal::NotPrepared);
    assert_eq!(flight.pc.ask(&Request::Status), refused);
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    let prepare = Request::Prepare(FlightSettings::default());
    assert_eq!(flight.pc.ask(&prepare), Answer::Prepared);
    assert_eq!(all_records(&mut flight), []);
    let flight = Flight::after_reset(ResetCause::Watchdog, memory);
    let found = after_reset(&flight);
    assert_eq!((found.flight, found.records), (2, 0));
}

#[test]
fn memory_of_another_build_and_memory_without_contents_are_no_flight() {
    let (_, memory) = armed(&FlightSettings::default());
    let flight = Flight::of_build("another build", ResetCause::Requested, memory);
    assert_eq!(after_reset(&flight).outcome, FlightAfterReset::OtherBuild);
    let flight = Flight::after_reset(ResetCause::PowerOn, blank());
    assert_eq!(after_reset(&flight).outcome, FlightAfterReset::Nothing);
    for word in [0, u32::MAX] {
        let words = [word; FlightMemory::WORDS];
        let flight = Flight::after_reset(ResetCause::Watchdog, of_words(&words));
        assert_eq!(after_reset(&flight).outcome, FlightAfterReset::Damaged);
    }
}

#[test]
fn records_of_another_build_are_none_of_the_next_flight() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    for _ in 0..4 {
        expose(&mut flight);
    }
    let mut flight = Flight::of_build("another build", ResetCause::Requested, memory);
    let found = after_reset(&flight);
    assert_eq!(
        (found.outcome, found.records, found.flight),
        (FlightAfterReset::OtherBuild, 0, 0)
    );
    let loaded = flight.pc.load(&camera_parameters());
    assert!(matches!(loaded, Answer::Loaded(_)), "{loaded:?}");
    assert_eq!(flight.prepare(), Answer::Prepared);
    assert_eq!(status_of_flight(&mut flight), 1);
    flight.arm();
    expose(&mut flight);
    let own = all_records(&mut flight);
    let mut flight = Flight::of_build("another build", ResetCause::Watchdog, memory);
    assert_eq!(after_reset(&flight).outcome, FlightAfterReset::FliesOn);
    assert_eq!(own.len(), 1);
    assert_eq!(all_records(&mut flight), own);
}

#[test]
fn camera_whose_preparation_may_lead_to_the_reset_is_prepared_no_more() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    expose(&mut flight);
    let before = all_records(&mut flight);
    flight.round(Some(Event::Command(Command::Disarm)));
    flight.run_until(State::Standby);
    for _ in 0..=RESETS_IN_A_ROW {
        let flight = Flight::after_reset(ResetCause::Fault, memory);
        assert_eq!(after_reset(&flight).outcome, FlightAfterReset::StandsBy);
    }
    for _ in 0..2 {
        let mut flight = Flight::after_reset(ResetCause::Fault, memory);
        assert_eq!(after_reset(&flight).outcome, FlightAfterReset::ResetAgain);
        assert!(flight.pc.station.deck_mut().controller().is_none());
        assert_eq!(all_records(&mut flight), before);
    }
}

#[test]
fn acknowledged_records_do_not_come_back() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    for _ in 0..4 {
        expose(&mut flight);
    }
    assert_eq!(flight.pc.acknowledge(3), Answer::Kept(1));
    let mut flight = Flight::after_reset(ResetCause::Watchdog, memory);
    let left = all_records(&mut flight);
    assert_eq!(left.len(), 1);
    assert_eq!(left[0].sequence, 4);
    // An acknowledgement from before the reset may be repeated.
    let fetched = FetchedRecord {
        sequence: 3,
        crc: 0,
    };
    let again = flight.pc.ask(&Request::Acknowledge(fetched));
    assert_eq!(again, Answer::Kept(1));
}

/// Checks that a start takes up what was there, or names what it leaves out.
fn check_damaged(words: &[u32; FlightMemory::WORDS], whole: &[FrameRecord], bit: usize) {
    let mut flight = Flight::after_reset(ResetCause::Watchdog, of_words(words));
    let found = after_reset(&flight);
    let records = match flight.pc.ask(&Request::FrameRecord(0)) {
        Answer::Refused(Refusal::NotPrepared) => Vec::new(),
        _ => all_records(&mut flight),
    };
    if found.outcome == FlightAfterReset::FliesOn && found.damaged == 0 {
        assert_eq!(records, whole, "bit {bit}");
        return;
    }
    let right = records.iter().filter(|record| whole.contains(record));
    let named = records.iter().filter(|record| !whole.contains(record));
    for record in named.clone() {
        assert_eq!(record.outcome, Outcome::Refused(Reason::Unusable), "{bit}");
        assert!(record.faults.contains(Fault::Watchdog), "{bit}");
    }
    let (right, named) = (right.count(), named.count());
    assert_eq!(right + named, records.len());
    assert_eq!(
        u32::try_from(named).unwrap(),
        found.damaged + found.unfinished
    );
    if found.outcome != FlightAfterReset::Damaged {
        assert_eq!(records.len(), whole.len(), "bit {bit}");
    }
}

#[test]
fn no_wrong_bit_of_the_memory_is_believed() {
    let (mut flight, memory) = armed(&FlightSettings::default());
    for _ in 0..2 {
        expose(&mut flight);
    }
    let whole = all_records(&mut flight);
    let words = memory.words();
    let mut tried = 0;
    for bit in 0..32 * FlightMemory::WORDS {
        if words[bit / 32] == 0 && bit % 32 > 0 {
            // Most of the memory is not used: a bit of each of its words is tried.
            continue;
        }
        let mut damaged = words;
        damaged[bit / 32] ^= 1 << (bit % 32);
        check_damaged(&damaged, &whole, bit);
        tried += 1;
    }
    assert!(tried > 8000, "{tried}");
}

#[test]
fn reset_between_any_two_words_loses_no_record() {
    let settings = FlightSettings::default();
    let (mut flight, memory) = armed(&settings);
    expose(&mut flight);
    let mut before = memory.words();
    let mut whole = all_records(&mut flight);
    let mut rounds = 0;
    flight.round(Some(Event::Trigger));
    loop {
        let after = memory.words();
        let finished = all_records(&mut flight);
        let changed: Vec<usize> = (0..after.len())
            .filter(|at| before[*at] != after[*at])
            .collect();
        // Words are written in the order of their steps, not of their places: any part of them.
        for parts in 0..changed.len() {
            for order in [false, true] {
                let mut words = before;
                for step in 0..parts {
                    let step = if order {
                        changed.len() - 1 - step
                    } else {
                        step
                    };
                    words[changed[step]] = after[changed[step]];
                }
                let mut flight = Flight::after_reset(ResetCause::Watchdog, of_words(&words));
                assert_eq!(after_reset(&flight).outcome, FlightAfterReset::FliesOn);
                let records = all_records(&mut flight);
                assert_eq!(records[..whole.len()], whole, "{parts} of {changed:?}");
            }
        }
        before = after;
        whole = finished;
        rounds += 1;
        if whole.len() == 2 && rounds > 40 {
            break;
        }
        assert!(rounds < 2000);
        flight.round(None);
    }
}
